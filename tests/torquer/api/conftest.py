"""Short flights by the functions that programs call, their reports left blank: drawing takes longer."""

import shutil

import pytest
from click.testing import CliRunner

import torquer
from sim.report import conclude
from torquer.cli.main import main

ORBITS = 0.05
"""302 ticks of microsat, two pulses in them."""


@pytest.fixture(autouse=True)
def no_report(monkeypatch):
    monkeypatch.setattr(conclude, "write_report", lambda path, *rest: path.write_text(""))
    monkeypatch.setattr("sim.campaign.report.page.write_page", lambda path, *rest: path.write_text(""))


@pytest.fixture(scope="session")
def flown(tmp_path_factory):
    """A run of microsat, seed 7. For reading only."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(conclude, "write_report", lambda path, *rest: path.write_text(""))
        return torquer.fly("microsat", orbits=ORBITS, seed=7, out=tmp_path_factory.mktemp("api") / "run")


@pytest.fixture
def copy(flown, tmp_path):
    """A copy of it that may be altered."""
    return torquer.load(shutil.copytree(flown.path, tmp_path / "copy"))


@pytest.fixture
def command():
    """Runs ``torquer WORDS...`` in this process."""
    return lambda *words: CliRunner().invoke(main, [*map(str, words)])
