"""Which studies run, and where the repository is."""

from dataclasses import replace

import pytest

from sim.campaign.flight import fly_order
from sim.campaign.study import FlightStudy
from sim.campaign.study_cache import task_digest
from sim.errors import HarnessError
from sim.validate.registry import all_studies, choose_studies, find_repository


class TestChoice:
    @pytest.fixture
    def ids(self, study):
        """The ids of the chosen studies, of three."""
        studies = (
            study("reference.igrf14", []),
            study("reference.tle", []),
            study("posat1", [], has_flights=True),
        )
        return lambda *only, quick=False: [one.id for one in choose_studies(studies, only, quick)]

    def test_all_by_default_and_first_words_by_only(self, ids):
        assert ids() == ["reference.igrf14", "reference.tle", "posat1"]
        assert ids("reference") == ["reference.igrf14", "reference.tle"]
        assert ids("reference.tle", "posat1") == ["reference.tle", "posat1"]

    def test_quick_leaves_out_flights(self, ids):
        assert ids(quick=True) == ["reference.igrf14", "reference.tle"]
        with pytest.raises(HarnessError, match="--quick"):
            ids("posat1", quick=True)

    @pytest.mark.parametrize(
        ("word", "hint"),
        [
            ("refer", r" \(did you mean 'reference\.igrf14' or 'reference\.tle'\?\)"),
            ("posat", r" \(did you mean 'posat1'\?\)"),
            ("nothing", ""),
            ("", ""),
        ],
    )
    def test_words_that_fit_nothing_are_refused(self, word, hint, ids):
        with pytest.raises(HarnessError, match=rf"no such claims{hint}; there are reference\.igrf14, "):
            ids(word)

    def test_every_format_of_reference_data_ships(self):
        reference = [s for s in all_studies() if s.id.startswith("reference.")]
        assert len(reference) == 11
        assert all(s.tasks for s in reference)

    def test_ids_are_unique_and_begin_with_their_study(self):
        studies = all_studies()
        assert len({s.id for s in studies}) == len(studies) > 10


def test_every_task_with_flights_is_known_again():
    tasks = [task for study in all_studies() if study.has_flights for task in study.tasks]
    digests = [task_digest(task) for task in tasks]
    assert [task for task, digest in zip(tasks, digests, strict=True) if digest is None] == []
    assert len(set(digests)) == len({repr(task) for task in tasks}) > 500


FLOWN = {study.id: study for study in all_studies() if isinstance(study, FlightStudy)}


@pytest.mark.parametrize("study_id", FLOWN)
def test_a_flight_gives_every_figure_that_its_claims_take(study_id):
    """Two minutes of the first order; what it is worth does not matter here."""
    study = FLOWN[study_id]
    flight = fly_order(replace(study.orders[0], orbits=0.02))
    assert study.figures
    for figure in study.figures:
        assert isinstance(figure.pick(flight), float), figure.id


def test_the_repository_is_found_from_within(tmp_path, pytestconfig):
    assert find_repository(pytestconfig.rootpath / "sim" / "plant") == pytestconfig.rootpath
    (tmp_path / "pyproject.toml").write_text('name = "another"\n')
    assert find_repository(tmp_path) is None
