"""Configurations that a plant refuses."""

from dataclasses import replace

import pytest

from sim.plant.config import (
    CoilConfig,
    InitialConfig,
)


@pytest.mark.parametrize(
    ("parts", "match"),
    [
        ({"tick_hz": 2, "limits": None}, "another tick_hz"),
        ({"max_substep_s": 0.0}, "max_substep_s"),
        ({"epoch_unix_s": -1}, "epoch_unix_s"),
        ({"seed": -1}, "seed"),
    ],
)
def test_a_plant_that_cannot_be_is_refused(make_config, parts, match):
    if "limits" in parts:
        parts = {**parts, "limits": make_config().limits}
    with pytest.raises(ValueError, match=match):
        make_config(**parts)


@pytest.mark.parametrize(
    ("inertia", "match"),
    [
        (((1.0, 0.1, 0.0), (0.2, 2.0, 0.0), (0.0, 0.0, 3.0)), "symmetric"),
        (((1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.0, 0.0, 3.0)), "positive definite"),
        (((1.0, 3.0, 0.0), (3.0, 2.0, 0.0), (0.0, 0.0, 3.0)), "positive definite"),
    ],
)
def test_an_inertia_tensor_that_no_body_has_is_refused(make_config, inertia, match):
    with pytest.raises(ValueError, match=match):
        replace(make_config().body, inertia_kgm2=inertia)


@pytest.mark.parametrize("levels", [(2.0, 0.5, 8.0), (0.0, 1.0, 2.0), (1.0, 1.0, 2.0)])
def test_levels_that_do_not_rise_are_refused(levels):
    with pytest.raises(ValueError, match="levels_am2"):
        CoilConfig(levels)


def test_an_initial_attitude_that_is_none_is_refused():
    with pytest.raises(ValueError, match="unit norm"):
        InitialConfig((1.0, 1.0, 0.0, 0.0))
