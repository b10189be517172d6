"""The methods of the source papers, methods.toml: where each is, what is claimed for it, and docs/methods.md.

The page has a row a method: what is not measured is called so, and the references of the review that no
method names are listed.
"""

import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

TABLE = Path(__file__).with_suffix(".toml")
LAST = 113
"""Number of the last reference of the review [O19]."""
_LIST = re.compile(r"\[(\d[\d,\s-]*)\]")
Figures = Mapping[str, Mapping[str, str]]
"""By claim its ``figure``, ``limits`` and ``verdict``."""

_HEAD = """# The methods of the papers

Written by `tools/write_pages.py` from `sim/methods.toml`; do not edit. Every method of the review [O19]
(Ovchinnikov, Roldugin 2019), of the paper on the choice of gains [O15] (Ovchinnikov, Roldugin, Ivanov,
Penkov 2015) and of the one on PoSAT-1 [T] (Tavares et al., ConSat): section and number in the review's list
of references, where it is, what the text or its cited author claims, and what `torquer validate` has last
measured of it.
[laws.md](laws.md) has the equations of the laws, [validation.md](validation.md) the claims.

*flown*: a law of the flight software, or an effect of the plant. *ground*: computed on the ground. *passed
over*: not built, for the reason given. *holds*: every figure is within its limits, and one at least was not
fitted. *fitted*: a number of the scenario was chosen so that the figure is met, which shows nothing. *not
measured*: no figure has been written yet.
"""
FITTED = "fitted"
_COLUMNS = ("method", "source", "kind", "claim", "measured", "verdict", "where")


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
    claim: str
    where: str = ""
    claims: tuple[str, ...] = ()
    remark: str = ""


def read_methods() -> tuple[Method, ...]:
    """All methods by the sections of the review, then those of the other papers and of its introduction."""
    rows = tomllib.loads(TABLE.read_text(encoding="utf-8"))["method"]
    return tuple(
        Method(**{**row, "kind": Kind(row["kind"]), "claims": tuple(row.get("claims", ()))}) for row in rows
    )


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


def page(methods: Sequence[Method], figures: Figures) -> str:
    """The page."""
    left = missing(methods)
    absent = ", ".join(map(str, left)) if left else "none"
    lines = [
        _HEAD,
        f"{len(methods)} methods: {_counted(methods)}. Verdicts: {_judged(methods, figures)}.",
        "",
        f"References of the review that no method names: {absent}.",
        "",
        _row(_COLUMNS),
        "|---" * len(_COLUMNS) + "|",
        *(_row(_cells(method, figures)) for method in methods),
        "",
    ]
    return "\n".join(lines)


def verdict(method: Method, figures: Figures) -> str:
    """Of a method: what its figures say together."""
    if method.kind is Kind.PASSED_OVER:
        return Kind.PASSED_OVER.value
    found = [figures[claim]["verdict"] for claim in method.claims if claim in figures]
    if not found:
        return "not measured"
    if "FAIL" in found:
        return "fails"
    if all(one == FITTED for one in found):
        return FITTED
    return "holds" if len(found) == len(method.claims) else "holds, in part not measured"


def _cells(method: Method, figures: Figures) -> tuple[str, ...]:
    where = ", ".join(f"`{place}`" for place in method.where.split(", ")) if method.where else "-"
    said = f"{method.claim} {method.remark}".strip()
    measured = "; ".join(_measured(claim, figures) for claim in method.claims) or "-"
    return (
        method.name,
        method.source,
        method.kind.value,
        said,
        measured,
        verdict(method, figures),
        where,
    )


def _measured(claim: str, figures: Figures) -> str:
    if claim not in figures:
        return f"not measured (`{claim}`)"
    row = figures[claim]
    fitted = f", {FITTED}" if row["verdict"] == FITTED else ""
    return f"{row['figure']}, {row['limits']}{fitted} (`{claim}`)"


def _counted(methods: Sequence[Method]) -> str:
    count = Counter(method.kind for method in methods)
    return ", ".join(f"{count[kind]} {kind.value}" for kind in Kind)


def _judged(methods: Sequence[Method], figures: Figures) -> str:
    count = Counter(verdict(method, figures) for method in methods)
    return ", ".join(f"{number} {name}" for name, number in sorted(count.items()))


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
