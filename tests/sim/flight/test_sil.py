"""The nodes of a flight are started from the packages of this process."""

import sys

import pytest

from sim.flight.sil import start_node


@pytest.mark.long
def test_a_package_in_the_current_directory_is_not_that_of_a_node(tmp_path, monkeypatch):
    for name in ("fsw", "sim"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError")
    monkeypatch.setattr(sys, "path", ["", *sys.path])  # as at the prompt of Python
    monkeypatch.chdir(tmp_path)
    for module in ("fsw", "sim.flight.plant_process"):
        node = start_node(module, "--help", stdout=-3)
        assert node.wait(60) == 0
