"""What is varied: each quantity alone, all else as in ``microsat``."""

import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from statistics import median
from typing import NamedTuple

from fsw.core.algebra.vector import Vec3
from fsw.input.schema import Nested, merge
from fsw.table.config import flight_config
from sim.design.limits.linear_flight import Passed, fly, least_deg, orbits_of
from sim.scenario.schema import Scenario, flight_table, load

SCENARIO = "microsat"
LAWS = ("mpc", "pulse_mpc")
STARTS_RAD: tuple[Vec3, ...] = ((0.03, 0.04, -0.02), (-0.04, 0.02, 0.03))
"""Attitudes at first."""
BOUND = "bound"
"""In the place of a law: what no law betters."""
NO_TORQUE: Nested = {"disturbance": {"torque_nm": [0.0, 0.0, 0.0]}}


class Line(NamedTuple):
    """A line of the picture: law or bound, and whether the torque of ``microsat`` acts."""

    law: str
    torque: bool = True


WITH_TORQUE = tuple(Line(law) for law in (BOUND, *LAWS))
LINES = (*WITH_TORQUE, *(line._replace(torque=False) for line in WITH_TORQUE))


@dataclass(frozen=True, slots=True)
class Setting:
    """One value of a quantity: how it is called, where it stands on the axis, what it is in a scenario."""

    label: str
    at: float
    overrides: Nested


@dataclass(frozen=True, slots=True)
class Sweep:
    """What is varied.

    Attributes:
        title: what it is.
        label: with its unit.
        scale: ``log``, ``linear``, or ``names``: one beside the other.
        settings: its values.
        calm: whether it is flown without a torque too.
    """

    title: str
    label: str
    scale: str
    settings: tuple[Setting, ...]
    calm: bool = True

    @property
    def lines(self) -> tuple[Line, ...]:
        """What is flown at each value."""
        return LINES if self.calm else WITH_TORQUE


@dataclass(frozen=True, slots=True)
class LinearOrder:
    """A flight of the linear body, or a bound: of which there is no start."""

    law: str
    overrides: Nested
    start: int = 0

    @property
    def key(self) -> str:
        """The same for what is flown the same, whichever quantity is varied."""
        return f"{self.law} {self.start} {_crc(json.dumps(self._values(), sort_keys=True)):08x}"

    def scenario(self) -> Scenario:
        """What is flown."""
        return load(SCENARIO, self._values())

    def error_deg(self, orbits: "Orbits") -> float:
        """The RMS error of the orbits that count."""
        scenario = self.scenario()
        met = orbits.of(scenario)
        if self.law == BOUND:
            config = flight_config(flight_table(scenario))
            return least_deg(config, scenario.disturbance.torque_nm, met)
        return fly(scenario, STARTS_RAD[self.start], met).rms_deg()

    def _values(self) -> Nested:
        """Of a bound the coils do not count, nor a residual dipole."""
        if self.law != BOUND:
            return merge(self.overrides, {"control": {"law": self.law}})
        torque = self.overrides.get("disturbance", {}).get("torque_nm")
        return {} if torque is None else {"disturbance": {"torque_nm": torque}}


@cache
def _crc(overrides: str) -> int:
    """Of the scenario with overrides, JSON, laid over it."""
    return zlib.crc32(load(SCENARIO, json.loads(overrides)).model_dump_json().encode())


class Orbits:
    """The orbit a tick at a time, computed once for each length of a tick."""

    def __init__(self) -> None:
        """Nothing is computed yet."""
        self._met: dict[int, list[Passed]] = {}

    def of(self, scenario: Scenario) -> Sequence[Passed]:
        """What a satellite of this sweep meets."""
        hz = scenario.time.tick_hz
        if hz not in self._met:
            self._met[hz] = orbits_of(flight_config(flight_table(scenario)))
        return self._met[hz]


def orders_of(setting: Setting, line: Line) -> list[LinearOrder]:
    """The flights of a law, or the bound."""
    overrides = setting.overrides if line.torque else merge(setting.overrides, NO_TORQUE)
    if line.law == BOUND:
        return [LinearOrder(BOUND, overrides)]
    return [LinearOrder(line.law, overrides, start) for start in range(len(STARTS_RAD))]


