"""The laws that build up a spin and turn its axis, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.spin.relay_stages import StageGains, relay_stages
from fsw.core.laws.spin.roll_precession import RollGains, roll_precession
from fsw.core.laws.spin.spin import SpinGains, nutation, spin_up, y_thomson
from fsw.core.laws.spin.spin_axis import (
    SpinAxisGains,
    TargetGains,
    ThreeTermGains,
    reorientation,
    spin_relay,
    three_term,
)
from fsw.core.laws.spin.stepped_precession import StepGains, stepped_precession
from fsw.core.laws.spin.target_precession import PrecessionGains, target_precession

LAWS: dict[str, LawEntry] = {
    "nutation": LawEntry(11, Aim.SPIN, nutation, nutation, SpinGains),
    "spin_up": LawEntry(12, Aim.SPIN, spin_up, spin_up, SpinGains),
    "y_thomson": LawEntry(13, Aim.SPIN, y_thomson, y_thomson, SpinGains),
    "spin_relay": LawEntry(14, Aim.SPIN, spin_relay, spin_relay, TargetGains),
    "reorientation": LawEntry(15, Aim.SPIN, reorientation, reorientation, SpinAxisGains),
    "three_term": LawEntry(16, Aim.SPIN, three_term, three_term, ThreeTermGains),
    "roll_precession": LawEntry(17, Aim.SPIN, roll_precession, roll_precession, RollGains),
    "target_precession": LawEntry(18, Aim.SPIN, target_precession, target_precession, PrecessionGains),
    "relay_stages": LawEntry(19, Aim.SPIN, relay_stages, relay_stages, StageGains),
    "stepped_precession": LawEntry(100, Aim.SPIN, stepped_precession, stepped_precession, StepGains),
}
