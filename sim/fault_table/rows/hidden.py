"""Rows with faults that are hard to distinguish from an uncertainty, and with two faults in turn."""

from dataclasses import replace
from math import inf

from sim.fault_table.row import FaultRow, RowFault, Unseen, When

SLOW = "a sensor that drifts, twists or is late"
FROM_BOOT = "a Sun sensor turned, samples late or a coil weak from the first tick on"
TABLE = "a satellite that is not the one of its table"
IN_TURN = "a second fault after the first, or none any more"
STUCK = "a driver that is stuck on from the beginning of an eclipse, for an orbit"
MAG, SUN = "magnetometer", "sun sensor"
ORBIT_S = 6042.0
"""Period of the scenario's orbit."""


def _slow(
    name: str,
    kind: str,
    unit: str,
    *expect: str,
    within_s: float = inf,
    watch_s: float = ORBIT_S,
    **parameters: float,
) -> FaultRow:
    """A fault that begins after a whole orbit without one, and stays.

    A magnetometer is the only sensor in the shadow.
    """
    return FaultRow(
        name,
        SLOW,
        kind,
        parameters,
        inf,
        When.ORBIT,
        expect,
        unit,
        within_s=within_s,
        unseen=Unseen.IN_SHADOW if unit == MAG else Unseen.NEVER,
        watch_s=watch_s,
    )


def _from_boot(name: str, kind: str, unit: str, *then: RowFault, **parameters: float) -> FaultRow:
    """A fault from boot on: which unit is faulty is then not always observable."""
    return FaultRow(name, FROM_BOOT, kind, parameters, inf, When.BOOT, (), unit, then=then, watch_s=ORBIT_S)


def _table(name: str, setting: str) -> FaultRow:
    """No fault: the onboard table is wrong, beyond what it declares. In the shadow the filter trusts it."""
    watch_s, unseen = 2.0 * ORBIT_S, Unseen.IN_SHADOW
    return FaultRow(
        name, TABLE, "none", {}, 1.0, When.BOOT, settings=(setting,), unseen=unseen, watch_s=watch_s
    )


def _in_turn(name: str, first: RowFault, second: RowFault, watch_s: float) -> FaultRow:
    """Both units must be named, each within an orbit of its fault, or the sensors be reported to disagree.

    Where the first fault begins in the shadow, or where it does not show at once, the other sensor may just
    as well be the wrong one when both have samples again. The Sun alone does not show rotation about it.
    """
    return FaultRow(
        name,
        IN_TURN,
        first.kind,
        first.parameters,
        first.lasts_s,
        When.ORBIT,
        ("named or doubted",),
        first.unit,
        within_s=ORBIT_S,
        then=(second,),
        unseen=Unseen.ALONE,
        watch_s=watch_s,
    )


def _stuck(name: str, axis: float, ampere: float) -> FaultRow:
    """SAFE is entered at once, and the board reports that a current flows.

    While it flows the magnetometer is useless: in the shadow nothing shows which coil it is in.
    """
    return FaultRow(
        name,
        STUCK,
        "coil_stuck_on",
        {"axis": axis, "ampere": ampere},
        inf,
        When.ECLIPSE,
        ("stuck", "board names"),
        f"coil {axis:g}",
        watch_s=ORBIT_S,
    )


def _wrong_field(lasts_s: float, after_s: float = 0.0) -> RowFault:
    return RowFault("mag_scale", {"axis": 2.0, "scale": -1.0}, lasts_s, MAG, after_s)


def _wrong_sun(lasts_s: float, after_s: float = 0.0) -> RowFault:
    return RowFault("sun_swapped", {"axis": 1.0}, lasts_s, SUN, after_s)


def _reversed_coil(after_s: float, shows: bool = True) -> RowFault:
    return RowFault("coil_wired", {"axis": 1.0, "scale": -1.0}, inf, "coil 1", after_s, shows)


SLY_ROWS: tuple[FaultRow, ...] = (
    _slow("mag-twist", "mag_turned", MAG, axis=0.0, deg=0.0, per_s=5e-3),
    _slow(
        "mag-gain",
        "mag_scale",
        MAG,
        "named or doubted",
        within_s=ORBIT_S,
        axis=0.0,
        scale=1.0,
        per_s=0.3 / ORBIT_S,
    ),
    _slow("mag-drift-slow", "mag_bias", MAG, watch_s=9000.0, axis=1.0, nt=0.0, per_s=0.2),
    _slow("mag-drift", "mag_bias", MAG, "named or doubted", within_s=ORBIT_S, axis=1.0, nt=0.0, per_s=1.0),
    _slow("mag-late", "mag_late", MAG, watch_s=3000.0),
    _slow("sun-late", "sun_late", SUN, watch_s=3000.0),
    replace(
        _slow("both-late", "mag_late", MAG, watch_s=3000.0),
        then=(RowFault("sun_late", {}, inf, SUN),),
        unseen=Unseen.ALONE,
    ),
    replace(_from_boot("mag-late-boot", "mag_late", MAG), unseen=Unseen.AT_FIRST),
    replace(
        _from_boot("both-late-boot", "mag_late", MAG, RowFault("sun_late", {}, inf, SUN)),
        unseen=Unseen.ALWAYS,
    ),
    _from_boot("sun-turned-boot", "sun_turned", SUN, axis=2.0, deg=20.0),
    replace(
        _from_boot("sun-turned-within-bound", "sun_turned", SUN, axis=2.0, deg=10.0),
        unseen=Unseen.WITHIN_BOUND,
    ),
    replace(
        _from_boot(
            "both-turned-boot",
            "mag_turned",
            MAG,
            RowFault("sun_turned", {"axis": 2.0, "deg": 10.0}, inf, SUN),
            axis=2.0,
            deg=10.0,
        ),
        unseen=Unseen.ALWAYS,
    ),
    _from_boot("coil-weak-boot", "coil_wired", "coil 1", axis=1.0, scale=0.7),
    _table("inertia-permuted", "flight.body.inertia_kgm2=[1.85, 1.95, 1.02]"),
    _table("inertia-larger", "flight.body.inertia_kgm2=[0.68, 1.2333, 1.3]"),
    _table("dipole-large", "disturbance.residual_dipole_am2=[0.2, -0.2, 0.1]"),
    _table("tle-old", "orbit.along_track_km=20.0"),
    _table("clock-off", 'flight.time.epoch_utc="2015-03-27T02:47:27Z"'),
    _in_turn("sun-then-coil", _wrong_sun(inf), _reversed_coil(600.0), 600.0 + ORBIT_S),
    _in_turn("mag-then-coil", _wrong_field(inf), _reversed_coil(600.0, shows=False), 600.0 + ORBIT_S),
    _in_turn("mag-then-sun", _wrong_field(900.0), _wrong_sun(inf, 3000.0), 3000.0 + ORBIT_S),
    _in_turn("sun-then-mag", _wrong_sun(900.0), _wrong_field(inf, 3000.0), 3000.0 + ORBIT_S),
    FaultRow(
        "coil-open-passing",
        IN_TURN,
        "coil_open",
        {"axis": 0.0},
        ORBIT_S,
        When.ORBIT,
        ("named", "used again"),
        "coil 0",
        settings=("flight.fdir.coil_retest_s=1800.0",),
        watch_s=ORBIT_S,
    ),
    _stuck("coil-stuck-through-eclipse", 2.0, -0.4),
    _stuck("coil-stuck-low-through-eclipse", 1.0, 0.025),
)
