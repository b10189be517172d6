"""All studies, and the choice among them."""

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from fsw.input.near import did_you_mean
from sim.campaign.claim import Study
from sim.errors import HarnessError
from sim.validate import cells, computed, microsat, optimal_pulses, shipped, worlds
from sim.validate.commissioning import calibrated, wirings
from sim.validate.consat import minimisers, posat1, prediction
from sim.validate.population import claims
from sim.validate.reference import reference
from sim.validate.review import (
    damping,
    driven_wheel,
    feedback_gains,
    feedback_laws,
    one_axis,
    optimal,
    pointing,
    predictive,
    sliding,
    spin,
    wheel,
)

MODULES: tuple[ModuleType, ...] = (
    *(computed, prediction, minimisers, posat1, microsat, shipped, optimal_pulses, cells),
    *(damping, spin, wheel, one_axis, feedback_laws, feedback_gains),
    *(sliding, optimal, predictive, pointing),
    *(driven_wheel, claims, worlds, wirings, calibrated),
)
"""Those that make studies, beside those of the reference files."""
OF_SATELLITES = (optimal_pulses, cells, claims, worlds, calibrated)
"""Those whose studies fly populations."""


def all_studies(satellites: int | None = None) -> list[Study]:
    """All studies. ``satellites``: at most, of each population.

    Raises:
        HarnessError: reference data that ship are missing.
    """
    made = [study for module in MODULES for study in _made_by(module, satellites)]
    return [*reference.shipped_studies(), *made]


def choose_studies(studies: Sequence[Study], only: Sequence[str], quick: bool) -> list[Study]:
    """The studies to run.

    Args:
        studies: all.
        only: first words of the ids of those that are meant; none: all.
        quick: leave out flights.

    Raises:
        HarnessError: a word of ``only`` matches no study, or no study is left.
    """
    for word in only:
        if not any(_begins(study.id, word) for study in studies):
            ids = [study.id for study in studies]
            raise HarnessError(
                f"--only {word}: no such claims{did_you_mean(word, ids)}; there are {', '.join(ids)}"
            )
    meant = [study for study in studies if not only or any(_begins(study.id, word) for word in only)]
    studies_left = [study for study in meant if not (quick and study.has_flights)]
    if not studies_left:
        raise HarnessError("--quick leaves out flights, and --only names nothing else")
    return studies_left


def _made_by(module: ModuleType, satellites: int | None) -> Sequence[Study]:
    studies: Sequence[Study] = module.studies(satellites) if module in OF_SATELLITES else module.studies()
    return studies


def find_repository(start: Path) -> Path | None:
    """The folder at or above ``start`` that holds this project's source; None outside of it."""
    for folder in (start, *start.parents):
        project = folder / "pyproject.toml"
        if project.is_file() and 'name = "torquer"' in project.read_text(encoding="utf-8", errors="replace"):
            return folder
    return None


def _begins(study_id: str, word: str) -> bool:
    return study_id == word or study_id.startswith(f"{word}.")
