"""Small studies: claims whose figures functions give, one a claim."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.validate.review.law_flight import LawFlight


@dataclass(frozen=True, slots=True)
class FigureClaim:
    """A claim whose figure a function gives.

    Attributes:
        name: last words of the id.
        statement, unit, low, high, wide: as ``Claim`` has them.
        source: number in the review's references, and what is said there.
        figure: picklable.
    """

    name: str
    statement: str
    source: str
    unit: str
    low: float
    high: float
    figure: Callable[[], float]
    wide: str = ""

    def study(self, section: str, review: str) -> Study:
        """Its study; ``section`` begins the id after ``review.``, ``review`` the source."""
        claim = Claim(
            f"review.{section}.{self.name}",
            self.statement,
            f"{review}, {self.source}",
            self.unit,
            low=self.low,
            high=self.high,
            wide=self.wide,
        )
        return one_figure(claim, self.figure)


@dataclass(frozen=True, slots=True)
class FlownClaim:
    """A claim on one figure of the flight of a law.

    Attributes:
        name: last part of the id.
        statement, source, unit, low, high, wide: as ``Claim`` has them.
        case: the flight.
        figure: name of the figure.
    """

    name: str
    statement: str
    source: str
    unit: str
    low: float
    high: float
    case: LawFlight
    figure: str
    wide: str = ""

    def study(self, section: str, review: str, figure_of: Callable[[LawFlight, str], float]) -> Study:
        """Its study; ``figure_of`` must be picklable."""
        claim = Claim(
            f"review.{section}.{self.name}",
            self.statement,
            f"{review} {self.source}",
            self.unit,
            low=self.low,
            high=self.high,
            wide=self.wide,
        )
        return one_figure(claim, partial(figure_of, self.case, self.figure))


def one_figure(claim: Claim, figure: Callable[[], float]) -> Study:
    """The study of a claim of the same id; ``figure`` must be picklable."""
    return Study(claim.id, (figure,), lambda found: [claim.judge(found[0])])


def judged(claims: Sequence[Claim], figures: Sequence[float]) -> list[ClaimOutcome]:
    """Each figure by its claim, in order."""
    return [claim.judge(figure) for claim, figure in zip(claims, figures, strict=True)]
