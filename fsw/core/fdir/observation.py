"""What one tick shows of the satellite, between the measurements and the judgement of them."""

from typing import NamedTuple

from fsw.core.estimation.attitude import Attitude
from fsw.core.estimation.estimator import NONE_USED, EstimatorState, Used
from fsw.core.fdir.sensors.plausibility import Findings
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.ephemeris import Reference


class Observation(NamedTuple):
    """What one tick shows of the satellite.

    ``measurements`` say what may be trusted; ``reference`` is what the models expect, None without an
    orbit; ``estimator`` and ``attitude`` are those of this tick before they are judged; ``used`` is what the
    filter took.
    """

    measurements: Measurements
    reference: Reference | None
    estimator: EstimatorState
    attitude: Attitude
    used: Used = NONE_USED
    findings: Findings | None = None
