"""The peer of the benchmarks: a magnetic closed loop in Basilisk, with its own modules or one in Python.

A satellite of 50 kg at 800 km with three continuous coils, pointed at nadir by a PD law from perfect
knowledge in a field of degree 12, with magnetometer, Sun sensors and eclipses, a step a second, all recorded:
no filter, no bus, no quantised pulses. Prints how many times faster than real
time it is, from the first step to the last.

    python basilisk_flight.py IGRF.shc ORBITS [--python]
"""

import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from Basilisk.architecture import messaging, sysModel
from Basilisk.fswAlgorithms import (
    attTrackingError,
    dipoleMapping,
    hillPoint,
    mrpFeedback,
    tamComm,
    torque2Dipole,
)
from Basilisk.simulation import (
    GravityGradientEffector,
    MtbEffector,
    coarseSunSensor,
    eclipse,
    magneticFieldWMM,
    magnetometer,
    simpleNav,
    spacecraft,
)
from Basilisk.utilities import SimulationBaseClass, macros, orbitalMotion, simIncludeGravBody

INERTIA_KGM2 = (1.02, 0.0, 0.0, 0.0, 1.85, 0.0, 0.0, 0.0, 1.95)
DIPOLE_AM2 = 8.0
STIFFNESS_NM, DAMPING_NMS = 1e-5, 6e-3
"""Gains of the PD law on modified Rodrigues parameters and rate."""


SUN_M = [1.496e11, 0.0, 0.0]


def planet(name: str) -> messaging.SpicePlanetStateMsgPayload:
    """A planet at the origin."""
    return messaging.SpicePlanetStateMsgPayload(PlanetName=name, J20002Pfix=np.eye(3).tolist())


class PythonPd(sysModel.SysModel):
    """The same PD law as a module in Python."""

    def __init__(self, guidance: messaging.AttGuidMsg) -> None:
        super().__init__()
        self.ModelTag = "pd"
        self.cmdTorqueOutMsg = messaging.CmdTorqueBodyMsg()
        self._guidance = messaging.AttGuidMsgReader()
        self._guidance.subscribeTo(guidance)

    def UpdateState(self, now_ns: int) -> None:  # noqa: N802  its name in Basilisk
        """Read the error of attitude and rate, and ask for a torque."""
        error = self._guidance()
        torque_nm = -STIFFNESS_NM * np.array(error.sigma_BR) - DAMPING_NMS * np.array(error.omega_BR_B)
        payload = messaging.CmdTorqueBodyMsgPayload(torqueRequestBody=torque_nm.tolist())
        self.cmdTorqueOutMsg.write(payload, now_ns, self.moduleID)


def coefficients(shc: Path) -> str:
    """The field of 2020 and its change, to degree 12, in the format that Basilisk reads."""
    lines = [line.split() for line in shc.read_text().splitlines() if not line.startswith("#")]
    epochs = [float(epoch) for epoch in lines[1]]
    here = epochs.index(2020.0)
    found = {(int(n), int(m)): [float(value) for value in values] for n, m, *values in lines[2:]}
    rows = ["    2020.0            WMM-2020        12/10/2019"]
    for n in range(1, 13):
        for m in range(n + 1):
            pair = [
                found[n, order][here : here + 2] if (n, order) in found else [0.0, 0.0] for order in (m, -m)
            ]
            if m == 0:
                pair[1] = [0.0, 0.0]
            (g, g_next), (h, h_next) = pair
            rows.append(f"{n:3d}{m:3d} {g:9.1f} {h:9.1f} {(g_next - g) / 5:10.1f} {(h_next - h) / 5:10.1f}")
    return "\n".join([*rows, "9" * 48, "9" * 48, ""])


