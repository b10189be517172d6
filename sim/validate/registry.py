"""All studies, and the choice among them."""

from collections.abc import Sequence
from pathlib import Path

from fsw.input.near import did_you_mean
from sim.campaign.claim import Study
from sim.errors import HarnessError
from sim.validate import cells, computed, microsat, optimal_pulses, shipped
from sim.validate.commissioning import calibrated, wirings
from sim.validate.consat import minimisers, posat1, prediction
from sim.validate.population import claims
from sim.validate.reference import reference
from sim.validate.review import (
    damping,
    driven_wheel,
    feedback,
    one_axis,
    optimal,
    predictive,
    sliding,
    spin,
    wheel,
)
from sim.validate.review.rigid import fixed_wheel, pointing


def all_studies(satellites: int | None = None) -> list[Study]:
    """All studies. ``satellites``: at most, of each population.

    Raises:
        HarnessError: reference data that ship are missing.
    """
    return [
        *reference.shipped_studies(),
        *computed.studies(),
        *prediction.studies(),
        *minimisers.studies(),
        *posat1.studies(),
        *microsat.studies(),
        *shipped.studies(),
        *optimal_pulses.studies(satellites),
        *cells.studies(satellites),
        *(
            study
            for section in (
                *(damping, spin, wheel, one_axis, feedback, sliding, optimal, predictive),
                *(fixed_wheel, pointing),
            )
            for study in section.studies()
        ),
        *driven_wheel.studies(),
        *claims.studies(satellites),
        *wirings.studies(),
        *calibrated.studies(satellites),
    ]


def choose_studies(studies: Sequence[Study], only: Sequence[str], quick: bool) -> list[Study]:
    """The studies whose ids begin with one of ``only`` (all, if it is empty); ``quick`` leaves out flights.

    Raises:
        HarnessError: a word of ``only`` matches no study, or no study is left.
    """
    for word in only:
        if not any(_begins(study.id, word) for study in studies):
            ids = [study.id for study in studies]
            raise HarnessError(
                f"--only {word}: no such claims{did_you_mean(word, ids)}; there are {', '.join(ids)}"
            )
    studies_left = [study for study in studies if not only or any(_begins(study.id, word) for word in only)]
    studies_left = [study for study in studies_left if not (quick and study.has_flights)]
    if not studies_left:
        raise HarnessError("--quick leaves out flights, and --only names nothing else")
    return studies_left


def find_repository(start: Path) -> Path | None:
    """The folder at or above ``start`` that holds this project's source; None outside of it."""
    for folder in (start, *start.parents):
        project = folder / "pyproject.toml"
        if project.is_file() and 'name = "torquer"' in project.read_text(encoding="utf-8", errors="replace"):
            return folder
    return None


def _begins(study_id: str, word: str) -> bool:
    return study_id == word or study_id.startswith(f"{word}.")
