"""All methods, in the order of the review; then those of the other papers and of its introduction."""

from sim.methods.damping import METHODS as DAMPING
from sim.methods.feedback import METHODS as FEEDBACK
from sim.methods.method import Method
from sim.methods.one_axis import METHODS as ONE_AXIS
from sim.methods.optimal import METHODS as OPTIMAL
from sim.methods.papers import METHODS as PAPERS
from sim.methods.predictive import METHODS as PREDICTIVE
from sim.methods.sliding import METHODS as SLIDING
from sim.methods.spin import METHODS as SPIN
from sim.methods.wheel import METHODS as WHEEL

METHODS: tuple[Method, ...] = (
    *DAMPING,
    *SPIN,
    *WHEEL,
    *ONE_AXIS,
    *FEEDBACK,
    *SLIDING,
    *OPTIMAL,
    *PREDICTIVE,
    *PAPERS,
)
