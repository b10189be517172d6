"""What one tick shows of both sensors together."""

from typing import final

from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.sensors.plausibility import Findings


@final
class Observed:
    """What one tick shows of both: the samples, what the filter took, and what it refused of those in use.

    ``isolated``: one of them is, ``inconclusive``: and no estimate is certain enough to show whether it is
    still faulty; ``in_favour``: what estimates have shown in its favour so far, nats. ``credible``: the
    estimate, if there is one, is.
    """

    __slots__ = (
        "credible",
        "estimate",
        "findings",
        "in_favour",
        "inconclusive",
        "isolated",
        "refused_field",
        "refused_sun",
        "used",
    )

    def __init__(
        self,
        findings: Findings,
        used: Used,
        estimate: Estimate | None,
        refused_field: bool,
        refused_sun: bool,
        isolated: bool,
        inconclusive: bool,
        in_favour: float,
        credible: bool,
    ) -> None:
        self.findings = findings
        self.used = used
        self.estimate = estimate
        self.refused_field = refused_field
        self.refused_sun = refused_sun
        self.isolated = isolated
        self.inconclusive = inconclusive
        self.in_favour = in_favour
        self.credible = credible

    @property
    def refused(self) -> bool:
        """Whether the filter refused any."""
        return self.refused_field or self.refused_sun


def is_new(estimate: Estimate | None, used: Used) -> bool:
    """Whether the estimate began with the samples of this tick: they are taken, not compared."""
    return estimate is not None and used.sun and estimate.numbers == 0
