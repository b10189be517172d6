"""The gains of a law that are free: which, and between what limits they are searched.

The common gains are searched over the span of ``torquer design``, in multiples of the body's natural ones,
and only where the law uses them. A law's own gain is free, from a tenth to ten times its default, if that is
positive and the gain is not an axis, a target, an angle, a horizon or a number of iterations.
"""

from collections.abc import Sequence
from dataclasses import fields
from typing import NamedTuple

from fsw.core.laws.table import LAWS
from fsw.input.schema import Nested
from sim.design.from_scenario import body_of
from sim.design.theory.search import SPAN_A, SPAN_W, natural_gains
from sim.scenario.schema import Scenario

OWN_SPAN = (0.1, 10.0)
"""Limits of the search of a law's own gain, in multiples of its default."""
MEANINGS = ("axis", "target", "pitch", "level", "rounds", "horizon", "iterations")
"""Own gains whose names begin so say what is wanted, or how much a law may compute: they are not searched."""


class FreeGain(NamedTuple):
    """A gain: its key in ``[control]``, dotted, and the limits of its search, both positive."""

    key: str
    low: float
    high: float


def common_gains(scenario: Scenario) -> tuple[FreeGain, ...]:
    """k_w and k_a for the body of a scenario."""
    natural = natural_gains(body_of(scenario))
    k_w, k_a = float(natural.k_w), float(natural.k_a)
    return (
        FreeGain("k_w", SPAN_W[0] * k_w, SPAN_W[1] * k_w),
        FreeGain("k_a", SPAN_A[0] * k_a, SPAN_A[1] * k_a),
    )


def own_gains(law: str) -> tuple[FreeGain, ...]:
    """Those of a law of the table that are its alone."""
    kind = LAWS[law].gains
    if kind is None:
        return ()
    defaults = kind()
    free = []
    for field in fields(kind):
        value = float(getattr(defaults, field.name))
        if value > 0.0 and not field.name.startswith(MEANINGS):
            free.append(FreeGain(f"gains.{law}.{field.name}", OWN_SPAN[0] * value, OWN_SPAN[1] * value))
    return tuple(free)


def as_control(free: Sequence[FreeGain], values: Sequence[float]) -> Nested:
    """The keys of ``[control]`` with these values."""
    control: Nested = {}
    for gain, value in zip(free, values, strict=True):
        *sections, name = gain.key.split(".")
        place = control
        for section in sections:
            place = place.setdefault(section, {})
        place[name] = float(f"{value:.6g}")
    return control


def flat(control: Nested) -> dict[str, float]:
    """The gains of ``[control]`` by their whole keys."""
    gains: dict[str, float] = {}
    for key, value in control.items():
        if isinstance(value, dict):
            gains |= {f"{key}.{name}": one for name, one in flat(value).items()}
        else:
            gains[key] = value
    return gains
