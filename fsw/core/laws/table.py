"""The laws that fly, by name: far from the goal and near it."""

from typing import NamedTuple

from fsw.core.laws.damping import bdot, rate_damping
from fsw.core.laws.interface import Law
from fsw.core.laws.pd import pd, pd_far
from fsw.core.laws.predictive import predictive


class Row(NamedTuple):
    """A law: its number in telecommands, what ACQUIRE and POINT fly, and the class of its own parameters.

    That class is a frozen dataclass of floats with defaults, or None for a law with none.
    """

    number: int
    acquire: Law
    point: Law
    gains: type | None = None


LAWS: dict[str, Row] = {
    "pd": Row(0, pd_far, pd),
    "rate_damping": Row(1, rate_damping, rate_damping),
    "bdot": Row(2, bdot, bdot),
    "predictive": Row(3, predictive, predictive),
}
