"""What is shown while a function runs: a line in a notebook where it is asked for, else nothing."""

import sys
from types import SimpleNamespace

import pytest

import sim.progress
import torquer

pytestmark = pytest.mark.long

CALLS = {
    "fly": lambda run, out, **shown: torquer.fly("microsat", orbits=0.01, out=out, **shown),
    "report": lambda run, out, **shown: torquer.report(run, **shown),
    "replay": lambda run, out, **shown: torquer.replay(run, **shown),
    "compare": lambda run, out, **shown: torquer.compare(
        "microsat", laws="pd", driver="pulsed", orbits=0.01, workers=1, out=out, **shown
    ),
    "campaign": lambda run, out, **shown: torquer.campaign(
        "microsat", runs=1, orbits=0.01, workers=1, out=out, **shown
    ),
    "export": lambda run, out, **shown: torquer.export(run, out.with_suffix(".csv"), **shown),
    "validate": lambda run, out, **shown: torquer.validate(only=["reference.eclipse"], workers=1, **shown),
}


@pytest.fixture
def notebook(monkeypatch):
    """As in the kernel of a notebook."""
    kernel = SimpleNamespace(IPKernelApp=SimpleNamespace(initialized=lambda: True))
    monkeypatch.setitem(sys.modules, "ipykernel.kernelapp", kernel)
    monkeypatch.setattr(sim.progress, "LINE_EVERY_S", 0.0)


@pytest.mark.parametrize("name", CALLS)
def test_a_notebook_has_a_line_where_it_is_asked_for(name, notebook, copy, tmp_path, capfd):
    CALLS[name](copy, tmp_path / "out", progress=True)
    out, err = capfd.readouterr()
    assert out == ""
    assert "%" in err
    assert err.endswith(": done \n")


@pytest.mark.parametrize("name", CALLS)
def test_nothing_is_printed_where_it_is_not(name, copy, tmp_path, capfd):
    CALLS[name](copy, tmp_path / "out")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", CALLS)
def test_without_a_terminal_a_short_call_has_no_bar(name, copy, tmp_path, capfd):
    CALLS[name](copy, tmp_path / "out", progress=True)
    out, err = capfd.readouterr()
    assert out == ""
    assert "%" not in err
