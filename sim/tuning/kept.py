"""The gains that were found, kept in files: found/NAME.toml here for scenarios that ship.

A file says under which rules, and by a checksum for which body, start and coils they were found; for others
they are not used.
"""

import json
import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NotRequired
from zlib import crc32

import tomli_w
from pydantic import TypeAdapter, ValidationError
from typing_extensions import TypedDict

from fsw.input.schema import Nested
from fsw.input.text_file import read_text
from fsw.input.toml_text import MOST_BYTES, BoundsError
from sim.errors import HarnessError, writing
from sim.record.whole_file import replace_file
from sim.scenario.schema import Scenario, flight_table
from sim.tuning.applicable import coils_of
from sim.tuning.free_gains import flat
from sim.tuning.search import SEED, TunedGains


class GainRow(TypedDict):
    """What is kept of a law: ``control`` is laid over the section of that name."""

    control: Nested
    cost: float
    cost_before: float
    rms: float
    settle_orbits: NotRequired[float]


Rows = dict[str, dict[str, GainRow]]
"""By driver and law."""
FOLDER = Path(__file__).parent / "found"
_HEAD = "# Written by `torquer design --laws`: the best gains of each law, found under equal rules.\n\n"


@dataclass(frozen=True, slots=True)
class KeptGains:
    """The gains of a file.

    Attributes:
        body: checksum of what they were found for.
        flights: the budget of each law.
        orbits: length of each flight.
        seed: of the whole flights that bear them out.
        rows: by driver and law; one without ``settle_orbits`` has never settled.
    """

    body: int
    flights: int
    orbits: float
    seed: int = SEED
    rows: Rows = field(default_factory=dict)

    def control(self, driver: str, law: str) -> Nested | None:
        """The keys of ``[control]``; None: none were found."""
        row = self.rows.get(driver, {}).get(law)
        return None if row is None else dict(row["control"])

    def with_row(self, found: TunedGains) -> "KeptGains":
        """These gains with those of one law more, or in its place."""
        row: GainRow = {
            "cost": round(found.cost.total, 6),
            "cost_before": round(found.before.total, 6),
            "rms": float(f"{found.cost.rms:.4g}"),
            "control": found.control,
        }
        if found.cost.settle_orbits is not None:
            row["settle_orbits"] = round(found.cost.settle_orbits, 4)
        of_driver = dict(sorted({**self.rows.get(found.driver, {}), found.law: row}.items()))
        return replace(self, rows=dict(sorted({**self.rows, found.driver: of_driver}.items())))


def body_checksum(scenario: Scenario) -> int:
    """Of what gains depend on: body, orbit, start, coils but for their driver, wheel, disturbances, tick."""
    turned = () if scenario.body.law_axes is None else ("up", "ahead")
    parts: Nested = {
        "body": scenario.body.model_dump(mode="json", include={"inertia_kgm2", "wheel_nms", *turned}),
        "orbit": scenario.orbit.model_dump(mode="json"),
        "initial": scenario.initial.model_dump(mode="json"),
        "coils": scenario.coils.model_dump(
            mode="json",
            include={"levels_am2", "pulse_s", "backoff_s", "backoff", "on_fraction"},
        ),
        "disturbance": scenario.disturbance.model_dump(
            mode="json", include={"torque_nm", "residual_dipole_am2"}
        ),
        "continuous": coils_of(scenario, "continuous"),
        "spin": scenario.control.spin_radps,
        "leak_s": scenario.control.leak_s,
        "tick_hz": scenario.time.tick_hz,
        "axis_only": flight_table(scenario).modes.axis_only,
    }
    if scenario.wheel is not None:
        parts["wheel"] = scenario.wheel.model_dump(mode="json")
    return crc32(json.dumps(parts, sort_keys=True).encode())


def shipped_gains(scenario: Scenario) -> KeptGains | None:
    """The gains that ship for a scenario as it is; None: there are none.

    Raises:
        HarnessError: the file cannot be read.
    """
    kept = read_gains(FOLDER / f"{scenario.name}.toml")
    return kept if kept is not None and kept.body == body_checksum(scenario) else None


def gains_text(control: Nested) -> str:
    """The gains of ``[control]`` in a line."""
    return ", ".join(f"{key} {value:.4g}" for key, value in flat(control).items()) or "the scenario's"


def read_gains(path: Path) -> KeptGains | None:
    """The gains of a file; None if there is no file.

    Raises:
        HarnessError: it cannot be read, or holds something else.
    """
    if not path.exists():
        return None
    try:
        values = tomllib.loads(read_text(path, MOST_BYTES))
        rules, rows = values.pop("found"), TypeAdapter(Rows).validate_python(values)
        return KeptGains(
            int(rules["body"]), int(rules["flights"]), float(rules["orbits"]), int(rules["seed"]), rows
        )
    except OSError as error:
        raise HarnessError(f"{path}: gains cannot be read: {error.strerror or error}") from None
    except (BoundsError, tomllib.TOMLDecodeError) as error:
        raise HarnessError(f"{path}: gains cannot be read: {error}") from None
    except KeyError as error:
        raise HarnessError(f"{path}: no gains of torquer design --laws: {error} is missing") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise HarnessError(f"{path}: no gains of torquer design --laws: {where}: {first['msg']}") from None
    except (TypeError, ValueError) as error:
        raise HarnessError(f"{path}: no gains of torquer design --laws: {error}") from None


def write_gains(path: Path, kept: KeptGains) -> None:
    """Write the file anew, whole or not at all.

    Raises:
        HarnessError: it cannot be written.
    """
    rules: Nested = {
        "found": {"body": kept.body, "flights": kept.flights, "orbits": kept.orbits, "seed": kept.seed}
    }
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, (_HEAD + tomli_w.dumps(rules | kept.rows)).encode())
