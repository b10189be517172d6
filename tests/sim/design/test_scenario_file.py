"""Gains written into a scenario file: two values change, and nothing else."""

import stat
import tomllib

import pytest

from sim.design.command import check_writable, write_gains
from sim.design.theory.linear import Gains
from sim.errors import HarnessError

GAINS = Gains(7654321.98765432, 1234.56789123)


def test_two_values_change_and_every_other_character_stays(scenario_file):
    before = scenario_file.read_text(encoding="utf-8")
    write_gains(scenario_file, GAINS)
    expected = before.replace("k_w= 6.2e6 ", "k_w= 7654321.99 ").replace("k_a =1615 ", "k_a =1234.56789 ")
    assert scenario_file.read_text(encoding="utf-8") == expected
    assert expected != before


def test_line_ends_and_permissions_stay(scenario_file):
    scenario_file.write_bytes(scenario_file.read_bytes().replace(b"\n", b"\r\n"))
    scenario_file.chmod(0o640)
    write_gains(scenario_file, GAINS)
    content = scenario_file.read_bytes()
    assert content.count(b"\r\n") == content.count(b"\n") > 20
    assert stat.S_IMODE(scenario_file.stat().st_mode) == 0o640


def test_keys_of_other_sections_are_left_alone(scenario_file):
    with scenario_file.open("a") as file:
        file.write("\n[flight.control]\nk_w = 11.0\nk_a = 12.0\n")
    write_gains(scenario_file, GAINS)
    flight = tomllib.loads(scenario_file.read_text())["flight"]
    assert flight["control"] == {"k_w": 11.0, "k_a": 12.0}


def test_a_link_is_followed_and_stays_a_link(scenario_file, tmp_path):
    link = tmp_path / "link.toml"
    link.symlink_to(scenario_file)
    write_gains(link, GAINS)
    assert link.is_symlink()
    assert "7654321.99" in scenario_file.read_text()


def test_nothing_else_is_left_behind(scenario_file):
    write_gains(scenario_file, GAINS)
    assert list(scenario_file.parent.iterdir()) == [scenario_file]


@pytest.mark.parametrize(
    "control",
    [
        'control = { law = "pd", k_w = 1.0, k_a = 1.0, leak_s = 1.0 }\n',
        '[control]\nlaw = "pd"\nk_w = 1.0\n',
        'text = """\n[control]\nk_w = 1.0\nk_a = 1.0\n"""\n',
    ],
    ids=["inline table", "one key", "inside a text"],
)
def test_what_cannot_be_edited_is_refused_and_left_alone(tmp_path, control):
    path = tmp_path / "odd.toml"
    path.write_text(control)
    with pytest.raises(HarnessError, match=r"odd\.toml: gains can be written only where \[control\] gives"):
        write_gains(path, GAINS)
    assert path.read_text() == control


def test_a_dotted_key_can_be_edited(tmp_path):
    path = tmp_path / "dotted.toml"
    path.write_text('control.law = "pd"\ncontrol.k_w = 1.0\ncontrol . k_a = 2.0 # a\n')
    write_gains(path, Gains(3.0, 4.5))
    assert path.read_text() == 'control.law = "pd"\ncontrol.k_w = 3.0\ncontrol . k_a = 4.5 # a\n'


def test_a_scenario_that_ships_is_not_written_into():
    with pytest.raises(HarnessError, match="--write microsat: gains are not written"):
        check_writable("microsat")


def test_a_missing_file_is_told_before_anything_is_computed(tmp_path):
    with pytest.raises(HarnessError, match=r"gone\.toml: cannot be read"):
        check_writable(str(tmp_path / "gone.toml"))
