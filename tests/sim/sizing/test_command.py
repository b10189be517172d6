"""``torquer size``: what it prints and what it ends with."""

import pytest

from sim.console import Console, speaking
from sim.scenario.schema import load, parse_settings
from sim.sizing.command import as_text, principal_turn_deg, size
from sim.sizing.expectation import expect
from sim.sizing.gravity import gravity_on
from sim.sizing.levels import levels_against

KEYS = {
    "scenario": str,
    "inertia_kgm2": tuple,
    "altitude_km": float,
    "inclination_deg": float,
    "levels_am2": tuple,
    "suggested_levels_am2": tuple,
    "field_across_coil_t": float,
    "disturbance_rms_nm": float,
    "load": float,
    "gravity_holds": bool,
    "gravity_away_nm": float,
    "detumbling": dict,
    "pointing_rms_deg": float | None,
    "least_pointing_rms_deg": float | None,
    "floor_deg": float,
    "quantum_deg": float,
    "ripple_deg": float,
    "variation_deg": float,
    "knowledge_deg": float,
    "points": bool,
}


def sized(name, *settings):
    """(exit code, document) of a scenario."""
    with speaking(Console("size")) as console:
        return size(load(name, parse_settings(settings))), console.answer


def test_a_sound_satellite(capsys):
    code, values = sized("cubesat6u")
    assert code == 0
    assert {name: isinstance(values[name], kind) for name, kind in KEYS.items()} == dict.fromkeys(KEYS, True)
    assert values["points"]
    out = capsys.readouterr().out
    assert f"{values['pointing_rms_deg']:.2f} deg RMS once settled" in out
    assert "0.02, 0.1, 0.5 A m^2" in out


@pytest.mark.parametrize(
    ("settings", "code", "words"),
    [
        (["disturbance.torque_nm=[1e-7,0,0]"], 1, "none to rely on: the disturbance is too strong"),
        (["disturbance.torque_nm=[6e-9,6e-9,6e-9]"], 0, "so large an error is a lower bound"),
        (["disturbance.torque_nm=[6e-9,6e-9,6e-9]"], 0, "they hardly turn and damp as well"),
        (["body.inertia_kgm2=[0.001,0.033,0.0335]"], 0, "judge it by axis 1 alone"),
    ],
)
def test_what_is_doubtful_is_said(settings, code, words, capsys):
    assert sized("cubesat3u", *settings)[0] == code
    assert words in capsys.readouterr().out


def test_a_continuous_driver_has_no_pulses_and_no_levels(capsys):
    code, values = sized("microsat", "coils.driver=continuous", "coils.max_dipole_am2=0.5")
    assert code == 0
    assert values["quantum_deg"] == 0.0
    assert values["ripple_deg"] < 1e-3
    out = capsys.readouterr().out
    assert "driven continuously, 0.5 A m^2 for 80% of a tick at most" in out
    assert "would do" not in out
    assert "without pulse limits" not in out


class TestAxesThatGravityDoesNotHold:
    """A 3U whose long axis is z, as most have it, and the same with its axes in the order that is held."""

    LONG_Z, HELD = "body.inertia_kgm2=[0.04,0.04,0.008]", "body.inertia_kgm2=[0.008,0.04,0.04]"

    def test_no_pointing_is_promised(self, capsys):
        _, values = sized("cubesat3u", self.LONG_Z)
        assert values["pointing_rms_deg"] is None
        assert not values["points"]
        assert not values["gravity_holds"]
        out = capsys.readouterr().out
        assert "J 0.04 up, 0.04 ahead, 0.008 along the normal" in out
        assert "turns the body over about axes 1 and 2" in out
        assert "it would hold z, of the least moment, up" in out
        assert "set body.up = 'z' and body.ahead = 'x'" in out
        assert "none to rely on" in out

    def test_with_axes_as_named_it_is_held_and_the_tensor_stays_in_body_axes(self, capsys):
        _, values = sized("cubesat3u", self.LONG_Z, "body.up=z", "body.ahead=x")
        assert values["gravity_holds"]
        assert values["inertia_kgm2"] == ((0.04, 0.0, 0.0), (0.0, 0.04, 0.0), (0.0, 0.0, 0.008))

    def test_the_order_that_is_named_is_held(self, capsys):
        _, values = sized("cubesat3u", self.HELD)
        assert values["gravity_holds"]
        assert values["points"]
        assert "holds the body, but for turns about axis 1" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("inertia", "turn_deg"),
    [
        ([[1.02, 0.1, 0.0], [0.1, 1.85, 0.0], [0.0, 0.0, 1.95]], 6.77),
        ([[1.02, -0.1, 0.0], [-0.1, 1.85, 0.0], [0.0, 0.0, 1.95]], 6.77),
        ([[1.95, 0.0, 0.0], [0.0, 1.02, 0.1], [0.0, 0.1, 1.85]], 6.77),
        ([[1.5, 0.0, 0.0], [0.0, 1.02, 0.0], [0.0, 0.0, 1.85]], 0.0),
    ],
)
def test_the_turn_of_the_principal_axes(inertia, turn_deg):
    assert principal_turn_deg(inertia) == pytest.approx(turn_deg, abs=0.01)


def test_products_of_inertia_are_said_with_their_sign():
    inertia = [[1.02, 0.1, 0.0], [0.1, 1.85, 0.0], [0.0, 0.0, 1.95]]
    scenario = load("microsat", {"body": {"inertia_kgm2": inertia}})
    expectation = expect(scenario)
    text = as_text(scenario, expectation, levels_against(scenario, expectation.load), gravity_on(scenario))
    assert "axes turned by 6.8 deg from the body axes, with products of inertia as J_xy = - integral" in text
