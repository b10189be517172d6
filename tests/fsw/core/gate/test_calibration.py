"""Calibration at the gate: samples into body axes, the coil driver's outputs to axes of the body and back."""

import numpy as np
import pytest
from gate_samples import measured

from fsw.core.gate.calibration import (
    NO_CALIBRATION,
    Calibration,
    MagnetometerCalibration,
    Outputs,
    for_outputs,
)
from fsw.core.gate.measurements import CoilReport, FieldReading, Measurements, Refusal, SunReading
from fsw.wire.messages import (
    CoilBoot,
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    MagField,
    PlantEnd,
    RefAttitude,
    RefRate,
    SunCells,
    SunVector,
    TcFreeze,
    WheelStatus,
)

FIELD = MagField(1, 12000.0, -34000.0, 8000.0, 5)
SUN = SunVector(1, 0.6, -0.48, 0.64, 7)
OFFSET = (60000.0, -1500.0, 300.0)
RANGE_NT = 34000.0
MATRIX = ((0.01, -0.97, 0.02), (1.03, 0.03, -0.04), (-0.02, 0.05, -1.05))
"""Neither symmetric nor a rotation: it mirrors."""
OUTPUTS = Outputs((2, 0, 1), (-1, 1, -1))
"""Output 1 drives the coil along axis 3, in the other sense, output 2 along 1, output 3 against 2."""


MAGNETOMETER = Calibration(MagnetometerCalibration(OFFSET, MATRIX, RANGE_NT))


def test_without_a_calibration_samples_are_as_they_were_sent():
    found = measured(NO_CALIBRATION, field=FIELD, sun=SUN)
    assert found.field == FieldReading(True, (12000.0, -34000.0, 8000.0))
    assert found.sun == SunReading(True, (0.6, -0.48, 0.64))


def test_the_field_is_given_in_tesla_too():
    assert measured(field=FIELD).field.b_body_t == (12000.0 * 1e-9, -34000.0 * 1e-9, 8000.0 * 1e-9)


def test_the_field_is_freed_of_its_offset_then_multiplied():
    found = measured(MAGNETOMETER, field=FIELD).field
    expected = np.array(MATRIX) @ (np.array((12000.0, -34000.0, 8000.0)) - OFFSET)
    assert found.b_body_nt == pytest.approx(expected, rel=1e-14)
    assert found.b_body_t == pytest.approx(1e-9 * expected, rel=1e-14)
    assert found.valid


def invalid(b_x=12000.0, b_y=-34000.0, b_z=8000.0):
    return measured(MAGNETOMETER, field=MagField(0, b_x, b_y, b_z, 5))


def test_a_sample_that_is_not_valid_does_not_become_valid():
    assert not invalid().field.valid


def test_an_axis_at_the_end_of_its_range_says_nothing_along_its_column():
    assert invalid().saturated == ((-0.97, 0.03, 0.05),)
    assert invalid(b_y=-33998.0).saturated == ()
    assert measured(MAGNETOMETER, field=FIELD).saturated == (), "the sample is valid"
    assert invalid(b_y=-33000.0, b_z=-34000.0).saturated == ((0.02, -0.04, -1.05),)
    assert invalid(b_x=34000.0).saturated == ((0.01, 1.03, -0.02), (-0.97, 0.03, 0.05))


def test_the_sun_is_turned_and_the_field_is_not():
    turn = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    found = measured(Calibration(sun=turn), field=FIELD, sun=SUN)
    assert found.sun == SunReading(True, (-0.48, 0.64, 0.6))
    assert found.field == measured(field=FIELD).field


