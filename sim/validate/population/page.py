"""docs/population.md, made of flights alone."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf
from statistics import median

from sim.campaign.claim import ClaimOutcome
from sim.campaign.consistency import POINTED_DEG
from sim.campaign.flight import FlightResult
from sim.campaign.population import POPULATIONS, Tolerances
from sim.validate.page import claims_table, platform_line, tally
from sim.validate.population.pictures import Flights, SizeSpread, worst_inside
from sim.validate.population.sweep import Quantity

HEAD = """# Populations of real satellites

Written by `make population`; do not edit. No satellite is what its onboard table says. Here random ones fly,
drawn by `sim/campaign/population.py` within the tolerances below: the plant gets what is true, the onboard
table keeps the nominal values. Satellite 7 of a population is the same wherever it flies, and its sensors and
coils are healthy: none may be isolated. The law is `mpc`; a flight takes eight orbits, fourteen from 5 deg/s,
and begins up to 60 deg and 0.05 deg/s by axis off, where it does not tumble. The 6U has drag and light
besides. In each of them the magnetometer's bias follows orbit and shadow, a storm disturbs the field at high
latitude, coils keep some of each pulse, the dipole changes and the body snaps at the shadow's edge, and the
Sun sensor sees an Earth with clouds.

The tolerances are an own estimate, and no more than the onboard table declares, but for the population
`twice`. The dipole is that of a satellite whose own was measured: one that was not has some mA m^2 per kg
([uncertainty.md](uncertainty.md)), at 50 kg as much as the largest here or several times that; what 0.2 A m^2
does is in the table of one difference.

An honest filter has each axis of its error inside 3 sigma for 99.7 % of the time.
"""

SWEEP = """## One difference alone

