"""Write gains into a scenario file: two values of ``[control]`` change, every other byte stays."""

import re
import shutil
import tomllib
from pathlib import Path

from fsw.input.text_file import read_text
from fsw.input.toml_text import MOST_BYTES, BoundsError, parse_toml
from sim.design.theory.linear import Gains, Number
from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replacing

DIGITS = 9
"""Significant digits of a gain: beside a kink the sixth still shows in the degree of stability."""

_HEADER = re.compile(r"^\s*\[+(?P<name>[^\[\]]+)\]")
_VALUE = re.compile(
    r"^(?P<key>\s*(?:control\s*\.\s*)?(?P<name>k_w|k_a)\s*=\s*)(?P<value>[^\s#]+)(?P<rest>.*)$", re.S
)


def check_writable(scenario: str) -> Path:
    """The file that gains can be written to; checked before anything is computed.

    Raises:
        HarnessError: the scenario is one that ships, given by its name, or as for ``write_gains``.
    """
    if not scenario.endswith(".toml"):
        raise HarnessError(
            f"--write {scenario}: gains are not written into a scenario that ships; copy it into a file and "
            f"give the path, which ends in .toml"
        )
    path = Path(scenario)
    _edited(path, Gains(1.0, 1.0))
    check_file(path.resolve())
    return path


def write_gains(path: Path, gains: Gains) -> None:
    """Replace control.k_w and control.k_a in a scenario file, atomically.

    Raises:
        HarnessError: the file cannot be read or written, or does not give both keys a line of their own.
    """
    after = _edited(path, gains)
    try:
        _replace(path.resolve(), after)
    except OSError as error:
        raise HarnessError(f"{path}: cannot be written ({error.strerror or error})") from None


def _edited(path: Path, gains: Gains) -> str:
    values = {"k_w": _gain_text(gains.k_w), "k_a": _gain_text(gains.k_a)}
    try:
        after = _with_values(read_text(path, MOST_BYTES), values)
    except OSError as error:
        raise HarnessError(f"{path}: cannot be read ({error.strerror or error})") from None
    except BoundsError as error:
        raise HarnessError(f"{path}: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise HarnessError(f"{path}: not TOML: {error}") from None
    if after is None:
        raise HarnessError(f"{path}: gains can be written only where [control] gives k_w and k_a a line each")
    return after


def _with_values(text: str, values: dict[str, str]) -> str | None:
    """The text with other values; None if that would not change just them."""
    lines, section = text.splitlines(keepends=True), ""
    for place, line in enumerate(lines):
        if header := _HEADER.match(line):
            section = header["name"].strip()
        found = _VALUE.match(line)
        if found and (section == "control" or (section == "" and "control" in found["key"])):
            lines[place] = found["key"] + values[found["name"]] + found["rest"]
    after = "".join(lines)
    wanted = parse_toml(text)
    control = wanted.get("control")
    if not isinstance(control, dict):
        return None
    wanted["control"] = {**control, **{key: float(value) for key, value in values.items()}}
    return after if tomllib.loads(after) == wanted else None


def _gain_text(gain: Number) -> str:
    return repr(float(f"{float(gain):.{DIGITS}g}"))


def _replace(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8"))
        shutil.copymode(path, temporary)
