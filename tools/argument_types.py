"""Types of arguments, for argparse: a number that is not possible ends with a sentence and exit code 2."""

from argparse import ArgumentTypeError
from math import inf


def count(text: str) -> int:
    """A whole number, 1 or more."""
    if text.isascii() and text.isdigit() and int(text):
        return int(text)
    raise ArgumentTypeError(f"{text!r} is no whole number from 1")


def positive(text: str) -> float:
    """A finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if 0.0 < value < inf:
        return value
    raise ArgumentTypeError(f"{text!r} is no number above 0")
