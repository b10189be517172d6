"""The laws that hold the motion to a sliding surface, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.sliding.rate_surface import RateSurfaceGains, sliding_rate, sliding_rate_modified
from fsw.core.laws.sliding.realisable import RealisableGains, sliding_realisable
from fsw.core.laws.sliding.sliding import SlidingGains, SlidingIntegralGains, sliding, sliding_integral
from fsw.core.laws.sliding.sphere import SphereSlidingGains, sliding_sphere
from fsw.core.laws.sliding.super_twisting import SuperTwistingGains, sliding_twisting

LAWS: dict[str, LawEntry] = {
    "sliding": LawEntry(60, Aim.THREE_AXIS, sliding, sliding, SlidingGains),
    "sliding_integral": LawEntry(
        61, Aim.THREE_AXIS, sliding_integral, sliding_integral, SlidingIntegralGains
    ),
    "sliding_realisable": LawEntry(
        62, Aim.THREE_AXIS, sliding_realisable, sliding_realisable, RealisableGains
    ),
    "sliding_rate": LawEntry(63, Aim.THREE_AXIS, sliding_rate, sliding_rate, RateSurfaceGains),
    "sliding_rate_modified": LawEntry(
        64, Aim.THREE_AXIS, sliding_rate_modified, sliding_rate_modified, RateSurfaceGains
    ),
    "sliding_twisting": LawEntry(65, Aim.THREE_AXIS, sliding_twisting, sliding_twisting, SuperTwistingGains),
    "sliding_sphere": LawEntry(66, Aim.THREE_AXIS, sliding_sphere, sliding_sphere, SphereSlidingGains),
}
