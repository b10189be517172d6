"""Verdicts as JUnit XML."""

from xml.etree import ElementTree

import pytest

from sim.errors import HarnessError
from sim.junit import JunitCase, junit_xml, write_junit

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
