"""A run in which pulses flow and an estimate converges, and the files that it is exported to."""

import gzip
import shutil
from pathlib import Path
from typing import NamedTuple

import pytest

from sim.export import command
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.pace import LOCKSTEP
from sim.record.truth import read_truth
from sim.scenario.schema import load, parse_settings

TICKS = 400
SEED = 5


class Flight(NamedTuple):
    """A run, and what is in it."""

    folder: Path
    entries: list
    truth: dict


@pytest.fixture(scope="session")
def flight(tmp_path_factory):
    """A flight of 400 ticks; for reading only."""
    folder = tmp_path_factory.mktemp("export") / "run"
    scenario = load("microsat", parse_settings(("coils.backoff_s=20",)))
    run_dir.begin(folder, scenario, SEED, TICKS, "virtual", LOCKSTEP)
    fly_virtual(folder, scenario, lambda tick: None)
    return Flight(folder, list(read_log(folder / "bus.log")), read_truth(folder / "truth.h5"))


@pytest.fixture(scope="session")
def exported(flight, tmp_path_factory):
    """The file of a format, written once."""
    files = {}

    def file_of(suffix):
        if suffix not in files:
            files[suffix] = tmp_path_factory.mktemp("out") / f"run.{suffix}"
            assert command.export(flight.folder, None, files[suffix], force=False).ok
        return files[suffix]

    return file_of


@pytest.fixture
def cut(flight, tmp_path):
    """A copy of the run, its log compressed and cut inside a line."""
    folder = shutil.copytree(flight.folder, tmp_path / "cut")
    text = (folder / "bus.log").read_bytes()
    (folder / "bus.log").unlink()
    with gzip.open(folder / "bus.log.gz", "wb") as file:
        file.write(text[: len(text) // 2])
    return folder
