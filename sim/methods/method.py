"""A method of the source papers, as the table of methods lists it."""

from dataclasses import dataclass
from enum import StrEnum


class Kind(StrEnum):
    """What has become of a method."""

    FLOWN = "flown"
    """A law of the flight software, or an effect of the plant."""
    GROUND = "ground"
    """Computed on the ground: gains, a bound, or a study."""
    PASSED_OVER = "passed over"
    """Not built: its equation was not found, or it is no method of control."""


@dataclass(frozen=True, slots=True)
class Method:
    """One row.

    Attributes:
        name: what it is, in a few words, with its laws in parentheses.
        source: paper, section, equation, and the number in its references, as ``[O19] 2.1 eq. 4 [37]``.
        kind: what has become of it.
        where: the module, from the top of the project, or several with commas between; empty where it was
            passed over.
        claim: what the text, or its cited author, says of it, in a sentence.
        claims: ids of the rows of ``torquer validate`` that measure it.
        remark: what is found, where that is not the claim; why and after what search it was passed over.
    """

    name: str
    source: str
    kind: Kind
    where: str
    claim: str
    claims: tuple[str, ...] = ()
    remark: str = ""
