"""What a flown log tells whose COIL_STATUS are lost in part: nothing that is wrong."""

import random

import numpy as np
import pytest

import torquer
from fsw.wire.messages import CoilStatus
from sim.commissioning.calibrate.flown import coil_axes
from sim.commissioning.calibrate.flown.run_fit import calibrated
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.scenario.schema import flight_table, load

pytestmark = pytest.mark.long

TRUE = {"coils.dipole_scale": [1.04, 0.97, 1.02]}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """The log of an orbit with the pulses of the law phasing, in lines."""
    path = tmp_path_factory.mktemp("lost") / "run"
    torquer.fly("microsat", orbits=1.0, seed=4, out=path, set={"control.law": "phasing", **TRUE})
    return (path / "bus.log").read_text().splitlines(keepends=True)


def with_lost(lines, part, path):
    status, draw = f" {CoilStatus.ID:03X}#", random.Random(5)
    path.write_text("".join(line for line in lines if status not in line or draw.random() > part))
    return calibrated(read_samples(path, 1), flight_table(load("microsat")))


def sigmas_off(found):
    """By component of the coils' matrix."""
    sigma = np.sqrt(found.coils.covariance.diagonal()).reshape(3, 3)
    return np.abs(found.coils.matrix - np.diag(TRUE["coils.dipole_scale"])) / sigma


@pytest.mark.parametrize("part", [0.0, 0.02, 0.1])
@pytest.mark.slow
def test_dipoles_are_as_sure_as_the_reports_that_are_left(flown, part, tmp_path):
    assert sigmas_off(with_lost(flown, part, tmp_path / "bus.log")).max() < 4.0


def test_a_lost_report_that_is_taken_for_a_coil_at_rest_makes_them_wrong_and_sure(
    flown, tmp_path, monkeypatch
):
    monkeypatch.setattr(coil_axes, "_doubt_rate", lambda estimate, by_radps: None)
    assert sigmas_off(with_lost(flown, 0.1, tmp_path / "bus.log")).max() > 8.0
