"""Flights kept in a file, a line each: none is lost when a run of many stops, and none is flown twice.

What other tasks give that fly has lines of its own there.
"""

import hashlib
import inspect
import json
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from sim.campaign.claim import Study, Task
from sim.campaign.code_digest import code_digest
from sim.campaign.flight import FlightResult, Measure, Order, fly_order
from sim.errors import HarnessError, writing
from sim.value_types import Json

BEGINNING = b'{"order": "'
"""Of each line."""
KEYS = ({"order", "code", "summary", "figures"}, {"order", "code", "result"})
"""Of a flight, of another result."""
LEFT_OUT = "events"
"""Of the summary: they are many, and judged by no campaign."""


class FlightRows:
    """The flights in a file of JSON lines, and results of other tasks; of each order or key the last.

    Args:
        path: the file; it need not exist.
        of_any_code: also flights of other code than this.

    Raises:
        HarnessError: the file cannot be read, or holds something else.
    """

    def __init__(self, path: Path, *, of_any_code: bool = False) -> None:
        content = _content(path)
        whole = content[: content.rfind(b"\n") + 1]  # the writing of a last line may have been cut off
        rows = [_row(path, number, line) for number, line in enumerate(whole.splitlines(), start=1)]
        begun = content[len(whole) :][: len(BEGINNING)]
        if not BEGINNING.startswith(begun):
            raise _no_flight(path, len(rows) + 1)
        self._path, self._end, self._size = path, len(whole), len(content)
        self._rows = {row["order"]: row for row in rows if of_any_code or row["code"] == code_digest()}

    def is_of_other_code(self, order: Order) -> bool:
        """Whether its flight was flown by other code than this."""
        return bool(self._rows[order_hash(order)]["code"] != code_digest())

    def flight(self, order: Order) -> FlightResult | None:
        """The flight of an order; None if it has none here."""
        row = self._rows.get(order_hash(order))
        return None if row is None else FlightResult(order, row["summary"], row["figures"])

    def keep(self, flight: FlightResult) -> None:
        """Add a flight, in the file at once.

        Raises:
            HarnessError: the file cannot be written, or another run adds to it.
        """
        row = {
            "order": order_hash(flight.order),
            "name": flight.order.name,
            "code": code_digest(),
            "summary": {key: value for key, value in flight.summary.items() if key != LEFT_OUT},
            "figures": flight.figures,
        }
        self._add(row)

    def result(self, key: str) -> list[Any] | None:
        """The values that a task of this code has given; None if there are none here."""
        values: list[Any] | None = self._rows.get(key, {}).get("result")
        return values

    def keep_result(self, key: str, name: str, values: list[Any]) -> None:
        """Add the values that a task has given, in the file at once.

        Args:
            key: what tells them from others; 16 hexadecimal digits.
            name: for a reader of the file.
            values: of JSON.

        Raises:
            HarnessError: the file cannot be written, or another run adds to it.
        """
        self._add({"order": key, "name": name, "code": code_digest(), "result": values})

    def _add(self, row: Json) -> None:
        with writing(self._path):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with self._path.open("ab") as file:
                if file.tell() != self._size:
                    raise HarnessError(f"{self._path}: another run adds flights to it")
                file.truncate(self._end)
                self._end += file.write(json.dumps(row).encode() + b"\n")
                self._size = self._end
        self._rows[row["order"]] = row


def with_kept_flights(studies: Sequence[Study], rows: FlightRows) -> list[Study]:
    """The studies, where the flight of a task is known with that flight in place of the task."""
    return [
        replace(study, tasks=tuple(_known(task, rows) or task for task in study.tasks)) for study in studies
    ]


def keep_flight(rows: FlightRows, result: object) -> None:
    """Add what a task has given, if it is a flight that is not known.

    Raises:
        HarnessError: the file cannot be written, or another run adds to it.
    """
    if isinstance(result, FlightResult) and rows.flight(result.order) is None:
        rows.keep(result)


def _known(task: Task, rows: FlightRows) -> Task | None:
    if not isinstance(task, partial) or task.func is not fly_order:
        return None
    flight = rows.flight(*task.args)
    return None if flight is None else partial(_given, flight)


def _given(flight: FlightResult) -> FlightResult:
    return flight


def order_hash(order: Order) -> str:
    """What tells one flight from another, whatever it is called; of a measure, its name and its module."""
    measured = None if order.measure is None else _named_and_digested(order.measure)
    told = (order.scenario, order.overrides, order.seed, order.orbits, measured)
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]


def _named_and_digested(measure: Measure) -> str:
    source = inspect.getsource(inspect.getmodule(measure) or measure)
    return f"{measure.__module__}.{measure.__qualname__} {hashlib.sha256(source.encode()).hexdigest()[:16]}"


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise HarnessError(f"{path}: cannot be read ({error.strerror})") from None


def _no_flight(path: Path, number: int) -> HarnessError:
    return HarnessError(f"{path}: line {number} is not a flight")


def _row(path: Path, number: int, line: bytes) -> Json:
    try:
        row = json.loads(line)
    except ValueError:
        row = None
    if not isinstance(row, dict) or not any(row.keys() >= keys for keys in KEYS):
        raise _no_flight(path, number)
    return row
