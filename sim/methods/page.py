"""docs/seeds.md: all methods of the three papers, with what is claimed of them and what is measured."""

from collections import Counter
from collections.abc import Mapping, Sequence

from sim.methods.method import Kind, Method
from sim.methods.table import missing

Figures = Mapping[str, Mapping[str, str]]
"""By claim its ``figure``, ``limits`` and ``verdict``."""

_HEAD = """# The methods of the papers

Written by `tools/write_seeds.py` from `sim/methods`; do not edit. Every method of the review [O19]
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
