"""Columns of a campaign in words: the kind of number, what it is, its unit. Tables and charts show these."""

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import NamedTuple

from fsw.core.estimation.parameters import NAMES, SIZES
from sim.scenario.keys.editor_schema import OF_GAINS, UNITS, unit_of

POINTING, RATE, ESTIMATE, COILS, FLIGHT = "pointing", "rate", "estimate", "coils", "flight"
KINDS = (POINTING, RATE, ESTIMATE, COILS, FLIGHT)
LAST = "over the last orbit"


class ColumnWords(NamedTuple):
    """What a column holds.

    Attributes:
        kind: of figure; of an input the section of the scenario.
        words: what it is.
        unit: empty for a number without one.
    """

    kind: str
    words: str
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.words} [{self.unit}]" if self.unit else self.words


# --- The figures of a run

_POINTING = {
    "controlled_rms_last_orbit": (f"error of what is controlled, RMS {LAST}", ""),
    "controlled_max_last_orbit": (f"error of what is controlled, largest {LAST}", ""),
    "controlled_settle_orbits": ("what is controlled settled after", "orbits"),
    "pointing_deg_final": ("pointing error at the end", "deg"),
    "pointing_deg_rms_last_orbit": (f"pointing error, RMS {LAST}", "deg"),
    "pointing_deg_max_last_orbit": (f"pointing error, largest {LAST}", "deg"),
    "axis1_deg_final": ("axis 1 from the vertical at the end", "deg"),
    "axis1_deg_rms_last_orbit": (f"axis 1 from the vertical, RMS {LAST}", "deg"),
    "axis1_deg_max_last_orbit": (f"axis 1 from the vertical, largest {LAST}", "deg"),
    "axis1_deg_mean_last_orbit": (f"axis 1 from the vertical, mean {LAST}", "deg"),
    "axis1_deg_settle_orbits_5deg": ("axis 1 under 5 deg after", "orbits"),
}
_RATE = {
    "rate_degps_start": ("rate at the start", "deg/s"),
    "rate_degps_final": ("rate at the end", "deg/s"),
    "rate_degps_under_1_s": ("rate under 1 deg/s after", "s"),
    "rate_degps_under_0_1_s": ("rate under 0.1 deg/s after", "s"),
    "spin_radps_reference": ("spin rate wanted", "rad/s"),
    "spin_radps_mean_last_orbit": (f"spin rate, mean {LAST}", "rad/s"),
    "spin_radps_max_dev_last_orbit": (f"spin rate, largest deviation {LAST}", "rad/s"),
    "spin_radps_settle_s_1e-3": ("spin rate within 0.001 rad/s after", "s"),
    "spin_radps_pulses_to_settle": ("pulses until the spin rate settled", ""),
}
_ESTIMATE = {
    "estimate_deg_rms_sunlit": ("error of the estimate, RMS in sunlight", "deg"),
    "estimate_deg_rms_eclipse": ("error of the estimate, RMS in eclipse", "deg"),
    "estimate_deg_max": ("error of the estimate, largest", "deg"),
    "estimate_deg_within_3sigma": ("estimate inside its 3 sigma, part of the time", ""),
    "converged_at_s": ("estimate converged after", "s"),
    "nees_mean": ("NEES, mean", ""),
}
_COILS = {
    "pulses_total": ("pulses of all coils", ""),
    "pulses_refused": ("pulses refused", ""),
    "duty_total": ("duty of all coils, part of the time", ""),
    "min_gap_s_any": ("least gap between pulses of any coils", "s"),
    "min_gap_s_limited": ("least gap that the back-off limits", "s"),
    "max_pulse_s": ("longest pulse", "s"),
    "limits_ok": ("limits of the coils kept", ""),
}
_FLIGHT = {
    "sim_seconds": ("length of the flight", "s"),
    "orbits": ("length of the flight", "orbits"),
    "ticks": ("ticks", ""),
    "slips": ("slips", ""),
    "requirements_failed": ("requirements of the scenario missed", ""),
    "isolated_units": ("units isolated", ""),
    "event_count": ("events", ""),
}
_PARAMETERS = {
    "mag_bias_t": ("magnetometer bias", "T"),
    "torque_body_nm": ("disturbance torque", "N m"),
    "dipole_body_am2": ("residual dipole", "A m²"),
    "coil_error": ("error of the coils", ""),
    "inertia_error_kgm2": ("error of the inertia", "kg m²"),
    "mag_turn_rad": ("turn of the magnetometer", "rad"),
    "mag_scale": ("scale of the magnetometer", ""),
    "sun_turn_rad": ("turn of the Sun sensor", "rad"),
    "delay_s": ("delay", "s"),
    "cell_excess": ("excess of Sun cell", ""),
    "cell_gain": ("gain of Sun cell", ""),
    "earth_light": ("light of the Earth", ""),
}
_OF_PARAMETERS = {"value": "estimated", "sigma": "sigma", "truth": "truth"}


