"""Verdicts as JUnit XML, which CI servers read."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from sim.errors import HarnessError
from sim.record.destination import check_file

_ALLOWED_CONTROLS = "\t\n\r"


class JunitCase(NamedTuple):
    """One verdict: it holds where there is neither a failure nor a reason why it was not judged.

    Attributes:
        classname: what it belongs to, with dots.
        name: unique there.
        wall_s: how long it took, s.
        failure: why it failed; empty where it did not.
        skipped: why it was not judged; empty where it was.
    """

    classname: str
    name: str
    wall_s: float = 0.0
    failure: str = ""
    skipped: str = ""


def junit_xml(name: str, suites: Mapping[str, Sequence[JunitCase]]) -> str:
    """The document: the suites by their names."""
    root = ElementTree.Element("testsuites", name=_text(name))
    for title, cases in suites.items():
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=_text(title),
            tests=str(len(cases)),
            failures=str(sum(bool(case.failure) for case in cases)),
            skipped=str(sum(bool(case.skipped) for case in cases)),
            time=f"{sum(case.wall_s for case in cases):.3f}",
        )
        for case in cases:
            _add(suite, case)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True)


def prepare_junit(path: Path | None) -> None:
    """Check that a file can be written, before anything is computed; None: none is asked for.

    Raises:
        HarnessError: it cannot be written.
    """
    if path is not None:
        check_file(path)


def write_junit(path: Path | None, name: str, suites: Mapping[str, Sequence[JunitCase]]) -> None:
    """Write the document, if a file is asked for.

    Raises:
        HarnessError: the file cannot be written.
    """
    if path is None:
        return
    try:
        path.write_text(junit_xml(name, suites), encoding="utf-8")
    except OSError as error:
        raise HarnessError(f"{path}: cannot be written ({error.strerror})") from None


def _add(suite: ElementTree.Element, case: JunitCase) -> None:
    test = ElementTree.SubElement(
        suite, "testcase", classname=_text(case.classname), name=_text(case.name), time=f"{case.wall_s:.3f}"
    )
    for tag, message in (("failure", case.failure), ("skipped", case.skipped)):
        if message:
            ElementTree.SubElement(test, tag, message=_text(message))


def _text(text: str) -> str:
    """The same without what XML cannot hold: control characters and lone surrogates."""
    return "".join(
        char if char.isprintable() or char in _ALLOWED_CONTROLS else repr(char)[1:-1] for char in text
    )
