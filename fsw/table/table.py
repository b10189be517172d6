"""The onboard table: schema of a flight table file, and its checks.

A table is TOML in deg, nT and km. Sections left out take the values
of ``fsw/flight.toml``.
"""

import json
import tomllib
import zlib
from copy import deepcopy
from functools import cache
from importlib import resources
from math import ceil
from pathlib import Path
from typing import Literal, Self

from pydantic import model_validator

from fsw.core.algebra.vector import unit
from fsw.core.laws.entry import LawEntry, Need, is_met
from fsw.core.laws.table import LAWS
from fsw.core.orbit.igrf_coefficients import EPOCHS_UNIX_S
from fsw.core.orbit.tle import tle_epoch_unix_s
from fsw.input.own_code import short_name
from fsw.input.schema import (
    Nested,
    Section,
    merge,
    read_toml,
    validated,
)
from fsw.table.calibration import CalibrationTable
from fsw.table.cells import CellTable
from fsw.table.flown_elements import check_tle
from fsw.table.ordinary import ordinary_dipole_am2, ordinary_shadow_impulse_nms, ordinary_torque_nm
from fsw.table.own_law import named
from fsw.table.sections import (
    CIRCULAR_KEYS,
    BodyTable,
    CoilTable,
    ControlTable,
    EstimatorTable,
    FdirTable,
    FieldTable,
    ModesTable,
    OrbitTable,
    TelemetryTable,
    TimeTable,
    parse_utc,
)
from fsw.table.uncertainty import (
    LARGEST_FIELD_T,
    QUARTER_ORBIT_S,
    Ceiling,
    Ordinary,
    UncertaintyTable,
    bounds,
    check_bounds,
)
from fsw.table.wheel import WheelTable, check_wheel_inertia
from fsw.wire.coil_current import MOST_MA, STEP_MA

LATER_BOUNDS = (
    *("torque_variation_nm", "cell_gain_percent", "cell_light_percent"),
    *("magnetometer_orbit_nt", "magnetometer_shadow_nt", "storm_nt", "remanence_percent", "albedo_percent"),
    *("shadow_impulse_nms", "shadow_dipole_am2"),
)
"""Keys of ``[uncertainty]`` that earlier tables do not have."""
LATER_STEPS = (
    ("estimator", "magnetometer_quantum_nt"),
    ("estimator", "sun_quantum"),
    ("cells", "quantum_percent"),
)
"""Steps of readings, which they do not have either."""
TIMES_UNIX_S = (0, 2**32 - 1)
"""What ``SYNC`` carries."""

UNMET = {
    Need.PULSES: "with coils.driver = 'continuous': it plans pulses; allowed is coils.driver = 'pulsed'",
    Need.MOMENTUM: "without body.wheel_nms along the orbit's normal: it holds the axis of such a wheel",
    Need.DRIVEN_WHEEL: "without [wheel]: it asks for torques of a driven wheel",
    Need.PITCH_WHEEL: "without a [wheel] along the orbit's normal: it asks for torques of such a wheel",
}