def simulation(
    cof: Path, in_python: bool
) -> tuple[SimulationBaseClass.SimBaseClass, attTrackingError.attTrackingError, list[object]]:
    """The simulation, the module of the attitude error, and what has to live as long as they."""
    sim = SimulationBaseClass.SimBaseClass()
    process = sim.CreateNewProcess("process")
    process.addTask(sim.CreateNewTask("task", macros.sec2nano(1.0)))
    body = spacecraft.Spacecraft()
    body.hub.mHub = 50.0
    body.hub.r_BcB_B = [[0.0], [0.0], [0.0]]
    body.hub.IHubPntBc_B = np.reshape(INERTIA_KGM2, (3, 3)).tolist()
    gravity = simIncludeGravBody.gravBodyFactory()
    earth = gravity.createEarth()
    earth.isCentralBody = True
    gravity.addBodiesTo(body)
    orbit = orbitalMotion.ClassicElements()
    orbit.a, orbit.e, orbit.i = 7178e3, 0.001, np.radians(98.4)
    orbit.Omega, orbit.omega, orbit.f = 0.5, 0.3, 0.1
    r_m, v_mps = orbitalMotion.elem2rv(earth.mu, orbit)
    body.hub.r_CN_NInit, body.hub.v_CN_NInit = r_m, v_mps
    body.hub.sigma_BNInit = [[0.1], [0.2], [-0.3]]
    body.hub.omega_BN_BInit = [[0.001], [-0.0005], [0.0007]]
    field = magneticFieldWMM.MagneticFieldWMM()
    field.configureWMMFile(str(cof))
    epoch = messaging.EpochMsg().write(
        messaging.EpochMsgPayload(year=2020, month=3, day=28, hours=3, minutes=30, seconds=17.0)
    )
    field.epochInMsg.subscribeTo(epoch)
    field.addSpacecraftToModel(body.scStateOutMsg)
    gradient = GravityGradientEffector.GravityGradientEffector()
    gradient.addPlanetName(earth.planetName)
    body.addDynamicEffector(gradient)
    sensor = magnetometer.Magnetometer()
    sensor.senNoiseStd = [200e-9] * 3
    sensor.scaleFactor = 1.0
    sensor.stateInMsg.subscribeTo(body.scStateOutMsg)
    sensor.magInMsg.subscribeTo(field.envOutMsgs[0])
    navigation = simpleNav.SimpleNav()
    navigation.scStateInMsg.subscribeTo(body.scStateOutMsg)
    nadir = hillPoint.hillPoint()
    nadir.transNavInMsg.subscribeTo(navigation.transOutMsg)
    error = attTrackingError.attTrackingError()
    error.attNavInMsg.subscribeTo(navigation.attOutMsg)
    error.attRefInMsg.subscribeTo(nadir.attRefOutMsg)
    measured = tamComm.tamComm()
    measured.dcm_BS = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    measured.tamInMsg.subscribeTo(sensor.tamDataOutMsg)
    no_feedforward = messaging.VehicleConfigMsgPayload(ISCPntB_B=[0.0] * 9)
    vehicle = messaging.VehicleConfigMsg().write(no_feedforward)
    if in_python:
        law = PythonPd(error.attGuidOutMsg)
    else:
        law = mrpFeedback.mrpFeedback()
        law.K, law.P, law.Ki, law.integralLimit = STIFFNESS_NM, DAMPING_NMS, -1.0, 0.0
        law.guidInMsg.subscribeTo(error.attGuidOutMsg)
        law.vehConfigInMsg.subscribeTo(vehicle)
    dipole = torque2Dipole.torque2Dipole()
    dipole.tauRequestInMsg.subscribeTo(law.cmdTorqueOutMsg)
    dipole.tamSensorBodyInMsg.subscribeTo(measured.tamOutMsg)
    coils = messaging.MTBArrayConfigMsgPayload(
        numMTB=3, GtMatrix_B=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], maxMtbDipoles=[DIPOLE_AM2] * 3
    )
    configuration = messaging.MTBArrayConfigMsg().write(coils)
    mapping = dipoleMapping.dipoleMapping()
    mapping.steeringMatrix = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    mapping.dipoleRequestBodyInMsg.subscribeTo(dipole.dipoleRequestOutMsg)
    mapping.mtbArrayConfigParamsInMsg.subscribeTo(configuration)
    effector = MtbEffector.MtbEffector()
    effector.mtbCmdInMsg.subscribeTo(mapping.dipoleRequestMtbOutMsg)
    effector.mtbParamsInMsg.subscribeTo(configuration)
    effector.magInMsg.subscribeTo(field.envOutMsgs[0])
    body.addDynamicEffector(effector)
    sun = messaging.SpicePlanetStateMsg().write(messaging.SpicePlanetStateMsgPayload(PositionVector=SUN_M))
    shadow = eclipse.Eclipse()
    shadow.sunInMsg.subscribeTo(sun)
    shadow.addPlanetToModel(earth_state := messaging.SpicePlanetStateMsg().write(planet("earth")))
    shadow.addSpacecraftToModel(body.scStateOutMsg)
    facets = []
    for normal in np.vstack((np.eye(3), -np.eye(3))):
        facet = coarseSunSensor.CoarseSunSensor()
        facet.fov, facet.senNoiseStd, facet.nHat_B = np.radians(90.0), 0.01, normal
        facet.sunInMsg.subscribeTo(sun)
        facet.stateInMsg.subscribeTo(body.scStateOutMsg)
        facet.sunEclipseInMsg.subscribeTo(shadow.eclipseOutMsgs[0])
        facets.append(facet)
    flight = (field, sensor, shadow, *facets, navigation, nadir, error, measured, law, dipole, mapping)
    histories = [
        message.recorder()
        for message in (
            body.scStateOutMsg,
            field.envOutMsgs[0],
            shadow.eclipseOutMsgs[0],
            mapping.dipoleRequestMtbOutMsg,
            error.attGuidOutMsg,
        )
    ]
    for module in (body, gradient, effector, *flight, *histories):
        sim.AddModelToTask("task", module)
    return (
        sim,
        error,
        [
            body,
            gradient,
            effector,
            *flight,
            *histories,
            gravity,
            epoch,
            vehicle,
            configuration,
            sun,
            earth_state,
        ],
    )


def main(shc: Path, orbits: float, in_python: bool) -> None:
    """Fly, and print the speed."""
    seconds = round(orbits * 6042.0)
    with TemporaryDirectory() as folder:
        cof = Path(folder, "field.COF")
        cof.write_text(coefficients(shc))
        sim, error, _kept = simulation(cof, in_python)
        sim.InitializeSimulation()
    sim.ConfigureStopTime(macros.sec2nano(float(seconds)))
    begin_s = time.perf_counter()
    sim.ExecuteSimulation()
    print(seconds / (time.perf_counter() - begin_s))
    turn = error.attGuidOutMsg.read().sigma_BR
    print(
        f"{np.degrees(4.0 * np.arctan(np.linalg.norm(turn))):.2f} deg off nadir at the end", file=sys.stderr
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]), "--python" in sys.argv)
