"""Basilisk's spacecraft at the start of a scenario: orbit, attitude, field, Sun and shadow.

Frame ``eci`` is that in which SGP4 works, of date; the Earth turns in it about axis 3. Frame ``orbit`` is
radius, along-track, normal. In the nominal attitude the body axes ``up`` and ``ahead`` are along the first
two.
"""

from datetime import UTC, datetime
from math import ceil, cos, pi, radians, sin, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from Basilisk.architecture import messaging
from Basilisk.simulation import (
    GravityGradientEffector,
    MtbEffector,
    eclipse,
    extForceTorque,
    magneticFieldWMM,
    spacecraft,
    sphericalHarmonicsGravityModel,
)
from Basilisk.utilities import RigidBodyKinematics, SimulationBaseClass, macros, simIncludeGravBody
from sgp4.api import Satrec

IGRF = Path(__file__).resolve().parents[2] / "sim" / "plant" / "environment" / "igrf14.shc"
"""Coefficients of the geomagnetic field by IAGA, a table of numbers: the wheel of Basilisk brings none."""

MU_M3PS2, EARTH_M, AU_M = 3.986004418e14, 6378.137e3, 149597870.7e3
ZONAL = (1.08262668e-3, -2.5327e-6, -1.6196e-6)
"""J2, J3, J4 (EGM96): SGP4, which the flight software predicts the orbit with, has the same three."""
STEP_S = 0.25
"""Of Basilisk's integration, by the classic Runge-Kutta method; the field is held over a step."""
DAY_S, UNIX_EPOCH_JD, J2000_UNIX_S = 86400, 2440587.5, 946728000

Array = npt.NDArray[np.float64]
Scenario = dict[str, Any]


def nominal_attitude(body: dict[str, Any]) -> Array:
    """The matrix that carries orbit to body axes where the axes ``up`` and ``ahead`` look as named."""
    up, ahead = _axis(body.get("up", "x")), _axis(body.get("ahead", "y"))
    return np.column_stack((up, ahead, np.cross(up, ahead)))


def _axis(name: str) -> Array:
    along: Array = np.eye(3)["xyz".index(name[-1])]
    return -along if name.startswith("-") else along


class State(NamedTuple):
    """The truth at the instant of a tick."""

    r_eci_m: Array
    v_eci_mps: Array
    body_from_eci: Array
    omega_body_radps: Array
    b_body_t: Array
    sun_body: Array
    lit: float


# --- Time, Sun and field


def epoch_unix_s(scenario: Scenario) -> int:
    """That which the scenario names, or that of its elements, rounded up to a whole second."""
    if named := scenario["time"].get("epoch_utc"):
        return ceil(datetime.fromisoformat(named).replace(tzinfo=UTC).timestamp())
    line = scenario["orbit"]["tle"][0]
    year, day = int(line[18:20]), float(line[20:32])
    year += 1900 if year >= 57 else 2000
    return ceil(datetime(year, 1, 1, tzinfo=UTC).timestamp() + round((day - 1.0) * DAY_S, 6))


def earth_from_eci(unix_s: float) -> Array:
    """A turn about the pole by Greenwich mean sidereal time (Aoki et al. 1982), UT1 = UTC."""
    days, second = divmod(unix_s - J2000_UNIX_S, DAY_S)
    centuries = (days + second / DAY_S) / 36525.0
    turns = (
        second + 67310.54841 + 8640184.812866 * centuries + 0.093104 * centuries**2 - 6.2e-6 * centuries**3
    )
    angle = 2.0 * pi * (turns / DAY_S % 1.0)
    return np.array([[cos(angle), sin(angle), 0.0], [-sin(angle), cos(angle), 0.0], [0.0, 0.0, 1.0]])


def sun_eci_m(unix_s: float) -> Array:
    """Geocentric position of the Sun, of date (Astronomical Almanac, page C5; within 0.01 deg)."""
    days = (unix_s - J2000_UNIX_S) / DAY_S
    anomaly = radians(357.528 + 0.9856003 * days)
    longitude = radians(280.460 + 0.9856474 * days + 1.915 * sin(anomaly) + 0.020 * sin(2.0 * anomaly))
    obliquity = radians(23.439 - 4e-7 * days)
    distance_m = AU_M * (1.00014 - 0.01671 * cos(anomaly) - 0.00014 * cos(2.0 * anomaly))
    across = sin(longitude)
    return distance_m * np.array([cos(longitude), cos(obliquity) * across, sin(obliquity) * across])


