"""The code that judges flights: what a module of studies imports, whatever its comments."""

from types import ModuleType

import pytest

from sim.errors import HarnessError
from sim.validate.registry import MODULES, all_studies, judging_digests
from sim.validate.running import judging_code
from sim.validate.running.judging_code import judging_digest, judging_files

FILES = {
    "claims.py": '"""Claims."""\nfrom sim.validate.figures import worst\n',
    "figures.py": "import sim.validate.units\n\ndef worst(x): return max(x)\n",
    "units.py": "from sim.validate import claims\nDEG = 57.3\n",
    "other.py": "LIMIT = 1.0\n",
}


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project whose claims import figures, and those units, which import the claims again."""
    folder = tmp_path / "sim" / "validate"
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("")
    for name, text in FILES.items():
        (folder / name).write_text(text)
    whole = judging_code.code_digest.__wrapped__
    monkeypatch.setattr(judging_code, "PROJECT", tmp_path)
    monkeypatch.setattr(judging_code, "code_digest", lambda files: whole(files, tmp_path))
    return folder


@pytest.fixture
def digest(project):
    """The digest of the claims, computed anew."""

    def computed():
        judging_digest.cache_clear()
        return judging_digest("sim.validate.claims")

    yield computed
    judging_digest.cache_clear()


def test_what_is_imported_counts_by_whatever_way_and_what_is_not_does_not(project):
    assert judging_files("sim.validate.claims") == tuple(
        f"sim/validate/{name}" for name in ("__init__.py", "claims.py", "figures.py", "units.py")
    )


@pytest.mark.parametrize("name", ["claims.py", "figures.py", "units.py"])
def test_a_change_of_any_of_them_is_another_digest(project, digest, name):
    before = digest()
    (project / name).write_text(FILES[name] + "LIMIT = 2.0\n")
    assert digest() != before


def test_a_comment_or_another_module_is_none(project, digest):
    before = digest()
    (project / "figures.py").write_text("# in degrees\n" + FILES["figures.py"])
    (project / "other.py").write_text("LIMIT = 2.0\n")
    assert digest() == before


@pytest.mark.parametrize("module", ["sim.campaign.study", "sim.validate.none", "numpy"])
def test_a_module_whose_changes_would_go_unnoticed_is_refused(module):
    with pytest.raises(HarnessError, match=f"{module}: a module that judges is one of sim/commissioning, "):
        judging_digest(module)


def test_every_study_with_flights_has_one_and_no_other_has():
    flown = {study.id for study in all_studies() if study.has_flights}
    assert judging_digests().keys() == flown
    assert len(flown) > 20
    assert all(isinstance(module, ModuleType) for module in MODULES)


def test_flight_code_is_not_counted_twice():
    files = judging_files("sim.validate.review.feedback_gains")
    assert "sim/design/minimax_gains.py" in files
    assert not [file for file in files if file.startswith(("sim/plant", "sim/campaign", "sim/design/theory"))]