class TestWhatIsSaidOfASample:
    """Whether it is valid is the board's word, whatever the sensor."""

    @pytest.mark.parametrize("valid", [0, 1])
    def test_valid(self, valid):
        found = measured(
            field=MagField(valid, 1.0, 2.0, 3.0),
            sun=SunVector(valid, 0.6, -0.48, 0.64),
            cells=SunCells(valid, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
            wheel=WheelStatus(valid, 1, -312.5, 0.001953125),
            ref_attitude=RefAttitude(valid, 0.5, -0.25, 0.125),
            ref_rate=RefRate(valid, 0.1, 0.2, 0.3),
        )
        samples = (found.field, found.sun, found.cells, found.wheel, found.ref_attitude, found.ref_rate)
        assert [sample.valid for sample in samples] == [bool(valid)] * 6
        assert found.cells.currents == (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
        assert found.wheel.speed_radps == -312.5
        assert (found.ref_attitude.vector, found.ref_rate.vector) == ((0.5, -0.25, 0.125), (0.1, 0.2, 0.3))


def test_what_did_not_come_is_missing():
    found, nothing = measured(), Measurements()
    names = [name for name in vars(Measurements) if not name.startswith("_")]
    assert len(names) == 20
    assert [getattr(found, name) for name in names] == [getattr(nothing, name) for name in names]


def test_what_else_came_is_passed_on():
    commands, again = (TcFreeze(1, 3),), (TcFreeze(0, 3),)
    end, boot = PlantEnd(9), CoilBoot(1, 1, 7)
    found = measured(telecommands=commands, repeated=again, under_own_id=0x200, end=end, coil_boot=boot)
    assert (found.telecommands, found.repeated, found.under_own_id) == (commands, again, 0x200)
    assert (found.end_ticks, found.coil_booted) == (9, True)


@pytest.mark.parametrize(("output", "axis", "sign"), [(0, 2, -1), (1, 0, 1), (2, 1, -1)])
def test_a_report_of_an_output_is_one_of_its_axis_and_back(output, axis, sign):
    sent = CoilStatus(level=2, coil=output, remaining_ms=1000, current_ma=100, lockout_ms=90, seq=9)
    found = measured(Calibration(outputs=OUTPUTS), coil=sent).coil
    assert found == CoilReport(2 * sign, axis, 1000, 100 * sign, 90, 9)
    assert measured(coil=sent).coil == CoilReport(2, output, 1000, 100, 90, 9), "without a calibration"
    request = CoilFire(level=-3, coil=axis, seq=10, tick=4, duration_ms=3000)
    fired = for_outputs(request, Calibration(outputs=OUTPUTS))
    assert fired == request.replace(coil=output, level=-3 * sign)


@pytest.mark.parametrize("output", [0, 1, 2])
def test_a_current_without_a_level_stays_as_it_was_read(output):
    """It may flow in any coil: in which sense of its axis is for who finds the coil."""
    sent = CoilStatus(level=0, coil=output, remaining_ms=0, current_ma=-100, lockout_ms=90, seq=9)
    found = measured(Calibration(outputs=OUTPUTS), coil=sent).coil
    assert found == CoilReport(0, OUTPUTS.axis[output], 0, -100, 90, 9)


def test_a_refusal_names_the_axis_and_one_of_no_coil_stays():
    for output, axis in ((0, 2), (3, 3)):
        sent = CoilRefused(output, 9, CoilRefusedReason.BAD_COIL, 4)
        found = measured(Calibration(outputs=OUTPUTS), refused=(sent,)).refused
        assert found == (Refusal(axis, 9, CoilRefusedReason.BAD_COIL, 4),)
        assert measured(refused=(sent,)).refused == (Refusal(output, 9, CoilRefusedReason.BAD_COIL, 4),)


def test_a_continuous_dipole_goes_out_and_comes_back_the_same():
    wanted = CoilDipole(0.1, -0.7, 0.4)
    sent = for_outputs(wanted, Calibration(outputs=OUTPUTS))
    assert (sent.m_x, sent.m_y, sent.m_z) == (-0.4, 0.1, 0.7)
    driven = CoilDipoleStatus(sent.m_x, sent.m_y, sent.m_z)
    assert measured(Calibration(outputs=OUTPUTS), dipole=driven).dipole == (0.1, -0.7, 0.4)
    assert measured(dipole=driven).dipole == (-0.4, 0.1, 0.7), "without a calibration"


def test_without_outputs_a_request_is_the_very_same():
    request = CoilFire(level=-3, coil=1, seq=10, tick=4, duration_ms=3000)
    assert for_outputs(request, Calibration(sun=MATRIX)) is request
