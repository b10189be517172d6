"""All methods by the sections of the review, then those of the other papers and of its introduction.

And the references of the review that none of them names.
"""

import re
from collections.abc import Iterable

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

LAST = 113
"""Number of the last reference of the review [O19]."""

_LIST = re.compile(r"\[(\d[\d,\s-]*)\]")


def numbers(source: str) -> set[int]:
    """The numbers in a source: ``[O19] 1 [18, 20-23]`` has 18 and 20 to 23; one of another paper has none."""
    if "[O19]" not in source:
        return set()
    found: set[int] = set()
    for listed in _LIST.findall(source):
        for part in listed.split(","):
            first, _, last = part.strip().partition("-")
            found |= set(range(int(first), int(last or first) + 1))
    return found


def missing(methods: Iterable[Method]) -> list[int]:
    """The references that no method names, in order."""
    named = set().union(*(numbers(method.source) for method in methods))
    return [number for number in range(1, LAST + 1) if number not in named]
