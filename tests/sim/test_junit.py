"""Verdicts as JUnit XML."""

from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from sim.errors import HarnessError
from sim.junit import JunitCase, junit_xml, prepare_junit, write_junit
from torquer.cli.main import main

SUITES = {
    "limits": [
        JunitCase("check.limits", "pulse", 1.5),
        JunitCase("check.limits", "gap", failure="99 s < 100 s"),
    ],
    "requirements": [JunitCase("flight", "ape", skipped="one orbit of ten")],
}


def test_suites_count_what_failed_and_what_was_not_judged():
    root = ElementTree.fromstring(junit_xml("torquer check", SUITES))
    assert (root.tag, root.get("name")) == ("testsuites", "torquer check")
    counts = [(one.get("name"), one.get("tests"), one.get("failures"), one.get("skipped")) for one in root]
    assert counts == [("limits", "2", "1", "0"), ("requirements", "1", "0", "1")]
    assert [case.get("time") for case in root[0]] == ["1.500", "0.000"]
    assert root[0][1].find("failure").get("message") == "99 s < 100 s"
    assert root[1][0].find("skipped").get("message") == "one orbit of ten"
    assert list(root[0][0]) == []


def test_evidence_is_in_properties_before_the_failure():
    case = JunitCase("c", "n", failure="x", properties=(("limit", "2.0"), ("unit", "\x1b")))
    (test,) = ElementTree.fromstring(junit_xml("t", {"s": [case]}))[0]
    assert [child.tag for child in test] == ["properties", "failure"]
    assert [dict(one.attrib) for one in test[0]] == [
        {"name": "limit", "value": "2.0"},
        {"name": "unit", "value": "\\x1b"},
    ]


def test_what_xml_cannot_hold_is_escaped():
    text = junit_xml("a\0b", {"s": [JunitCase("c", "<n>\udcff", failure='\x1b & "x"')]})
    root = ElementTree.fromstring(text)
    assert root.get("name") == "a\\x00b"
    assert root[0][0].get("name") == "<n>\\udcff"
    assert root[0][0][0].get("message") == '\\x1b & "x"'


def test_a_file_that_cannot_be_written_is_one_sentence(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(HarnessError, match="cannot be written"):
        write_junit(tmp_path / "file" / "x.xml", "x", SUITES)


@pytest.mark.parametrize(
    "other",
    ["name = 'microsat'\n", "(1.0) can0 180#00\n", "<!DOCTYPE html>\n", "<?xml version='1.0'?><svg/>", "\0"],
    ids=["scenario", "log", "page", "other XML", "binary"],
)
def test_a_file_that_is_no_junit_file_is_neither_removed_nor_replaced(tmp_path, other):
    path = tmp_path / "x"
    path.write_text(other)
    for refused in (lambda: prepare_junit(path), lambda: write_junit(path, "x", SUITES)):
        with pytest.raises(HarnessError) as error:
            refused()
        assert str(error.value) == f"--junit {path}: is no JUnit file, and is not replaced"
    assert path.read_text() == other


@pytest.mark.parametrize(
    "before",
    [
        junit_xml("before", SUITES),
        '\ufeff<?xml version="1.0"?>\n<!-- of another tool -->\n<testsuite name="x"/>',
        "<testsuites/>",
        "",
    ],
    ids=["own", "of another tool", "bare", "empty"],
)
def test_a_junit_file_of_before_is_gone_as_soon_as_the_command_begins(tmp_path, before):
    """So a command that ends early leaves no verdict of another one."""
    path = tmp_path / "x.xml"
    path.write_text(before, encoding="utf-8")
    prepare_junit(path)
    assert not path.exists()
    write_junit(path, "after", SUITES)
    assert ElementTree.parse(path).getroot().get("name") == "after"
    assert [one.name for one in tmp_path.iterdir()] == ["x.xml"]
    write_junit(path, "again", SUITES)
    assert ElementTree.parse(path).getroot().get("name") == "again"


def test_without_a_file_nothing_is_done():
    prepare_junit(None)
    write_junit(None, "x", SUITES)


def test_a_command_that_ends_early_leaves_no_verdict_of_before(tmp_path):
    path = tmp_path / "x.xml"
    path.write_text(junit_xml("before", {"limits": [JunitCase("check.limits", "pulse")]}))
    result = CliRunner().invoke(main, ["check", str(tmp_path / "none"), "--junit", str(path)])
    assert result.exit_code == 2
    assert not path.exists()


def test_nor_does_one_replace_what_it_reads(tmp_path):
    log = tmp_path / "bus.log"
    log.write_text("(1.000000) can0 180#00\n")
    result = CliRunner().invoke(main, ["check", str(log), "--junit", str(log)])
    assert result.exit_code == 2
    assert f"--junit {log}: is no JUnit file, and is not replaced" in result.stderr
    assert log.read_text() == "(1.000000) can0 180#00\n"
