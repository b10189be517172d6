"""Calibration at the gate: samples into body axes, the coil driver's outputs to axes of the body and back."""

import numpy as np
import pytest

from fsw.core.gate.calibration import (
    NO_CALIBRATION,
    Calibration,
    MagnetometerCalibration,
    Outputs,
    calibrated,
    for_outputs,
)
from fsw.core.gate.readings import NOTHING
from fsw.wire.messages import (
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    MagField,
    SunVector,
)

FIELD = MagField(1, 12000.0, -34000.0, 8000.0, 5)
SUN = SunVector(1, 0.6, -0.48, 0.64, 7)
OFFSET = (60000.0, -1500.0, 300.0)
RANGE_NT = 34000.0
MATRIX = ((0.01, -0.97, 0.02), (1.03, 0.03, -0.04), (-0.02, 0.05, -1.05))
"""Neither symmetric nor a rotation: it mirrors."""
OUTPUTS = Outputs((2, 0, 1), (-1, 1, -1))
"""Output 1 drives the coil along axis 3, in the other sense, output 2 along 1, output 3 against 2."""


def test_without_a_calibration_the_readings_are_the_very_same():
    readings = NOTHING._replace(field=FIELD, sun=SUN)
    assert calibrated(readings, NO_CALIBRATION) is readings


def test_the_field_is_freed_of_its_offset_then_multiplied():
    found = calibrated(
        NOTHING._replace(field=FIELD), Calibration(MagnetometerCalibration(OFFSET, MATRIX, RANGE_NT))
    ).field
    expected = np.array(MATRIX) @ (np.array(FIELD.values()[1:4]) - OFFSET)
    assert found.values()[1:4] == pytest.approx(expected, rel=1e-14)
    assert (found.valid, found.counter) == (1, 5)


def test_a_sample_that_is_not_valid_does_not_become_valid():
    broken = NOTHING._replace(field=FIELD.replace(valid=0))
    assert calibrated(broken, Calibration(MagnetometerCalibration(OFFSET, MATRIX, RANGE_NT))).field.valid == 0


def test_an_axis_at_the_end_of_its_range_says_nothing_along_its_column():
    known = Calibration(MagnetometerCalibration(OFFSET, MATRIX, RANGE_NT))
    at_the_end = NOTHING._replace(field=FIELD.replace(valid=0))
    assert calibrated(at_the_end, known).saturated == ((-0.97, 0.03, 0.05),)
    below = at_the_end._replace(field=at_the_end.field.replace(b_y=-33998.0))
    assert calibrated(below, known).saturated == ()
    assert calibrated(NOTHING._replace(field=FIELD), known).saturated == (), "the sample is valid"
    other = calibrated(at_the_end._replace(field=at_the_end.field.replace(b_y=-33000.0, b_z=-34000.0)), known)
    assert other.saturated == ((0.02, -0.04, -1.05),)
    both = calibrated(at_the_end._replace(field=at_the_end.field.replace(b_x=34000.0)), known)
    assert both.saturated == ((0.01, 1.03, -0.02), (-0.97, 0.03, 0.05))


def test_the_sun_is_turned_and_the_field_is_not():
    turn = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    found = calibrated(NOTHING._replace(field=FIELD, sun=SUN), Calibration(sun=turn))
    assert found.sun.values()[1:4] == (-0.48, 0.64, 0.6)
    assert found.field is FIELD


@pytest.mark.parametrize(("output", "axis", "sign"), [(0, 2, -1), (1, 0, 1), (2, 1, -1)])
def test_a_report_of_an_output_is_one_of_its_axis_and_back(output, axis, sign):
    sent = CoilStatus(level=2, coil=output, remaining_ms=1000, current_ma=100, lockout_ms=90, seq=9)
    found = calibrated(NOTHING._replace(coil=sent), Calibration(outputs=OUTPUTS)).coil
    assert found == sent.replace(coil=axis, level=2 * sign, current_ma=100 * sign)
    request = CoilFire(level=-3, coil=axis, seq=10, tick=4, duration_ms=3000)
    fired = for_outputs(request, Calibration(outputs=OUTPUTS))
    assert fired == request.replace(coil=output, level=-3 * sign)


@pytest.mark.parametrize("output", [0, 1, 2])
def test_a_current_without_a_level_stays_as_it_was_read(output):
    """It may flow in any coil: in which sense of its axis is for who finds the coil."""
    sent = CoilStatus(level=0, coil=output, remaining_ms=0, current_ma=-100, lockout_ms=90, seq=9)
    found = calibrated(NOTHING._replace(coil=sent), Calibration(outputs=OUTPUTS)).coil
    assert found == sent.replace(coil=OUTPUTS.axis[output])


def test_a_refusal_names_the_axis_and_one_of_no_coil_stays():
    for output, axis in ((0, 2), (3, 3)):
        sent = CoilRefused(output, 9, CoilRefusedReason.BAD_COIL, 4)
        assert calibrated(NOTHING._replace(refused=sent), Calibration(outputs=OUTPUTS)).refused.coil == axis


def test_a_continuous_dipole_goes_out_and_comes_back_the_same():
    wanted = CoilDipole(0.1, -0.7, 0.4)
    sent = for_outputs(wanted, Calibration(outputs=OUTPUTS))
    assert (sent.m_x, sent.m_y, sent.m_z) == (-0.4, 0.1, 0.7)
    driven = NOTHING._replace(dipole=CoilDipoleStatus(sent.m_x, sent.m_y, sent.m_z))
    back = calibrated(driven, Calibration(outputs=OUTPUTS)).dipole
    assert (back.m_x, back.m_y, back.m_z) == (0.1, -0.7, 0.4)


def test_without_outputs_a_request_is_the_very_same():
    request = CoilFire(level=-3, coil=1, seq=10, tick=4, duration_ms=3000)
    assert for_outputs(request, Calibration(sun=MATRIX)) is request