Satellites of the 50 kg population, in which one quantity is given sizes from none to twice the bound that is
declared, the dotted line; all else is as drawn. The dipole keeps its direction, the error of the inertia its
shape, and the sensors turn about the same axes, the same part of their bounds each.
"""

REACHED = """RMS of the pointing error over the last three orbits. The continuous driver has the same coils
and holds any dipole up to the highest level, for half of each tick, where the others give pulses of 3 s with
a back-off of 100 s that all coils share."""

TOLERANCES = (
    ("moments of inertia, each", "inertia_percent", "%"),
    ("products of inertia, of the mean moment", "products_percent", "%"),
    ("residual dipole, any direction, log-uniform", "residual_dipole_am2", "A m^2"),
    ("what the shadow adds to the dipole, of the largest one", "eclipse_dipole_percent", "%"),
    ("remanence, of the dipole of a pulse", "remanence_percent", "%"),
    ("dipole of a coil", "coil_gain_percent", "%"),
    ("axis of a coil, whole turn", "coil_misalignment_deg", "deg"),
    ("magnetometer bias, by axis", "magnetometer_bias_nt", "nT"),
    ("amplitude of its bias over the orbit, by axis", "magnetometer_orbit_nt", "nT"),
    ("its bias in shadow, by axis", "magnetometer_shadow_nt", "nT"),
    ("magnetometer scale, by axis", "magnetometer_scale_percent", "%"),
    ("magnetometer, whole turn", "magnetometer_misalignment_deg", "deg"),
    ("magnetometer, angles between its axes, within that turn", "non_orthogonality_deg", "deg"),
    ("Sun sensor, whole turn", "sun_misalignment_deg", "deg"),
    ("light of the Earth, of sunlight", "albedo_percent", "%"),
    ("storm at high latitude", "storm_nt", "nT"),
    ("torque by axis, with its daily variation", "torque_nm", "N m"),
    ("change of the rate at the shadow's edge, by axis", "snap_radps", "rad/s"),
    ("position along the track", "along_track_km", "km"),
    ("age of the samples of both sensors", "latency_s", "s"),
)
"""Name, attribute and unit of what a population may differ by."""


def page(
    outcomes: Sequence[ClaimOutcome],
    populations: Mapping[str, Flights],
    lifted: Mapping[str, Flights],
    sweep: Mapping[Quantity, Sequence[SizeSpread]],
    pictures: Sequence[str],
    flown: str,
) -> str:
    """The page.

    Args:
        outcomes: of all claims.
        populations: the flights of each population as it is, by its name.
        lifted: those of the same satellites without the limits of pulses.
        sweep: by quantity, its sizes.
        pictures: file names of that of the satellites and that of the sweep.
        flown: how many flights it is made of, a sentence.
    """
    of_satellites, of_sweep = pictures
    lines = [HEAD, tally(outcomes) + ".", "", *claims_table(outcomes), ""]
    lines += [SWEEP, f"![pointing, estimate and honesty over the size of one difference]({of_sweep})", ""]
    lines += [*sweep_table(sweep), "", "## All differences at once", ""]
    lines += [f"![pointing and honesty of each satellite over what differs]({of_satellites})", ""]
    lines += [_row("differs within", *POPULATIONS, "unit"), "|---" * (2 + len(POPULATIONS)) + "|"]
    drawn = [chosen.tolerances for chosen in POPULATIONS.values()]
    lines += [_row(name, *(_bound(at, key) for at in drawn), unit) for name, key, unit in TOLERANCES]
    lines += ["", "## What they reach", "", REACHED, "", *reached_table({**populations, **lifted})]
    for name, flights in populations.items():
        lines += [
            "",
            f"## {name}",
            "",
            *satellites_table(flights),
            *why_not_pointed(flights, lifted.get(f"{name}_continuous", ())),
        ]
    return "\n".join([*lines, "", f"{flown} {platform_line()}.", ""])


def sweep_table(sweep: Mapping[Quantity, Sequence[SizeSpread]]) -> Iterator[str]:
    """A row for each size of each quantity."""
    yield _row("of one alone", "size", "satellites", "pointing [deg]", "estimate [deg]", "inside 3 sigma [%]")
    yield "|---" * 6 + "|"
    for quantity, sizes in sweep.items():
        for at in sizes:
            pairs = (at.pointing_deg, at.estimate_deg, at.inside_percent)
            spreads = [f"{middle:.4g}, worst {worst:.4g}" for middle, worst in pairs]
            yield _row(quantity.label, f"{at.size:.3g}", str(at.satellites), *spreads)


def satellites_table(flights: Flights) -> list[str]:
    """A row for each satellite."""
    return [_row(*COLUMNS), "|---" * len(COLUMNS) + "|", *map(_satellite, flights)]


def reached_table(populations: Mapping[str, Flights]) -> list[str]:
    """A row for each population: what share of its satellites comes within what error."""
    head = [f"within {most:g} deg [%]" for most in REACHED_DEG]
    lines = [_row("satellites", "median [deg]", *head), "|---" * (2 + len(head)) + "|"]
    for name, flights in populations.items():
        if not flights:
            continue
        errors = sorted(flight.figures["pointing_deg"] for flight in flights)
        shares = [100.0 * sum(error <= most for error in errors) / len(errors) for most in REACHED_DEG]
        lines.append(_row(name, f"{median(errors):.2f}", *(f"{share:.0f}" for share in shares)))
    return lines


def why_not_pointed(flights: Flights, lifted: Flights) -> list[str]:
    """How many never come to point, of which dipoles, and what they do without limits of pulses; or nothing.

    ``lifted``: flights of the same satellites without those limits; none: nothing says what holds them.
    """
    lost = [one for one in flights if one.figures["pointed_orbits"] == inf]
    if not lost:
        return []
    dipoles = [one.figures["dipole_am2"] for one in lost]
    sentence = (
        f"{len(lost)} of {len(flights)} never come within {POINTED_DEG:g} deg for good, for the last orbit "
        f"at least; their dipoles are {min(dipoles):.4f} to {max(dipoles):.4f} A m^2."
    )
    seeds = {one.order.seed for one in lost}
    same = [one.figures["pointing_deg"] for one in lifted if one.order.seed in seeds]
    if same:
        freed = sum(error_deg <= POINTED_DEG for error_deg in same)
        sentence += (
            f" With the continuous driver {freed} of these {len(same)} point within {POINTED_DEG:g} deg: "
            f"the back-off holds them. The other {len(same) - freed} are held by coils and law themselves."
        )
    return ["", sentence]


REACHED_DEG = (2.5, 5.0, 10.0, 20.0)
COLUMNS = (
    "satellite",
    "dipole [A m^2]",
    "inertia [%]",
    "sensors [deg]",
    "inside 3 sigma [%]",
    "NEES",
    "estimate [deg]",
    "pointing [deg]",
    "10 deg from orbit",
    "isolated",
)


def _satellite(flight: FlightResult) -> str:
    found = flight.figures
    pointed = found["pointed_orbits"]
    return _row(
        str(flight.order.seed),
        f"{found['dipole_am2']:.4f}",
        f"{found['inertia_percent']:.1f}",
        f"{found['misalignment_deg']:.2f}",
        f"{100.0 * worst_inside(flight):.1f}",
        f"{found['nees']:.1f}",
        f"{found['estimate_deg']:.2f}",
        f"{found['pointing_deg']:.2f}",
        "never" if pointed == inf else f"{pointed:.2f}",
        ", ".join(flight.summary["isolated"]) or "none",
    )


def _bound(tolerances: Tolerances, key: str) -> str:
    value = getattr(tolerances, key)
    return f"{value[0]:g} to {value[1]:g}" if isinstance(value, tuple) else f"{value:g}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
