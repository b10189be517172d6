"""The laws that point one axis, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.one_axis.direction_tracking import direction_tracking
from fsw.core.laws.one_axis.field_tracking import (
    HandOverGains,
    field_tracking,
    pd_after_tracking,
    tracking_before_pd,
)
from fsw.core.laws.one_axis.pd_when_slow import SlowGains, slow_far, slow_near
from fsw.core.laws.one_axis.slow_spin import slow_spin
from fsw.core.laws.one_axis.sun_critical import CriticalGains, sun_critical
from fsw.core.laws.one_axis.sun_panels import PanelGains, sun_panels
from fsw.core.laws.one_axis.sun_pointing import sun_pointing
from fsw.core.laws.spin.spin import SpinGains

LAWS: dict[str, LawEntry] = {
    "field_tracking": LawEntry(21, Aim.THREE_AXIS, field_tracking, field_tracking),
    "field_tracking_pd": LawEntry(22, Aim.THREE_AXIS, tracking_before_pd, pd_after_tracking, HandOverGains),
    "sun_pointing": LawEntry(30, Aim.SUN, sun_pointing, sun_pointing),
    "pd_when_slow": LawEntry(31, Aim.THREE_AXIS, slow_far, slow_near, SlowGains),
    "slow_spin": LawEntry(32, Aim.SPIN, slow_spin, slow_spin, SpinGains),
    "sun_panels": LawEntry(33, Aim.SUN, sun_panels, sun_panels, PanelGains),
    "sun_critical": LawEntry(34, Aim.SUN, sun_critical, sun_critical, CriticalGains),
    "direction_tracking": LawEntry(35, Aim.THREE_AXIS, direction_tracking, direction_tracking),
}