def wmm_table(year: int) -> str:
    """IGRF-14 of ``year`` to degree 12 and its change over five years, in the format that Basilisk reads."""
    lines = [
        line.split() for line in IGRF.read_text(encoding="ascii").splitlines() if not line.startswith("#")
    ]
    column = [float(one) for one in lines[1]].index(float(year))
    found = {
        (int(n), int(m)): [float(one) for one in values[column : column + 2]] for n, m, *values in lines[2:]
    }
    rows = [f"    {year}.0            IGRF-14        01/01/{year}"]
    for n in range(1, 13):
        for m in range(n + 1):
            (g, g_next), (h, h_next) = found[n, m], found[n, -m] if m else [0.0, 0.0]
            rows.append(f"{n:3d}{m:3d} {g:9.2f} {h:9.2f} {(g_next - g) / 5:10.3f} {(h_next - h) / 5:10.3f}")
    return "\n".join([*rows, "9" * 48, "9" * 48, ""])


# --- Basilisk's spacecraft


class Satellite:
    """Orbit, attitude, field, Sun and shadow by Basilisk, from the start of a scenario.

    Args:
        scenario: the resolved scenario.
        epoch: unix time of tick 0 [s].
    """

    def __init__(self, scenario: Scenario, epoch: int) -> None:
        self._epoch, self._tick_s = epoch, 1.0 / scenario["time"]["tick_hz"]
        self._residual_am2 = np.array(scenario["disturbance"]["residual_dipole_am2"])
        self._sim = sim = SimulationBaseClass.SimBaseClass()
        step_ns = macros.sec2nano(min(STEP_S, self._tick_s))
        sim.CreateNewProcess("process").addTask(sim.CreateNewTask("task", step_ns))
        self._body = body = spacecraft.Spacecraft()
        body.hub.mHub = 50.0  # no force depends on it
        body.hub.IHubPntBc_B = inertia(scenario).tolist()
        self._gravity = gravity = simIncludeGravBody.gravBodyFactory()
        earth = gravity.createEarth()
        earth.isCentralBody, earth.mu, earth.gravityModel = True, MU_M3PS2, zonal_gravity()
        gravity.addBodiesTo(body)
        self._place(scenario)
        gradient = GravityGradientEffector.GravityGradientEffector()
        gradient.addPlanetName(earth.planetName)
        constant = extForceTorque.ExtForceTorque()
        constant.extTorquePntB_B = [[axis] for axis in scenario["disturbance"]["torque_nm"]]
        self._sun, self._earth = messaging.SpicePlanetStateMsg(), messaging.SpicePlanetStateMsg()
        self._field = field = magneticFieldWMM.MagneticFieldWMM()
        start = datetime.fromtimestamp(epoch, UTC)
        self._date = messaging.EpochMsg().write(epoch_payload(start))
        field.epochInMsg.subscribeTo(self._date)
        field.planetPosInMsg.subscribeTo(self._earth)
        field.addSpacecraftToModel(body.scStateOutMsg)
        self._shadow = shadow = eclipse.Eclipse()
        shadow.sunInMsg.subscribeTo(self._sun)
        shadow.addPlanetToModel(self._earth)
        shadow.addSpacecraftToModel(body.scStateOutMsg)
        coils, self._dipole = MtbEffector.MtbEffector(), messaging.MTBCmdMsg()
        self._axes = messaging.MTBArrayConfigMsg().write(three_axes())
        coils.mtbCmdInMsg.subscribeTo(self._dipole)
        coils.mtbParamsInMsg.subscribeTo(self._axes)
        coils.magInMsg.subscribeTo(field.envOutMsgs[0])
        for effector in (gradient, constant, coils):
            body.addDynamicEffector(effector)
        self._modules = (body, gradient, constant, coils, field, shadow)
        for module in self._modules:
            sim.AddModelToTask("task", module)
        self._surround(0, np.zeros(3))
        with TemporaryDirectory() as folder:
            table = Path(folder, "igrf.COF")
            table.write_text(wmm_table(start.year - start.year % 5), encoding="ascii")
            field.configureWMMFile(str(table))
            sim.InitializeSimulation()  # reads it
        self._run(0)

    def advance(self, tick: int, m_body_am2: Array) -> None:
        """Go on to the instant of ``tick``, the next one; until then the coils have this dipole."""
        self._surround(tick, m_body_am2)
        self._run(tick)

    def state(self, tick: int) -> State:
        """The truth now, at the instant of ``tick``."""
        now = self._body.scStateOutMsg.read()
        r_m, body_from_eci = np.array(now.r_BN_N), RigidBodyKinematics.MRP2C(np.array(now.sigma_BN))
        to_sun_m = sun_eci_m(self._epoch + tick * self._tick_s) - r_m
        return State(
            r_m,
            np.array(now.v_BN_N),
            body_from_eci,
            np.array(now.omega_BN_B),
            body_from_eci @ np.array(self._field.envOutMsgs[0].read().magField_N),
            body_from_eci @ to_sun_m / np.linalg.norm(to_sun_m),
            self._shadow.eclipseOutMsgs[0].read().shadowFactor,
        )

    def _place(self, scenario: Scenario) -> None:
        """Orbit by SGP4 at the epoch; attitude and rate relative to the orbital frame."""
        days, second = divmod(self._epoch, DAY_S)
        error, r_km, v_kmps = Satrec.twoline2rv(*scenario["orbit"]["tle"]).sgp4(
            UNIX_EPOCH_JD + days, second / DAY_S
        )
        if error:
            raise ValueError(f"SGP4 finds no orbit at the epoch: error {error}")
        r_m, v_mps = 1e3 * np.array(r_km), 1e3 * np.array(v_kmps)
        orbit_from_eci, orbit_rate_radps = orbital_frame(r_m, v_mps)
        initial = scenario["initial"]
        axis, half_rad = np.array(initial["axis"]), radians(initial["angle_deg"]) / 2.0
        turn = np.array([cos(half_rad), *(sin(half_rad) * axis / np.linalg.norm(axis))])
        body_from_orbit = RigidBodyKinematics.EP2C(turn) @ nominal_attitude(scenario["body"])
        omega_body_radps = np.radians(initial["rate_degps"]) + orbit_rate_radps * body_from_orbit[:, 2]
        hub = self._body.hub
        hub.r_CN_NInit, hub.v_CN_NInit = r_m.tolist(), v_mps.tolist()
        sigma = RigidBodyKinematics.C2MRP(body_from_orbit @ orbit_from_eci)
        hub.sigma_BNInit, hub.omega_BN_BInit = [[x] for x in sigma], [[x] for x in omega_body_radps]

    def _surround(self, tick: int, m_body_am2: Array) -> None:
        """Sun, Earth and dipole as Basilisk reads them on its way to ``tick``."""
        unix_s, now_ns = self._epoch + tick * self._tick_s, macros.sec2nano(max(0, tick - 1) * self._tick_s)
        sun = messaging.SpicePlanetStateMsgPayload(
            PositionVector=sun_eci_m(unix_s).tolist(), PlanetName="sun"
        )
        earth = messaging.SpicePlanetStateMsgPayload(
            J20002Pfix=earth_from_eci(unix_s).tolist(), PlanetName="earth"
        )
        dipole = messaging.MTBCmdMsgPayload(mtbDipoleCmds=(m_body_am2 + self._residual_am2).tolist())
        for message, payload in ((self._sun, sun), (self._earth, earth), (self._dipole, dipole)):
            message.write(payload, now_ns)

    def _run(self, tick: int) -> None:
        self._sim.ConfigureStopTime(macros.sec2nano(tick * self._tick_s))
        self._sim.ExecuteSimulation()