class FlightTable(Section):
    """A whole onboard table."""

    knowledge: Literal["filter", "perfect"]
    time: TimeTable
    orbit: OrbitTable
    field: FieldTable
    body: BodyTable
    coils: CoilTable
    control: ControlTable
    uncertainty: UncertaintyTable = UncertaintyTable()
    estimator: EstimatorTable
    cells: CellTable | None = None
    modes: ModesTable
    fdir: FdirTable
    telemetry: TelemetryTable
    calibration: CalibrationTable = CalibrationTable()
    wheel: WheelTable | None = None

    @model_validator(mode="after")
    def _begins_when_models_hold(self) -> Self:
        times_s = EPOCHS_UNIX_S if self.field.model == "igrf14" else TIMES_UNIX_S
        if not times_s[0] <= self.epoch_unix_s <= times_s[-1]:
            raise ValueError(
                f"time.epoch_utc, or without it the epoch of orbit.tle, is Unix time {self.epoch_unix_s} s: "
                "IGRF-14 holds from 2015 to 2030, and another field.model, as the time on the bus, from 1970 "
                "to 2106"
            )
        check_tle(self.orbit.tle, self.epoch_unix_s, self.epoch_unix_s)
        return self

    @model_validator(mode="after")
    def _lasts_a_tick(self) -> Self:
        """A shorter pulse cannot be timed, and a shorter leak would change the sign of what is owed."""
        least_s = ceil(1000.0 / self.time.tick_hz) / 1000.0
        times_s = {"coils.pulse_s": self.coils.pulse_s, "control.leak_s": self.control.leak_s}
        for key, value_s in times_s.items():
            if value_s < least_s - 1e-9:
                raise ValueError(
                    f"{key} = {value_s:g} is not allowed: at least a tick, {least_s:g} with time.tick_hz = "
                    f"{self.time.tick_hz}"
                )
        return self

    @model_validator(mode="after")
    def _bounds_can_hold(self) -> Self:
        """Beyond these no controller could hold the satellite, or a sound coil would be called weak."""
        coils, gain = self.coils, 100.0 * (1.0 - self.fdir.weak_coil_part)
        ceilings = {
            "residual_dipole_am2": Ceiling(coils.largest_am2, "the largest dipole of a coil"),
            "torque_nm": Ceiling(
                self._most_torque_nm,
                f"what a coil of {coils.largest_am2:g} A m^2 gives in the mean, pulse and back-off, in a "
                "strong field",
            ),
            "shadow_dipole_am2": Ceiling(coils.largest_am2, "the largest dipole of a coil"),
            "shadow_impulse_nms": Ceiling(
                self._most_torque_nm * QUARTER_ORBIT_S, "what a coil gives in a quarter of an orbit"
            ),
            "coil_gain_percent": Ceiling(gain, "so that no sound coil is below fdir.weak_coil_part"),
        }
        bound_nm = bounds(self.uncertainty, self.ordinary).torque_nm
        if bound_nm > 0.0:  # otherwise no torque is carried that could vary
            ceilings["torque_variation_nm"] = Ceiling(
                2.0 * bound_nm, "from one bound of the torque, uncertainty.torque_nm, to the other"
            )
        check_bounds(self.uncertainty, ceilings)
        return self

    @model_validator(mode="after")
    def _currents_can_be_read(self) -> Self:
        """Otherwise the reading of a sound coil, saturated or rounded, would make it a weak one."""
        low_ma, _, high_ma = self.coils.levels_ma
        least_ma = 0.5 * STEP_MA / (1.0 - self.fdir.weak_coil_part)
        if self.coils.driver == "pulsed" and not least_ma <= low_ma < high_ma <= MOST_MA:
            raise ValueError(
                f"coils.levels_am2 at coils.dipole_per_ampere_am2 = {self.coils.dipole_per_ampere_am2:g} are "
                f"currents of {low_ma:.6g} to {high_ma:.6g} mA: allowed is {least_ma:.3g} to "
                f"{MOST_MA:g} mA, of which COIL_STATUS shows, in whole mA, that a coil is sound"
            )
        return self

    @property
    def ordinary(self) -> Ordinary:
        """Ordinary bounds of this satellite in its orbit; torque at most what its coils can counteract."""
        inertia = self.body.inertia
        torque_nm = min(ordinary_torque_nm(inertia, self.orbit.perigee_km), self._most_torque_nm)
        return Ordinary(
            ordinary_dipole_am2(inertia),
            torque_nm,
            1.0 / self.time.tick_hz,
            ordinary_shadow_impulse_nms(inertia),
            self.coils.levels_am2[2] if self.coils.driver == "pulsed" else 0.0,
        )

    @property
    def _most_torque_nm(self) -> float:
        """Mean torque of a coil over pulse and back-off in a strong field."""
        return self.coils.largest_am2 * self.coils.on_part * LARGEST_FIELD_T

    @model_validator(mode="after")
    def _own_field_is_of_pulses(self) -> Self:
        coils = self.calibration.coils
        if coils is not None and coils.field_nt_per_am2 is not None and self.coils.driver == "continuous":
            raise ValueError(
                "calibration.coils.field_nt_per_am2 is not allowed with coils.driver = 'continuous': the "
                "magnetometer samples while it is off"
            )
        return self

    @model_validator(mode="after")
    def _law_has_what_it_needs(self) -> Self:
        law = LAWS.get(self.control.law)
        if law is not None and not self.meets(law):
            raise ValueError(f"control.law = {self.control.law!r} is not allowed {UNMET[law.needs]}")
        return self

    @model_validator(mode="after")
    def _wheel_fits(self) -> Self:
        if self.wheel is not None and self.cells is not None:
            raise ValueError(
                "wheel is not allowed with cells: the start from cells reckons with a constant momentum"
            )
        if self.wheel is not None:
            check_wheel_inertia(self.wheel, self.body.inertia)
        return self

    def meets(self, law: LawEntry, driver: str | None = None) -> bool:
        """Whether this satellite has what a law needs, with that driver of its coils; None: its own."""
        axes = self.body.law_axes
        axis = None if self.wheel is None else unit(self.wheel.axis)
        if axis is not None and axes is not None:
            axis = axes.of_body(axis)
        return is_met(law.needs, (driver or self.coils.driver) == "pulsed", self.body.law_wheel_nms, axis)

    @property
    def epoch_unix_s(self) -> int:
        """Time of tick 0, Unix seconds."""
        return epoch_unix_s(self.time, self.orbit)

    @property
    def crc(self) -> int:
        """CRC-32 of the table in canonical JSON; of a user law the digest counts, not the path.

        A key that earlier tables do not have does not count where it is left out, nor a step that is none,
        nor the algebra that flies unless another is named, nor body axes that are those of the laws.
        """
        values = self.model_dump(mode="json")
        for key in LATER_BOUNDS:
            if getattr(self.uncertainty, key) is None:
                del values["uncertainty"][key]
        if self.estimator.algebra == "kernel":
            del values["estimator"]["algebra"]
        for section in ("cells", "wheel"):
            if getattr(self, section) is None:
                del values[section]
        if self.body.law_axes is None:
            del values["body"]["up"], values["body"]["ahead"]
        for section, key in LATER_STEPS:
            if section in values and not values[section][key]:
                del values[section][key]
        values |= {"calibration": self.calibration.model_dump(mode="json", exclude_none=True)}
        if not values["calibration"]:
            del values["calibration"]
        if self.control.own:
            values["control"]["law"] = self.control.law_name
        else:
            del values["control"]["law_sha256"]
        del values["control"]["law_withheld"]
        return zlib.crc32(json.dumps(values, sort_keys=True).encode())


