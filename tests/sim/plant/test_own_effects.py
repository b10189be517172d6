"""User effects: what each sees of a tick, what it does to body and sensors, what it may not give."""

from dataclasses import dataclass

import numpy as np
import pytest

from fsw.wire.messages import MagField, SunVector
from sim.faults.section import FaultSection, make_plant
from sim.plant.errors import PlantError
from sim.plant.own_effects import NO_EFFECTS, Moment, OwnEffect, OwnEffects
from sim.plant.plant import Plant


@dataclass(frozen=True)
class Push:
    torque_nm: float = 2e-6

    def torque_body_nm(self, moment):
        return (0.0, self.torque_nm * (moment.t_s >= 3.0), 0.0)


@dataclass(frozen=True)
class Offset:
    offset_t: float = 1e-6

    def field_body_t(self, b_body_t, moment):
        x, y, z = b_body_t
        return (x + self.offset_t, y, z)

    def sun_body(self, sun_body, moment):
        x, y, z = sun_body
        return (y, -x, z)


def effects(*of):
    return OwnEffects([OwnEffect(f"own_{n}", f"effect {n}", one) for n, one in enumerate(of)])


def flown(plant, ticks=8):
    frames, rows = [], []
    for _ in range(ticks):
        frames.append(plant.begin_tick())
        rows.append(plant.truth())
        plant.end_tick()
    return frames, rows


def readings(frames, message):
    return [message.decode(frame.data) for sent in frames for frame in sent if frame.can_id == message.ID]


def test_without_one_not_a_bit_differs(make_config):
    before, after = flown(Plant(make_config())), flown(Plant(make_config(), own=NO_EFFECTS))
    assert before == after


def test_a_torque_acts_from_its_tick_on_and_is_in_the_histories(make_config):
    _, without = flown(Plant(make_config()))
    plant = Plant(make_config(), own=effects(Push()))
    _, rows = flown(plant)
    assert plant.torque_sources[-1] == "own_0"
    assert [row.torque_body_nm[-1][1] for row in rows] == [0.0, 0.0, 0.0, *[2e-6] * 5]
    rates = np.array([row.omega_body_orbit_radps for row in rows])
    others = np.array([row.omega_body_orbit_radps for row in without])
    assert np.array_equal(rates[:4], others[:4])
    gained = (rates - others)[7, 1]
    assert gained == pytest.approx(4.0 * 2e-6 / 1.85, rel=0.02)


def test_torques_add_up(make_config):
    _, once = flown(Plant(make_config(), own=effects(Push(5e-6))))
    _, twice = flown(Plant(make_config(), own=effects(Push(2e-6), Push(3e-6))))
    assert np.allclose(once[-1].omega_body_orbit_radps, twice[-1].omega_body_orbit_radps, rtol=1e-12)
    assert len(twice[-1].torque_body_nm) == len(once[-1].torque_body_nm) + 1


def test_a_reading_is_replaced_and_the_truth_is_not(make_config):
    frames, rows = flown(Plant(make_config(), own=effects(Offset())))
    others, truth = flown(Plant(make_config()))
    assert rows == truth
    for mine, theirs in zip(readings(frames, MagField), readings(others, MagField), strict=True):
        assert mine.b_x - theirs.b_x == pytest.approx(1000.0, abs=10.0)
        assert (mine.b_y, mine.b_z) == (theirs.b_y, theirs.b_z)
    for mine, theirs in zip(readings(frames, SunVector), readings(others, SunVector), strict=True):
        assert (mine.s_x, mine.s_y) == pytest.approx((theirs.s_y, -theirs.s_x), abs=1e-4)


def test_it_sees_the_instant_of_the_tick(make_config):
    moments = []

    class Watch:
        def torque_body_nm(self, moment):
            moments.append(moment)
            return (0.0, 0.0, 0.0)

    _, rows = flown(Plant(make_config(), own=effects(Watch())), 3)
    for moment, row in zip(moments, rows, strict=False):
        assert moment.t_s == row.t_s
        assert (moment.b_body_t, moment.sun_body) == (row.b_body_t, row.sun_body)
        assert (moment.lit, moment.r_eci_m) == (row.lit, row.r_eci_m)
    assert moments[0].omega_body_radps != moments[1].omega_body_radps
    flown_m = np.subtract(moments[2].r_eci_m, moments[0].r_eci_m)
    middle_mps = flown_m / (moments[2].t_s - moments[0].t_s)
    assert moments[1].v_eci_mps == pytest.approx(tuple(middle_mps), rel=1e-5)


def test_faults_come_after_it(make_config):
    double = FaultSection(kind="mag_scale", at_s=2.0, lasts_s=2.0, parameters={"axis": 0.0, "scale": 2.0})
    plant, seen = make_plant(make_config(), [double], effects(Offset())), []
    for _ in range(5):
        plant.begin_tick()
        seen.append(plant.interference.field((1e-6, 0.0, 0.0), True)[0][0])
        plant.end_tick()
    assert seen == pytest.approx([2e-6, 2e-6, 4e-6, 4e-6, 2e-6])


@pytest.mark.parametrize(
    ("torque", "what"),
    [
        (lambda self, moment: 1 / 0, "effect 0, 0 s: it fails: ZeroDivisionError: division by zero"),
        (lambda self, moment: None, "it fails: TypeError"),
        (lambda self, moment: (1.0, 2.0), "it fails: ValueError: not enough values"),
        (lambda self, moment: (1.0, float("nan"), 0.0), "it gives 1, nan, 0, which is not finite"),
        (lambda self, moment: "abc", "it fails: ValueError"),
    ],
)
def test_what_is_no_vector_ends_the_plant_with_a_sentence(torque, what):
    bad = type("Bad", (), {"torque_body_nm": torque})
    with pytest.raises(PlantError) as caught:
        effects(bad()).observe(Moment())
    assert what in str(caught.value)
    assert str(caught.value).startswith("the effect ")


def test_a_sensor_that_sees_no_sun_stays_blind():
    assert effects(Offset()).sun((0.0, 0.0, 0.0), False) == ((0.0, 0.0, 0.0), False)
