"""``torquer doctor``: what is there, what is missing, what to type."""

from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from fsw.compiled import KERNEL, SWITCH, CodeStanding
from sim import doctor
from sim.console import Console, speaking
from sim.doctor import Finding, Presence, can_interfaces, examine, report

FOUND = [
    Finding("Python", Presence.OK, "3.11"),
    Finding("vcan0", Presence.OPTIONAL, "there is none", "sudo modprobe vcan"),
]
MISSING = Finding("packages", Presence.MISSING, "scipy is not installed", "pip install 'torquer'")


def test_this_machine_has_what_the_tests_need():
    found = {finding.name: finding for finding in examine()}
    assert {"Python", "packages", "folder", "disk", "timing", "SocketCAN"} <= set(found)
    assert "torquer[dev]" not in found
    for name in ("Python", "packages", "folder", "disk"):
        assert found[name].presence is Presence.OK, found[name]
    assert "numpy" in found["packages"].found


@pytest.mark.parametrize(
    ("found", "presence", "remedy"),
    [
        (CodeStanding(frozenset({"a"}), ""), Presence.OK, ""),
        (CodeStanding(frozenset(), "nothing is built"), Presence.OPTIONAL, "where there is a C compiler"),
    ],
)
def test_how_the_flight_code_runs(found, presence, remedy, monkeypatch):
    monkeypatch.delenv(SWITCH, raising=False)
    monkeypatch.setattr(doctor, "standing", lambda: found)
    code = {finding.name: finding for finding in examine()}["flight code"]
    assert (code.presence, code.found) == (presence, str(found))
    assert remedy in code.remedy


def test_outside_of_the_sources_the_remedy_is_the_command_that_compiles(monkeypatch, tmp_path):
    monkeypatch.delenv(SWITCH, raising=False)
    monkeypatch.setattr(doctor, "standing", lambda: CodeStanding(frozenset(), "nothing is built"))
    monkeypatch.setattr(doctor, "ROOT", tmp_path)
    code = {finding.name: finding for finding in examine()}["flight code"]
    assert code.remedy.startswith("TORQUER_COMPILED=1 pip install --force-reinstall --no-deps torquer,")


def test_who_switched_compiled_code_off_is_told_how_to_switch_it_on(monkeypatch):
    monkeypatch.setenv(SWITCH, "1")
    monkeypatch.setattr(doctor, "standing", lambda: CodeStanding(frozenset(), f"{SWITCH} is set"))
    assert {finding.name: finding for finding in examine()}["flight code"].remedy == f"unset {SWITCH}"


@pytest.mark.long
def test_the_filters_kernel_is_there_or_how_to_get_it(monkeypatch):
    for spec, presence in ((ModuleSpec(KERNEL, None), Presence.OK), (None, Presence.OPTIONAL)):
        monkeypatch.setattr(doctor, "find_spec", {KERNEL: spec}.get)
        assert {finding.name: finding for finding in examine()}["filter's kernel"].presence is presence


@pytest.mark.parametrize(("findings", "code"), [(FOUND, 0), ([*FOUND, MISSING], 1)])
def test_only_what_flights_need_fails(findings, code, capsys):
    with speaking(Console("doctor")) as console:
        assert report(findings) == code
    assert console.answer["ok"] is (code == 0)
    assert [one["name"] for one in console.answer["findings"]] == [one.name for one in findings]
    assert "type: sudo modprobe vcan" in capsys.readouterr().out


def test_a_quiet_doctor_names_what_is_missing_alone(capsys):
    with speaking(Console("doctor", quiet=True)):
        report([*FOUND, MISSING])
    out = capsys.readouterr().out
    assert "scipy is not installed" in out
    assert "pip install 'torquer'" in out
    assert "vcan" not in out


def test_a_package_that_is_missing_or_old_is_named(monkeypatch):
    wanted = [
        "numpy>=99.0",
        "no-such-thing>=1.0",
        'cryptography>=999; extra == "sign"',
        'no-such-thing>=1.0; extra == "all"',
        'no-such-thing>=2.0; extra == "all"',
        'pytest>=8; extra == "dev"',
    ]
    monkeypatch.setattr("sim.doctor.requires", lambda name: wanted)
    found = {finding.name: finding for finding in examine()}
    assert found["packages"].presence is Presence.MISSING
    assert "is older than 99.0, no-such-thing is not installed" in found["packages"].found
    assert found["torquer[all]"].found == "no-such-thing is not installed", "once"
    assert found["torquer[sign]"].presence is Presence.OPTIONAL
    assert found["torquer[sign]"].remedy == "pip install 'torquer[sign]'"


def test_the_interfaces_of_a_machine(tmp_path):
    for name, kind, flags in (("lo", "772", "0x9"), ("vcan0", "280", "0x40081"), ("can0", "280", "0x40080")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "type").write_text(kind + "\n")
        (tmp_path / name / "flags").write_text(flags + "\n")
    assert can_interfaces(tmp_path) == {"can0": False, "vcan0": True}
    assert can_interfaces(tmp_path / "none") == {}


@pytest.mark.parametrize(
    ("group", "remedy"), [("dialout", "usermod -aG dialout"), (None, "chmod a+rw /dev/")]
)
def test_a_serial_adapter_of_a_group_without_a_name_is_told_all_the_same(monkeypatch, group, remedy):
    def group_of(path):
        if group is None:
            raise KeyError("getgrgid(): gid not found: 986")
        return group

    monkeypatch.setattr(doctor.Path, "glob", lambda path, pattern: iter([Path("/dev/ttyUSB0")]))
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: False)
    monkeypatch.setattr(doctor.Path, "group", group_of)
    (finding,) = doctor._permissions()
    assert (finding.name, finding.presence) == ("ttyUSB0", Presence.OPTIONAL)
    assert remedy in finding.remedy
