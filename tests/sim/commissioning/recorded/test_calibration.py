"""A calibration file: what it says is what the filter gets, and wrong keys are named."""

import numpy as np
import pytest
from recorded_samples import AXES, DATA, RATIOS
from scipy.spatial.transform import Rotation

from fsw.input.schema import TableError
from sim.commissioning.recorded.calibration import UNCALIBRATED, read_calibration, turned_inertia


def test_the_file_of_a_satellite_in_orbit():
    known = read_calibration(DATA / "calibration.toml")
    assert [cell.name for cell in known.cells] == ["2", "3", "4"]
    assert all(np.linalg.norm(cell.face_body) == pytest.approx(1.0) for cell in known.cells)
    assert np.linalg.eigvalsh(known.inertia) == pytest.approx([0.1784, 0.9987, 1.0], abs=1e-9)
    assert known.spin_axis == pytest.approx([0.0895, 0.9956, 0.026], abs=1e-3)
    raw = known.offset_nt + np.array((1000.0, 0.0, 0.0))
    assert known.field_nt(raw[None])[0] == pytest.approx(1000.0 * known.matrix[:, 0], abs=0.1)


def test_without_a_calibration_samples_are_as_they_are():
    np.testing.assert_array_equal(UNCALIBRATED.field_nt(np.array([[1.0, -2.0, 3.0]])), [[1.0, -2.0, 3.0]])
    np.testing.assert_array_equal(UNCALIBRATED.inertia, np.eye(3))


def test_the_turn_leads_from_body_axes_to_principal_axes():
    inertia = turned_inertia(7.0 * RATIOS, Rotation.from_matrix(AXES).as_rotvec())
    for ratio, axis in zip(RATIOS, AXES.T, strict=True):
        np.testing.assert_allclose(inertia @ axis, ratio * axis, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[calibration.magnetometer]\noffset = [1.0, 2.0, 3.0]", "calibration.magnetometer.offset"),
        ("[calibration.magnetometer]\noffset_nt = [1.0, 2.0]", "calibration.magnetometer.offset_nt"),
        ('[[recorded.cell]]\nname = "a"\nface_body = [1.0, 0.0, 0.0]\nfull_scale = -1.0', "full_scale"),
        ("[recorded.body]\ninertia_ratios = [1.0, 0.0, 1.0]", "inertia_ratios"),
        ("offset_nt = 3", "offset_nt"),
        (
            "[calibration.magnetometer]\nmatrix = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]",
            "calibration.magnetometer.matrix: it takes a field in one direction times 0, in another times 0;",
        ),
        (
            "[calibration.magnetometer]\nmatrix = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 0.0, 1.0]]",
            "allowed is 0.001 to 1000: a singular matrix loses a direction",
        ),
        (
            "[calibration.magnetometer]\nmatrix = [[1e9, 0, 0], [0, 1e9, 0], [0, 0, 1e9]]",
            "times 1e+09, in another times 1e+09",
        ),
        (
            '[[recorded.cell]]\nname = "a"\nface_body = [0, 0, 0]\nfull_scale = 1.0',
            "recorded.cell.0.face_body: (0, 0, 0) is no direction",
        ),
    ],
)
def test_a_wrong_key_is_named(tmp_path, text, said):
    path = tmp_path / "c.toml"
    path.write_text(text)
    with pytest.raises(TableError) as error:
        read_calibration(path)
    assert said in str(error.value)
    assert str(path) in str(error.value)
