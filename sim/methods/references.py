"""The numbers of the review's list of references that the methods' sources name."""

import re
from collections.abc import Iterable

from sim.methods.method import Method

LAST = 113
"""The review [O19] has so many references."""

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