def _figures() -> Iterator[tuple[str, ColumnWords]]:
    for kind, table in zip(KINDS, (_POINTING, _RATE, _ESTIMATE, _COILS, _FLIGHT), strict=True):
        yield from ((name, ColumnWords(kind, *found)) for name, found in table.items())
    for index in ("ape", "mpe", "rpe", "ake"):
        kind = ESTIMATE if index == "ake" else POINTING
        yield f"{index}_deg_rms", ColumnWords(kind, f"{index.upper()}, RMS", "deg")
        yield f"{index}_deg_max", ColumnWords(kind, f"{index.upper()}, largest", "deg")
    for coil in range(3):
        yield f"pulses_per_coil_{coil}", ColumnWords(COILS, f"pulses of coil {coil}")
        yield f"duty_per_coil_{coil}", ColumnWords(COILS, f"duty of coil {coil}, part of the time")
        yield (
            f"min_gap_s_per_coil_{coil}",
            ColumnWords(COILS, f"least gap between pulses of coil {coil}", "s"),
        )
    for name in NAMES:
        words, unit = _PARAMETERS[name]
        for key, column in _OF_PARAMETERS.items():
            for place in range(SIZES[name]):
                element = f" {place + 1}" if SIZES[name] > 1 else ""
                yield (
                    f"parameters_{name}_{key}_{place}",
                    ColumnWords(ESTIMATE, f"{words}{element}, {column}", unit),
                )


FIGURE_WORDS: Mapping[str, ColumnWords] = dict(_figures())
"""Of every figure of a run, by its column."""


# --- What is drawn

_ONBOARD = "onboard table"
_SECTIONS = {"sensors": "", "flight": _ONBOARD}
"""Sections of keys that have other words, or none beside those of the section below."""


def input_words(key: str) -> ColumnWords:
    """A key of the scenario in words, as a dispersion names it: ``sensors.magnetometer.bias_nt.0``.

    Elements count from 1 in words; ``length`` is that of a vector.
    """
    parts = key.split(".")
    *sections, name = [part for part in parts if not part.isdigit()] or [key]
    of_length = name == "length" and bool(sections)
    if of_length:
        *sections, name = sections
    named = [_SECTIONS.get(section, section.replace("_", " ")) for section in sections]
    kind = " ".join(filter(None, named)) or "scenario"
    words = " ".join(filter(None, (*named, _without_unit(name))))
    elements = ".".join(str(int(part) + 1) for part in parts if part.isdigit())
    if elements:
        words += f", component {elements}"
    return ColumnWords(kind, words + ", length" * of_length, unit_of(name).replace("^2", "²"))


def _without_unit(name: str) -> str:
    """The name of a key without its unit, in words; a gain keeps its name."""
    if name in OF_GAINS:
        return name
    end = next((end for end, _ in UNITS if name.endswith(end)), "")
    return name.removesuffix(end).replace("_", " ")


# --- Probabilities


def percent(fraction: float) -> str:
    """A probability in percent with all its digits: two that differ have different words."""
    return f"{(100 * Decimal(repr(float(fraction)))).normalize():f} %"