def all_orders() -> list[LinearOrder]:
    """All there are, each once."""
    found = {
        order.key: order
        for quantity in QUANTITIES
        for setting in quantity.settings
        for line in quantity.lines
        for order in orders_of(setting, line)
    }
    return list(found.values())


def error_deg(setting: Setting, line: Line, flown: Mapping[str, float]) -> float | None:
    """The median over the starts; None where there is none."""
    errors = [flown[order.key] for order in orders_of(setting, line) if order.key in flown]
    return median(errors) if errors else None


def better_than_bound(flown: Mapping[str, float]) -> list[str]:
    """The settings in which a flight has less error than the bound: there can be none."""
    found = []
    for quantity in QUANTITIES:
        for setting in quantity.settings:
            for line in quantity.lines:
                least = error_deg(setting, line._replace(law=BOUND), flown)
                errors = [flown[order.key] for order in orders_of(setting, line) if order.key in flown]
                if least is not None and line.law != BOUND and any(error < least for error in errors):
                    found.append(f"{line.law}, {quantity.label} {setting.label}")
    return found


def _backoff(seconds: float) -> Setting:
    return Setting(f"{seconds:g}", seconds, {"coils": {"backoff_s": seconds}})


def _pulse(seconds: float, tick_hz: int = 1) -> Setting:
    return Setting(f"{seconds:g}", seconds, {"coils": {"pulse_s": seconds}, "time": {"tick_hz": tick_hz}})


def _levels(levels_am2: Sequence[float], at: float) -> Setting:
    """Each set of levels with coils that take ``STRONGEST_A`` at the strongest."""
    label = ", ".join(f"{level:g}" for level in levels_am2)
    per_ampere = levels_am2[-1] / STRONGEST_A
    return Setting(
        label, at, {"coils": {"levels_am2": list(levels_am2), "dipole_per_ampere_am2": per_ampere}}
    )


def _torque(nano_nm: float) -> Setting:
    return Setting(f"{nano_nm:g}", nano_nm, {"disturbance": {"torque_nm": [nano_nm / 1e9] * 3}})


def _dipole(per_axis_am2: float) -> Setting:
    overrides: Nested = {"disturbance": {"residual_dipole_am2": [per_axis_am2] * 3}}
    return Setting(f"{per_axis_am2:g}", per_axis_am2, overrides)


STRONGEST_A = 0.4
"""As in the scenario; currents do not count here, but the table takes none that COIL_STATUS cannot show."""
RATIOS = (
    (0.5, 0.501, 0.502),
    (0.5, 1.0, 2.0),
    (0.5, 2.0, 8.0),
    (2.0, 2.01, 2.02),
    (2.0, 4.0, 8.0),
    (8.0, 8.01, 8.02),
)
QUANTITIES = (
    Sweep(
        "Back-off",
        "back-off [s]",
        "linear",
        (*map(_backoff, (0.0, 10.0, 20.0, 40.0, 70.0, 100.0, 130.0, 160.0)),),
    ),
    Sweep("Length of a pulse", "pulse [s]", "linear", (_pulse(0.5, 2), *map(_pulse, (1.0, 2.0, 3.0)))),
    Sweep(
        "Size of the levels",
        "strongest level, the others 1/4 and 1/16 [A m²]",
        "log",
        tuple(
            _levels([top / 16.0, top / 4.0, top], top) for top in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
        ),
    ),
    Sweep(
        "Ratio of the levels",
        "levels [A m²]",
        "names",
        tuple(_levels(levels, place) for place, levels in enumerate(RATIOS)),
    ),
    Sweep(
        "Constant torque",
        "constant torque of each axis [nN m]",
        "linear",
        tuple(map(_torque, (0.0, 10.0, 30.0, 100.0, 200.0, 300.0))),
        calm=False,
    ),
    Sweep(
        "Residual dipole",
        "residual dipole of each axis [A m²]",
        "linear",
        tuple(map(_dipole, (0.0, 0.01, 0.03, 0.05, 0.1))),
    ),
)
