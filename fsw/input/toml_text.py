"""TOML within bounds: in size, in depth and in the magnitude of its numbers.

Python's own reader has no bounds: nesting exhausts its stack, a long key takes hours, an integer may have any
number of digits. What no scenario, table or script needs is refused before anything is computed with it.
"""

import re
import tomllib
import unicodedata
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any

from fsw.input.text_file import read_text

MOST_BYTES = 1_000_000
MOST_LEVELS = 32
"""Of nested tables and lists."""
LEAST, MOST = 1e-18, 1e15
"""Bounds of the magnitude of every number but 0, in the units of the file."""
ROUNDING = 1e-15
"""An element of a list below ``LEAST`` and below this part of the largest is what rounding has left of 0."""

# Each piece takes something, and a text without an end all to the end of its line or of the document. So that
# is read once, whatever is in it, and what stands in a text or a comment is no key.
_PIECE = re.compile(
    r"""\"{3}(?:[^"\\]|\\.|"(?!""))*(?:"{3,5}|\\?\Z)|'{3}(?:[^']|'(?!''))*(?:'{3,5}|\Z)|\#[^\n]*"""
    r"""|(?P<part>[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\[^\n])*"?|'[^'\n]*'?)|(?P<dot>\.)|(?P<blank>[ \t]+)|.""",
    re.DOTALL,
)


class BoundsError(ValueError):
    """TOML beyond the bounds; the message is a clause that says which."""


def load_toml(path: Path) -> dict[str, Any]:
    """The content of a TOML file.

    Raises:
        OSError: it cannot be read, is larger than ``MOST_BYTES`` or no text.
        ValueError: as for ``parse_toml``.
    """
    return parse_toml(read_text(path, MOST_BYTES))


def parse_toml(text: str) -> dict[str, Any]:
    """The values of a TOML document.

    Raises:
        TOMLDecodeError: the text is not TOML.
        BoundsError: it is nested deeper than ``MOST_LEVELS``, or a number is outside ``LEAST`` to ``MOST``.
    """
    if _longest_key(text) > MOST_LEVELS:
        raise BoundsError(f"a key has more than {MOST_LEVELS} parts")
    try:
        values = tomllib.loads(text)
    except RecursionError:
        raise BoundsError(_TOO_DEEP) from None
    except tomllib.TOMLDecodeError as error:
        raise tomllib.TOMLDecodeError(f"{error}{_odd_letter(text, str(error))}") from None
    except ValueError:  # of int(), which counts digits
        raise BoundsError(f"an integer is {_BEYOND}") from None
    return bounded(values)


def bounded(values: dict[str, Any]) -> dict[str, Any]:
    """The values, in which what rounding has left of a zero in a vector or a matrix is zero.

    The same bounds hold for what is read from a file and what a program gives.

    Raises:
        BoundsError: as for ``parse_toml``.
    """
    return {key: _bounded(value, key, 1, 0.0) for key, value in values.items()}


def _odd_letter(text: str, message: str) -> str:
    """A clause that names the character at the place of an error where a reader cannot see what it is."""
    place = re.search(r"at line (\d+), column (\d+)", message)
    if place is None:
        return ""
    letter = text.split("\n")[int(place[1]) - 1][int(place[2]) - 1 :][:1]
    if letter.isascii():
        return ""
    name = unicodedata.name(letter, "a character without a name").lower()
    return f": U+{ord(letter):04X}, {name}, stands there"


def _longest_key(text: str) -> int:
    """The most parts with dots between them."""
    longest = parts = 0
    dotted = False
    for piece in _PIECE.finditer(text):
        match piece.lastgroup:
            case "part":
                parts, dotted = (parts + 1 if dotted else 1), False
                longest = max(longest, parts)
            case "dot":
                dotted = True
            case None:
                parts, dotted = 0, False
    return longest


_TOO_DEEP = f"it is nested deeper than {MOST_LEVELS} levels"
_BEYOND = f"not allowed: a number is 0, or from {LEAST:g} to {MOST:g} in magnitude"


def _bounded(value: Any, key: str, level: int, largest: float) -> Any:  # noqa: ANN401  (any value of TOML)
    """A value within the bounds; infinity and NaN are left to the schema.

    ``largest``: the greatest magnitude in the list, or the list of lists, that the value is in.
    """
    if level > MOST_LEVELS:
        raise BoundsError(_TOO_DEEP)
    if isinstance(value, dict):
        return {name: _bounded(below, f"{key}.{name}", level + 1, 0.0) for name, below in value.items()}
    if isinstance(value, list | tuple):
        largest = largest or _largest(value)
        return [_bounded(below, f"{key}.{place}", level + 1, largest) for place, below in enumerate(value)]
    if not isinstance(value, int | float):
        return value
    if 0 < abs(value) < LEAST and abs(value) <= ROUNDING * largest:
        return 0.0
    if 0 < abs(value) < LEAST or MOST < abs(value) < inf:
        raise BoundsError(f"{key} is {_BEYOND}")
    return value


def _largest(values: Sequence[Any]) -> float:
    """The largest magnitude of the numbers in a list, or in a list of lists."""
    rows = [one if isinstance(one, list | tuple) else (one,) for one in values]
    return max((abs(one) for row in rows for one in row if isinstance(one, int | float)), default=0.0)
