"""Gains into a scenario file: two values of ``[control]`` change, every other byte stays."""

import os
import re
import shutil
import tomllib
from pathlib import Path

from sim.design.linear import Gains
from sim.harness.errors import HarnessError

DIGITS = 9
"""Significant digits of a gain: beside a kink the sixth still shows in the degree of stability."""

_KEYS = ("k_w", "k_a")
_HEADER = re.compile(r"^\s*\[+\s*(?P<name>[^\]]+?)\s*\]+")
_VALUE = re.compile(
    r"^(?P<key>\s*(?:control\s*\.\s*)?(?P<name>k_w|k_a)\s*=\s*)(?P<value>[^\s#]+)(?P<rest>.*)$", re.S
)


def check_writable(scenario: str) -> Path:
    """The file that gains can be written to.

    Raises:
        HarnessError: the scenario is one that ships, given by its name.
    """
    if not scenario.endswith(".toml"):
        raise HarnessError(
            f"--write {scenario}: gains are not written into a scenario that ships; copy it into a file and "
            f"give the path, which ends in .toml"
        )
    return Path(scenario)


def write_gains(path: Path, gains: Gains) -> None:
    """Replace control.k_w and control.k_a in a scenario file, atomically.

    Raises:
        HarnessError: the file cannot be read or written, or does not give both keys a line of their own.
    """
    values = {key: _written(gain) for key, gain in zip(_KEYS, gains, strict=False)}
    try:
        before = path.read_bytes().decode("utf-8")
        after = _with_values(before, values)
        if after is None:
            wanted = ", ".join(f"{key} = {value}" for key, value in values.items())
            raise HarnessError(f"{path}: [control] does not give k_w and k_a a line each; write {wanted}")
        _replace(path.resolve(), after)
    except OSError as error:
        raise HarnessError(f"{path}: cannot be written ({error.strerror or error})") from None


def _with_values(text: str, values: dict[str, str]) -> str | None:
    """The text with other values; None if that would not change just them."""
    lines, section = text.splitlines(keepends=True), ""
    for place, line in enumerate(lines):
        if header := _HEADER.match(line):
            section = header["name"]
        found = _VALUE.match(line)
        if found and (section == "control" or (section == "" and "control" in found["key"])):
            lines[place] = found["key"] + values[found["name"]] + found["rest"]
    after = "".join(lines)
    wanted = tomllib.loads(text)
    wanted["control"] = {**wanted.get("control", {}), **{key: float(value) for key, value in values.items()}}
    return after if tomllib.loads(after) == wanted else None


def _written(gain: object) -> str:
    return repr(float(f"{gain:.{DIGITS}g}"))


def _replace(path: Path, text: str) -> None:
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(text.encode("utf-8"))
        shutil.copymode(path, temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
