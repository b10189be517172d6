"""The laws that point one axis, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.one_axis.field_tracking import (
    HandOverGains,
    field_tracking,
    pd_after_tracking,
    tracking_before_pd,
)
from fsw.core.laws.one_axis.sun_pointing import sun_pointing

LAWS: dict[str, LawEntry] = {
    "field_tracking": LawEntry(21, Aim.THREE_AXIS, field_tracking, field_tracking),
    "field_tracking_pd": LawEntry(22, Aim.THREE_AXIS, tracking_before_pd, pd_after_tracking, HandOverGains),
    "sun_pointing": LawEntry(30, Aim.SUN, sun_pointing, sun_pointing),
}
