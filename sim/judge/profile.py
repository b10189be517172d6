"""What a flight software says that it gives; the rest is judged by the plant's truth, or is not asked."""

from enum import StrEnum

from sim.scenario.requirements import RequirementSection
from sim.scenario.schema import Scenario


class Profile(StrEnum):
    """What a flight software gives beside FSW_BOOT and TICK_DONE."""

    ACTUATOR = "actuator"
    """Requests to drive coils."""
    DETUMBLE = "detumble"
    """Requests that brake the body; it need not point."""
    ATTITUDE = "attitude"
    """Its estimate as well, in every tick: NAV_ATTITUDE and NAV_RATE."""


OF_KNOWLEDGE = frozenset(("ake",))
OF_POINTING = frozenset(("ape", "mpe", "rpe", "settling"))


def not_asked(requirement: RequirementSection, profile: Profile) -> str:
    """Why a requirement of the scenario is not asked of a profile, a clause; empty where it is."""
    if requirement.index in OF_KNOWLEDGE and profile is not Profile.ATTITUDE:
        return f"the profile {profile.value} gives no estimate"
    if requirement.index in OF_POINTING and profile is Profile.DETUMBLE:
        return "the profile detumble does not point"
    return ""


def asked_of(scenario: Scenario, profile: Profile) -> Scenario:
    """The scenario with those of its requirements that are asked of a profile."""
    kept = tuple(one for one in scenario.requirement if not not_asked(one, profile))
    return scenario.model_copy(update={"requirement": kept})
