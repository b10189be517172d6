"""The laws that hold the motion to a sliding surface, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.sliding.sliding import SlidingGains, SlidingIntegralGains, sliding, sliding_integral

LAWS: dict[str, LawEntry] = {
    "sliding": LawEntry(60, Aim.THREE_AXIS, sliding, sliding, SlidingGains),
    "sliding_integral": LawEntry(
        61, Aim.THREE_AXIS, sliding_integral, sliding_integral, SlidingIntegralGains
    ),
}
