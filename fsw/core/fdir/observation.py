"""What one tick shows of the satellite, between the measurements and the judgement of them."""

from typing import final

from fsw.core.estimation.attitude import Attitude
from fsw.core.estimation.estimator import NONE_USED, EstimatorState, Used
from fsw.core.fdir.sensors.plausibility import Findings
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.ephemeris import Reference


@final
class Observation:
    """What one tick shows of the satellite.

    ``measurements`` say what may be trusted; ``reference`` is what the models expect, None without an
    orbit; ``estimator`` and ``attitude`` are those of this tick before they are judged; ``used`` is what the
    filter took.
    """

    __slots__ = ("attitude", "estimator", "findings", "measurements", "reference", "used")

    def __init__(
        self,
        measurements: Measurements,
        reference: Reference | None,
        estimator: EstimatorState,
        attitude: Attitude,
        used: Used = NONE_USED,
        findings: Findings | None = None,
    ) -> None:
        self.measurements = measurements
        self.reference = reference
        self.estimator = estimator
        self.attitude = attitude
        self.used = used
        self.findings = findings
