"""What the filter estimates, in summary and report: values, deviations, bounds and truth by component."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.parameters import NAMES, NOTHING, OF_CELLS, SIZES
from sim.report.figures.parameters import parameter_figures, true_parameters
from sim.report.page import UNITS, parameter_table
from sim.scenario.schema import flight_table, load

UNLIKE = {
    "body": {"inertia_kgm2": [[1.1, 0.03, -0.02], [0.03, 1.75, 0.05], [-0.02, 0.05, 1.95]]},
    "coils": {
        "dipole_scale": [0.95, 1.02, 1.04],
        "misalignment_deg": [[0.0, 0.4, -0.3], [0.2, 0.0, 0.5], [-0.6, 0.1, 0.0]],
    },
    "sensors": {
        "magnetometer": {
            "bias_nt": [150.0, -250.0, 100.0],
            "scale": [1.001, 0.998, 1.003],
            "misalignment_deg": [0.3, -0.2, 0.1],
            "latency_s": 0.4,
        },
        "sun": {"misalignment_deg": [-0.1, 0.25, 0.15], "latency_s": 0.7},
    },
    "disturbance": {
        "torque_nm": [2e-8, -1e-8, 3e-8],
        "torque_daily_part": 0.4,
        "residual_dipole_am2": [0.02, -0.03, 0.01],
        "residual_dipole_eclipse_am2": [0.004, 0.002, -0.008],
    },
    "flight": {
        "body": {"inertia_kgm2": [[1.0, 0.0, 0.0], [0.0, 1.8, 0.01], [0.0, 0.01, 2.0]]},
        "uncertainty": {
            "inertia_percent": 12.0,
            "products_percent": 3.0,
            "residual_dipole_am2": 0.05,
            "coil_gain_percent": 6.0,
            "coil_misalignment_deg": 0.5,
            "magnetometer_bias_nt": 400.0,
            "magnetometer_scale_percent": 0.4,
            "magnetometer_misalignment_deg": 0.9,
            "sun_misalignment_deg": 0.6,
            "torque_nm": 3e-7,
            "latency_s": 0.8,
        },
    },
}
FIVE = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -0.6, 0.8], [0.0, 0.0, -1.0]]
TRUTH = {"t_s": np.array([0.0, 3600.0]), "lit": np.array([1.0, 0.25])}


def turned(axis, turn_deg, scale):
    return scale * Rotation.from_rotvec(turn_deg, degrees=True).apply(np.eye(3)[axis])


COILS = np.column_stack(
    [turned(0, [0.0, 0.4, -0.3], 0.95), turned(1, [0.2, 0.0, 0.5], 1.02), turned(2, [-0.6, 0.1, 0.0], 1.04)]
)
COILS = (COILS - np.eye(3)).ravel()
"""G of the three coils by rows."""


def estimate_of(parameters, variances):
    return Estimate((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), parameters, np.diag(variances))


@pytest.fixture(scope="module")
def figures():
    """Of a filter that carries all, every value and deviation another."""
    parameters = replace(
        NOTHING,
        mag_bias_t=(1e-7, -2e-7, 3e-7),
        coil_error=tuple(0.01 * n for n in range(9)),
        delay_s=(0.3, 0.6),
    )
    estimate = estimate_of(parameters, [(1.0 + n) ** 2 for n in range(41)])
    return parameter_figures(load("microsat", UNLIKE), TRUTH, estimate)


class TestFigures:
    def test_are_of_every_parameter_that_is_carried(self, figures):
        """Of a satellite without Sun cells there is nothing that these are wrong by."""
        assert [*NAMES] == [*UNITS]
        assert [*figures] == [name for name in NAMES if name not in OF_CELLS]

    def test_values_and_deviations_are_those_of_the_last_estimate(self, figures):
        assert figures["mag_bias_t"]["value"] == [1e-7, -2e-7, 3e-7]
        assert figures["coil_error"]["value"] == [0.01 * n for n in range(9)]
        assert figures["delay_s"]["value"] == [0.3, 0.6]
        assert figures["mag_bias_t"]["sigma"] == [7.0, 8.0, 9.0]
        assert figures["delay_s"]["sigma"] == [40.0, 41.0]

    @pytest.mark.parametrize(
        ("name", "bound"),
        [
            ("mag_bias_t", [4e-7] * 3),
            ("torque_body_nm", [3e-7] * 3),
            ("dipole_body_am2", [0.05] * 3),
            ("coil_error", np.where(np.eye(3), 0.06, np.radians(0.5)).ravel()),
            ("inertia_error_kgm2", [0.12, 0.216, 0.24, 0.048, 0.048, 0.048]),
            ("mag_turn_rad", np.radians([0.9] * 3)),
            ("mag_scale", [0.004] * 3),
            ("sun_turn_rad", np.radians([0.6] * 3)),
            ("delay_s", [0.8, 0.8]),
        ],
    )
    def test_bounds_are_those_of_the_table(self, figures, name, bound):
        assert figures[name]["bound"] == pytest.approx([*bound])

    @pytest.mark.parametrize(
        ("name", "truth"),
        [
            ("mag_bias_t", [1.5e-7, -2.5e-7, 1e-7]),
            ("torque_body_nm", np.array([2e-8, -1e-8, 3e-8]) * (1.0 + 0.4 * np.cos(np.pi / 12.0))),
            ("dipole_body_am2", [0.023, -0.0285, 0.004]),  # of the last row, three quarters in shadow
            ("coil_error", COILS),
            ("inertia_error_kgm2", [0.1, -0.05, -0.05, 0.03, -0.02, 0.04]),
            ("mag_turn_rad", np.radians([0.3, -0.2, 0.1])),
            ("mag_scale", [0.001, -0.002, 0.003]),
            ("sun_turn_rad", np.radians([-0.1, 0.25, 0.15])),
            ("delay_s", [0.4, 0.7]),
        ],
    )
    def test_the_truth_is_the_plant_s(self, figures, name, truth):
        assert figures[name]["truth"] == pytest.approx([*truth], abs=1e-15)

    def test_of_an_exact_table_there_are_only_bias_and_torque(self):
        estimate = estimate_of(NOTHING, [1.0] * 12)
        assert [*parameter_figures(load("microsat"), TRUTH, estimate)] == ["mag_bias_t", "torque_body_nm"]

    def test_a_torque_that_follows_the_motion_has_no_one_truth(self):
        estimate = estimate_of(NOTHING, [1.0] * 12)
        eddy = load("microsat", {"disturbance": {"eddy_nms_per_t2": 100.0}})
        found = parameter_figures(eddy, TRUTH, estimate)
        assert "truth" not in found["torque_body_nm"]
        assert found["mag_bias_t"]["truth"] == [0.0, 0.0, 0.0]

    @pytest.mark.parametrize("variance", [-1e-20, np.nan])
    def test_of_an_estimate_that_is_not_sound_there_are_none(self, variance):
        estimate = estimate_of(NOTHING, [1.0] * 11 + [variance])
        assert parameter_figures(load("microsat"), TRUTH, estimate) is None

    def test_without_a_filter_there_are_none(self):
        assert parameter_figures(load("microsat"), TRUTH, None) is None


class TestCells:
    """Gains, and the mean of the Earth's light; what changes along the orbit has no one truth."""

    @pytest.fixture
    def figures_of_cells(self):
        cells = {"normals": FIVE, "gain": [1.1, 0.9, 1.0, 1.05, 0.95], "turn_deg": None, "albedo": 0.36}
        unlike = {"sensors": {"cells": cells}, "flight": {"cells": {"albedo": 0.3}}}
        known = {name: (0.0,) * size for name, size in OF_CELLS.items()}
        estimate = estimate_of(replace(NOTHING, **known), [1.0] * sum(SIZES.values()))
        return parameter_figures(load("cubesat-cells", unlike), TRUTH, estimate)

    def test_truths_are_beyond_those_of_the_table(self, figures_of_cells):
        assert figures_of_cells["cell_gain"]["truth"] == pytest.approx([0.1, -0.1, 0.0, 0.05, -0.05, 0.0])
        assert figures_of_cells["earth_light"]["truth"] == pytest.approx([0.06])
        assert "truth" not in figures_of_cells["cell_excess"]


