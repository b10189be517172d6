"""The section of the onboard table for Sun cells, and the bounds and priors that follow."""

from math import cos, hypot, radians, sqrt

import numpy as np
import pytest

from fsw.input.schema import TableError
from fsw.table.cells import QUANTUM, cell_set
from fsw.table.config import flight_config
from fsw.table.estimator import estimator_config, plausibility_config
from fsw.table.table import flight_table

NORMALS = [[2.0, 0.0, 0.0], [0.0, -3.0, 4.0], [0.0, 0.0, 0.5]]


def table(cells=None, **sections):
    return flight_table({"cells": {"normals": NORMALS, **(cells or {})}, **sections}, "a table")


def test_normals_are_made_unit_and_the_rest_goes_to_si():
    shade = {"cell": 2, "axis": [0.0, 2.0, 0.0], "half_deg": 30.0}
    given = table({"full_sun": [1.0, 0.8, 1.1], "noise_percent": 2.0, "dark_percent": 8.0, "shades": [shade]})
    cells = cell_set(given.cells, 0.07, 0.05, 0.08)
    np.testing.assert_allclose(cells.normals_body, [(1.0, 0.0, 0.0), (0.0, -0.6, 0.8), (0.0, 0.0, 1.0)])
    assert cells.full_sun == (1.0, 0.8, 1.1)
    assert [len(shades) for shades in cells.shades] == [0, 1, 0]
    assert cells.shades[1][0].axis_body == (0.0, 1.0, 0.0)
    assert cells.shades[1][0].cosine == pytest.approx(cos(radians(30.0)))
    assert (cells.dark, cells.albedo) == (pytest.approx(0.08), 0.3)
    assert (cells.excess_sigma, cells.gain_sigma, cells.light_sigma) == (0.07, 0.05, 0.08)
    assert cells.model_sigma == pytest.approx(sqrt(0.07**2 + 0.05**2 + 0.08**2))
    assert cells.sigma == pytest.approx(hypot(0.02, QUANTUM / sqrt(12.0)))


def test_a_step_coarser_than_that_of_the_bus_is_the_error_of_a_current():
    coarse = cell_set(table({"noise_percent": 2.0, "quantum_percent": 6.0}).cells, 0.1, 0.05, 0.08)
    assert coarse.step == pytest.approx(0.06)
    assert coarse.sigma == pytest.approx(hypot(0.02, 0.06 / sqrt(12.0)))
    assert cell_set(table().cells, 0.1, 0.05, 0.08).step == 0.0
    assert table({"quantum_percent": 0.0}).crc == table().crc != table({"quantum_percent": 6.0}).crc
    limits = [plausibility_config(table({"quantum_percent": percent})) for percent in (0.0, 6.0)]
    assert limits[1].sun_norm > limits[0].sun_norm


def test_full_sun_is_nominal_unless_it_is_given():
    assert cell_set(table().cells, 0.1, 0.05, 0.08).full_sun == (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"normals": []}, "cells.normals"),
        ({"normals": [[1.0, 0.0, 0.0]] * 7}, "cells.normals"),
        ({"normals": [[0.0, 0.0, 0.0]]}, "must not be zero"),
        ({"full_sun": [1.0]}, "full_sun must be 3 numbers"),
        ({"shades": [{"cell": 4, "axis": [1.0, 0.0, 0.0], "half_deg": 5.0}]}, "no such cell"),
        ({"shades": [{"cell": 1, "axis": [0.0, 0.0, 0.0], "half_deg": 5.0}]}, "axis must not be zero"),
        ({"albedo": 1.5}, "cells.albedo"),
        (
            {"quantum_percent": -0.5},
            "cells.quantum_percent = -0.5 is not allowed: allowed is a number at least 0",
        ),
        ({"gain": [1.0]}, "cells.gain is not a known key"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(wrong, said):
    with pytest.raises(TableError, match=said) as error:
        table(wrong)
    assert str(error.value).startswith("a table: cells")


class TestErrors:
    """Of gain, Earth's light and excess; where the Earth's light is not reckoned with all is excess."""

    @pytest.mark.parametrize(
        ("albedo", "bounds", "gain", "light", "excess"),
        [
            (0.3, {}, 0.10, 0.15, 0.075),
            (0.2, {}, 0.10, 0.10, 0.05),
            (0.0, {}, 0.10, None, 0.30),
            (0.3, {"cell_gain_percent": 4.0, "cell_light_percent": 3.0}, 0.04, 0.03, 0.015),
        ],
    )
    def test_are_those_of_the_bounds(self, albedo, bounds, gain, light, excess):
        config = estimator_config(table({"albedo": albedo}, uncertainty=bounds)).mekf
        sigmas, places = np.sqrt(config.initial_covariance.diagonal()), config.layout
        np.testing.assert_allclose(sigmas[places.cells], excess / sqrt(3.0))
        np.testing.assert_allclose(sigmas[places.cell_gain], gain / sqrt(3.0))
        if light is None:
            assert places.earth_light is None
        else:
            np.testing.assert_allclose(sigmas[places.earth_light], light / sqrt(3.0))
        cells = config.cells
        assert (cells.excess_sigma, cells.gain_sigma) == pytest.approx((excess / sqrt(3.0), gain / sqrt(3.0)))

    def test_of_a_satellite_without_cells_are_not_carried(self):
        config = estimator_config(flight_table({}, "a table")).mekf
        places, known = config.layout, config.initial_parameters
        assert (config.cells, places.cells, places.cell_gain) == (None,) * 3
        assert (known.cell_excess, known.cell_gain) == ((), ())

    def test_but_the_earths_light_is_which_deflects_a_sun_sensor(self):
        config = estimator_config(flight_table({"uncertainty": {"albedo_percent": 40.0}}, "a table")).mekf
        assert config.initial_parameters.earth_light == pytest.approx((0.2,))
        without = estimator_config(flight_table({"uncertainty": {"albedo_percent": 0.0}}, "a table")).mekf
        assert without.layout.earth_light is None
        assert without.initial_parameters.earth_light == ()


def test_the_noise_of_a_sun_sensor_has_no_part_where_there_are_cells():
    limits = [plausibility_config(table(estimator={"sun_sigma_deg": deg})) for deg in (0.1, 3.0)]
    assert limits[0] == limits[1]
    assert limits[0].cells is not None


def test_a_table_without_cells_has_the_checksum_of_before():
    """Pinned: of a software that knew no cells."""
    assert flight_table({}, "a table").crc == PINNED_CRC
    assert table().crc != table({"albedo": 0.2}).crc


def test_it_makes_a_config():
    assert flight_config(table()).estimator.mekf.cells is not None


PINNED_CRC = 3757111783