def zonal_gravity() -> sphericalHarmonicsGravityModel.SphericalHarmonicsGravityModel:
    """A round Earth with J2, J3 and J4: normalised coefficients -J_n / sqrt(2 n + 1)."""
    model = sphericalHarmonicsGravityModel.SphericalHarmonicsGravityModel()
    model.muBody, model.radEquator, model.maxDeg = MU_M3PS2, EARTH_M, len(ZONAL) + 1
    zonal = [1.0, 0.0, *(-j / sqrt(2 * n + 1) for n, j in enumerate(ZONAL, start=2))]
    model.cBar = [[c, *[0.0] * n] for n, c in enumerate(zonal)]
    model.sBar = [[0.0] * (n + 1) for n in range(len(zonal))]
    return model


def epoch_payload(start: datetime) -> messaging.EpochMsgPayload:
    """A date as Basilisk's message."""
    names = ("year", "month", "day", "hours", "minutes", "seconds")
    return messaging.EpochMsgPayload(**dict(zip(names, start.timetuple(), strict=False)))


def three_axes() -> messaging.MTBArrayConfigMsgPayload:
    """Coils along the axes of the body, each as strong as its board says."""
    return messaging.MTBArrayConfigMsgPayload(
        numMTB=3, GtMatrix_B=np.eye(3).ravel().tolist(), maxMtbDipoles=[1e3] * 3
    )


def inertia(scenario: Scenario) -> Array:
    """The scenario's tensor, or that of its principal moments."""
    given = np.array(scenario["body"]["inertia_kgm2"])
    return given if given.ndim > 1 else np.diag(given)


def orbital_frame(r_m: Array, v_mps: Array) -> tuple[Array, float]:
    """Rows radius, along-track, normal; and its rate |r x v| / r^2 about the third."""
    momentum = np.cross(r_m, v_mps)
    radius, normal = r_m / np.linalg.norm(r_m), momentum / np.linalg.norm(momentum)
    return np.array([radius, np.cross(normal, radius), normal]), float(np.linalg.norm(momentum) / (r_m @ r_m))


def orbit_s(scenario: Scenario) -> float:
    """The period of the mean motion of the elements."""
    return DAY_S / float(scenario["orbit"]["tle"][1][52:63])
