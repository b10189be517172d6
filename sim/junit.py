"""Verdicts as JUnit XML, which CI servers read."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replace_file

_HEAD_BYTES = 4096
"""Of a JUnit file, in which its first element begins."""
_ALLOWED_CONTROLS = "\t\n\r"


class JunitCase(NamedTuple):
    """One verdict: it holds where there is neither a failure nor a reason why it was not judged.

    Attributes:
        classname: what it belongs to, with dots.
        name: unique there.
        wall_s: how long it took, s.
        failure: why it failed; empty where it did not.
        skipped: why it was not judged; empty where it was.
        properties: the evidence, names and values.
    """

    classname: str
    name: str
    wall_s: float = 0.0
    failure: str = ""
    skipped: str = ""
    properties: Sequence[tuple[str, str]] = ()


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
    """Check that a file can be written, and remove one of before; None: none is asked for.

    Done before anything is computed, so that a command that ends early leaves no verdicts of another one.

    Raises:
        HarnessError: it cannot be written, or the file that is there is no JUnit file.
    """
    if path is None:
        return
    check_file(path)
    _check_replaceable(path)
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise _not_written(path, error) from None


def write_junit(path: Path | None, name: str, suites: Mapping[str, Sequence[JunitCase]]) -> None:
    """Write the document at once, if a file is asked for.

    Raises:
        HarnessError: it cannot be written, or the file that is there is no JUnit file.
    """
    if path is None:
        return
    _check_replaceable(path)
    try:
        replace_file(path, junit_xml(name, suites).encode())
    except OSError as error:
        raise _not_written(path, error) from None


def _check_replaceable(path: Path) -> None:
    """Check that what is there, if anything, is a JUnit file or empty: it might be what the command reads."""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES).removeprefix(b"\xef\xbb\xbf").lstrip()
    except FileNotFoundError:
        return
    except OSError as error:
        raise _not_written(path, error) from None
    is_junit = head.startswith((b"<?xml", b"<testsuite")) and b"<testsuite" in head
    if head and not is_junit:
        raise HarnessError(f"--junit {path}: is no JUnit file, and is not replaced")


def _not_written(path: Path, error: OSError) -> HarnessError:
    return HarnessError(f"{path}: cannot be written ({error.strerror})")


def _add(suite: ElementTree.Element, case: JunitCase) -> None:
    test = ElementTree.SubElement(
        suite, "testcase", classname=_text(case.classname), name=_text(case.name), time=f"{case.wall_s:.3f}"
    )
    if case.properties:
        evidence = ElementTree.SubElement(test, "properties")
        for name, value in case.properties:
            ElementTree.SubElement(evidence, "property", name=_text(name), value=_text(value))
    for tag, message in (("failure", case.failure), ("skipped", case.skipped)):
        if message:
            ElementTree.SubElement(test, tag, message=_text(message))


def _text(text: str) -> str:
    """The same without what XML cannot hold: control characters and lone surrogates."""
    return "".join(
        char if char.isprintable() or char in _ALLOWED_CONTROLS else repr(char)[1:-1] for char in text
    )