class TestTable:
    def test_a_row_a_component_in_the_units_of_people(self, figures):
        rows = {row[0]: row[1:] for row in parameter_table({"parameters": figures}).rows}
        assert len(rows) == 35
        assert rows["mag_bias_y"] == ("nT", "400", "-200", "8e+09", "-250")
        assert rows["coil_yy"] == ("%", "6", "4", "2000", "1.995")
        assert rows["coil_yz"][0:4] == ("%", "0.8727", "5", "2100")
        assert rows["mag_turn_y"][0:2] == ("°", "0.9")
        assert rows["mag_turn_y"][-1] == "-0.2"
        assert rows["inertia_xz"] == ("kg m²", "0.048", "0", "29", "-0.02")
        assert rows["sun_delay"] == ("s", "0.8", "0.6", "41", "0.7")

    def test_without_a_truth_there_is_a_dash(self, figures):
        without = {key: values for key, values in figures["torque_body_nm"].items() if key != "truth"}
        (row, *_) = parameter_table({"parameters": {"torque_body_nm": without}}).rows
        assert row == ("torque_x", "N m", "3e-07", "0", "10", "–")

    def test_of_a_summary_without_parameters_is_empty(self):
        assert parameter_table({}).rows == []


class TestRun:
    """In the files of a real run, both from the replay."""

    @pytest.mark.long
    def test_the_summary_has_them(self, concluded, strict):
        found = strict((concluded / "summary.json").read_text(encoding="utf-8"))["parameters"]
        assert [*found] == ["mag_bias_t", "torque_body_nm"]
        for figures in found.values():
            assert {*figures} == {"value", "sigma", "bound", "truth"}
            assert all(
                0.0 < sigma <= bound for sigma, bound in zip(figures["sigma"], figures["bound"], strict=True)
            )

    @pytest.mark.long
    def test_the_page_shows_them(self, concluded):
        html = (concluded / "report.html").read_text(encoding="utf-8")
        section = html[html.index('<section id="parameters">') :]
        assert section.index("mag_bias_x") < section.index("torque_z") < section.index("</section>")
        assert "dipole_x" not in section[: section.index("</section>")]

    @pytest.mark.long
    def test_a_page_without_a_filter_has_no_such_section(self, made_run, tmp_path):
        assert 'id="parameters"' not in made_run().write(tmp_path).source


def test_of_a_sun_sensor_the_light_of_the_earth_is_a_parameter_too():
    scenario = load("realsat", {"sensors": {"sun": {"albedo": 0.25}}})
    true = true_parameters(scenario, flight_table(scenario), {"lit": np.ones(1), "t_s": np.zeros(1)})
    assert true["earth_light"] == (0.25,)