DEFAULT_EPOCH_UTC = "2025-03-20T09:00:00Z"
"""Time of tick 0 for a circular orbit without one: the March equinox of 2025, to the hour."""


def epoch_unix_s(time: TimeTable, orbit: OrbitTable) -> int:
    """Time of tick 0: ``epoch_utc``, or the TLE's epoch rounded up to a whole second, or the default."""
    if time.epoch_utc is not None:
        return parse_utc(time.epoch_utc)
    if orbit.tle is not None:
        return tle_epoch_unix_s(*orbit.tle)
    return parse_utc(DEFAULT_EPOCH_UTC)


def default_values() -> Nested:
    """The content of ``fsw/flight.toml``; the caller may change it."""
    return deepcopy(_shipped_values())


@cache
def _shipped_values() -> Nested:
    return tomllib.loads(resources.files("fsw").joinpath("flight.toml").read_text(encoding="utf-8"))


def flight_table(values: Nested, source: str) -> FlightTable:
    """A checked table from values laid over the defaults.

    Raises:
        TableError: naming ``source``, the keys and what is allowed.
    """
    return validated(FlightTable, lay_over(default_values(), values), source)


def lay_over(base: Nested, over: Nested) -> Nested:
    """``over`` laid over ``base`` section by section.

    An orbit of the other kind replaces the one below; so does a law, with all that belongs to a user law.
    """
    below, above = base.get("orbit"), over.get("orbit")
    if isinstance(below, dict) and isinstance(above, dict):
        replaced = CIRCULAR_KEYS if "tle" in above else ("tle",) if above.keys() & set(CIRCULAR_KEYS) else ()
        base = {**base, "orbit": {key: value for key, value in below.items() if key not in replaced}}
    below, above = base.get("control"), over.get("control")
    if isinstance(below, dict) and isinstance(above, dict) and "law" in above:
        base = {**base, "control": _without_law(below, above["law"])}
    return merge(base, over)


def _without_law(control: Nested, new: object) -> Nested:
    """The section without the digest of its own law, and without the gains of that law if another follows."""
    kept = {key: value for key, value in control.items() if key not in ("law_sha256", "law_withheld")}
    old, gains = control.get("law"), control.get("gains")
    if not isinstance(old, str) or old in LAWS or not isinstance(gains, dict):
        return kept
    name = short_name(old)
    if isinstance(new, str) and short_name(new) == name:
        return kept
    return {**kept, "gains": {law: given for law, given in gains.items() if law != name}}


def load_flight_table(path: str | None) -> FlightTable:
    """The table in a file, or the default one.

    Raises:
        TableError: the file cannot be used.
    """
    if path is None:
        return flight_table({}, "fsw/flight.toml")
    return flight_table(named(read_toml(Path(path)), Path(path).parent), path)
