"""A pytest plugin, there as soon as torquer is installed: fly a scenario in a test, and assert what it shows.

::

    def test_my_law_points(fly):
        flight = fly("microsat", orbits=3, seed=2, law="my_law.py:damp")
        flight.expect("pointing_deg.rms_last_orbit < 3", "mode_final == POINT")
        assert flight.audit().ok

The fixture ``fly`` flies on the virtual bus, in the test's own process, into a folder of pytest's. A flight
that fails (limits broken, replay not exact, a requirement missed, a law that raises) fails the test.
``flight.expect("requirements == met")`` demands that the requirements of the scenario were judged as well.
"""

import operator
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING, Any, Protocol

import pytest

if TYPE_CHECKING:
    from torquer.api.audit import Audit
    from torquer.api.laws import LawLike
    from torquer.api.run import Run

_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
_WORST_FIRST = ("failed", "not judged", "met")
"""Verdicts of requirements."""
_KINDS = {bool: "true or false", str: "a word", list: "a list", int: "a number", float: "a number"}
_EXPRESSION = re.compile(r"\s*(?P<key>[\w.]+)\s*(?P<sign><=|>=|==|!=|<|>)\s*(?P<value>\S.*?)\s*")


class ExpressionError(ValueError):
    """An expression that cannot be judged: it is none, or the summary has no such figure."""


@dataclass(frozen=True, slots=True)
class FlownScenario:
    """A flight that did not fail.

    Attributes:
        run: with its ``path``, ``summary``, ``truth`` and whatever else ``torquer.load`` gives.
    """

    run: "Run"

    def expect(self, *expressions: str) -> None:
        """Assert figures of the summary.

        Args:
            expressions: ``KEY SIGN VALUE``: a dotted key of summary.json, one of < <= > >= == !=, and a
                value of the same kind, as in TOML or a bare word. ``requirements`` is the verdict of all
                requirements of the scenario together, met, failed or not judged; ``requirements.ape`` that of
                one index.

        Raises:
            AssertionError: one does not hold; all that do not are named.
            ExpressionError: one cannot be judged.
        """
        if not expressions:
            raise ExpressionError("expect() without an expression asserts nothing")
        missed = [clause for clause in map(self._missed, expressions) if clause]
        assert not missed, f"{self.run.path}: {'; '.join(missed)}"

    def audit(self) -> "Audit":
        """The audit of its log, as by ``torquer check``: ``ok`` and ``violations``."""
        return self.run.check()

    def _missed(self, expression: str) -> str:
        """How an expression is missed, as a clause; empty if it holds."""
        found = _EXPRESSION.fullmatch(expression)
        if found is None:
            raise ExpressionError(
                f"{expression!r} is none: write for instance pointing_deg.rms_last_orbit < 3"
            )
        if found["key"].partition(".")[0] == "requirements":
            return self._requirements_missed(expression, found)
        value: Any = self.run.summary
        for part in found["key"].split("."):
            if not isinstance(value, Mapping) or part not in value:
                allowed = ", ".join(value) if isinstance(value, Mapping) else "none"
                raise ExpressionError(f"{expression!r}: no {part!r} in the summary, of {allowed}")
            value = value[part]
        wanted = _comparable(expression, found, value)
        return "" if _COMPARISONS[found["sign"]](value, wanted) else f"{expression} does not hold: {value!r}"

    def _requirements_missed(self, expression: str, found: re.Match[str]) -> str:
        """The same over the requirements of the scenario: the worst verdict of those that are meant."""
        index = found["key"].partition(".")[2]
        stated: Sequence[Mapping[str, Any]] = self.run.summary["requirements"]
        meant = [one for one in stated if index in ("", one["index"])]
        if not meant:
            there = ", ".join(dict.fromkeys(one["index"] for one in stated)) or "none"
            raise ExpressionError(f"{expression!r}: no such requirement in the scenario, of {there}")
        if found["sign"] not in ("==", "!=") or found["value"] not in _WORST_FIRST:
            allowed = ", ".join(_WORST_FIRST)
            raise ExpressionError(f"{expression!r}: a verdict is == or != one of {allowed}")
        worst = min((one["verdict"] for one in meant), key=_WORST_FIRST.index)
        if _COMPARISONS[found["sign"]](worst, found["value"]):
            return ""
        text = "; ".join(f"{one['verdict']}: {one['text']}" for one in meant if one["verdict"] == worst)
        return f"{expression} does not hold: {text}"


class Fly(Protocol):
    """What the fixture ``fly`` gives."""

    def __call__(
        self,
        scenario: str,
        *,
        orbits: float | None = None,
        seed: int = 1,
        law: "LawLike | None" = None,
        **sections: dict[str, Any],
    ) -> FlownScenario:
        """Fly a scenario by its name or path.

        Args:
            scenario: a shipped one, or a path that ends in .toml.
            orbits: how long; None: as the scenario says.
            seed: of all random streams.
            law: FILE.py:NAME, an installed law, a function or a ControlLaw, instead of the scenario's.
            sections: laid over the scenario, for instance ``control={"k_w": 1e6}``.

        Raises:
            AssertionError: the flight fails.
            InputError: the scenario or the law cannot be used.
        """


@pytest.fixture(scope="session")
def fly(tmp_path_factory: pytest.TempPathFactory) -> Fly:
    """Flies a scenario on the virtual bus, and gives its summary to be judged."""

    def fly_once(
        scenario: str,
        *,
        orbits: float | None = None,
        seed: int = 1,
        law: "LawLike | None" = None,
        **sections: dict[str, Any],
    ) -> FlownScenario:
        import torquer

        out = tmp_path_factory.mktemp("flight") / "run"
        run = torquer.fly(scenario, orbits=orbits, seed=seed, set=sections, law=law, out=out)
        assert run.ok, f"{run.path}: {'; '.join(run.failures.values())}"
        return FlownScenario(run)

    return fly_once


def _comparable(expression: str, found: re.Match[str], value: object) -> object:
    """The value that a figure of the summary is compared with; refused where the comparison tells nothing."""
    wanted = _value(found["value"])
    kind = _KINDS.get(type(value))
    no_number = isinstance(wanted, float) and isnan(wanted)  # differs from every figure
    if kind is None or kind != _KINDS.get(type(wanted)) or no_number:
        raise ExpressionError(f"{expression!r}: {value!r} in the summary cannot be compared with that")
    if found["sign"] not in ("==", "!=") and kind != "a number":
        raise ExpressionError(f"{expression!r}: only numbers have an order, {value!r} is {kind}")
    if found["key"] == "mode_final" and wanted not in (modes := _modes()):
        raise ExpressionError(f"{expression!r}: no such mode, of {', '.join(modes)}")
    return wanted


def _modes() -> tuple[str, ...]:
    from fsw.wire.messages import Mode

    return tuple(mode.name for mode in Mode)


def _value(text: str) -> object:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
