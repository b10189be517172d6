"""Random legal scenarios: those that ship, with values from anywhere in the schema laid over them.

Every scenario depends on its number alone. What the schema refuses is drawn again, so that all are legal.
"""

import types
from collections.abc import Callable, Iterator
from random import Random
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from fsw.core.laws.table import LAWS
from fsw.input.schema import Nested, TableError
from fsw.table.table import FlightTable
from sim.faults.kinds import KINDS
from sim.scenario.requirements import INDICES
from sim.scenario.schema import Scenario, load, orbit_period_s, scenario_of, shipped_names
from sim.scenario.telecommands import Telecommand
from sim.scenario.written import values_of

Scalar = Callable[[Random, Any, Any], Any]
"""Draws a value: from a stream, within limits, near the value that is there."""
NOT_DRAWN = (
    "name", "summary", "effect", "control.law_sha256", "control.law_withheld", "control.gains", "orbit.tle",
    "telecommand", "fault", "requirement", "flight", "time.orbits",
)  # fmt: skip
"""Keys that name files or are drawn as a whole."""
RATES_HZ = (1, 1, 1, 2, 3, 4, 5, 7, 10)
MOST_TICKS = 12_000
"""Of a flight: one at a high rate is of fewer orbits."""
SCALES = (1e-6, 1e-3, 0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 10.0, 1e3)
"""Factors of a value that is there."""
EXTREMES = (0.0, 1e-18, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e15)


def legal_scenario(number: int) -> tuple[Scenario, float]:
    """A scenario, and the orbits for which it is to be flown."""
    rng = Random(f"scenario {number}")
    name = rng.choice(shipped_names())
    values = values_of(load(name))
    orbits = rng.choice((0.3, 1.0, 1.5, 2.0))
    wanted = [
        {"time": {"tick_hz": rng.choice(RATES_HZ)}},
        *(_one_key(rng, Scenario, values) for _ in range(rng.randrange(1, 10))),
        *({"flight": _one_key(rng, FlightTable, {})} for _ in range(rng.randrange(4))),
        {"control": {"law": rng.choice([*LAWS])}} if rng.random() < 0.6 else {},
        *_lists(rng, orbits),
    ]
    for over in wanted:
        try:
            values = values_of(scenario_of(values, name, over))
        except TableError:
            continue
    scenario = scenario_of(values, f"scenario {number} of {name}")
    ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    return scenario, min(orbits, MOST_TICKS / ticks_per_orbit)


def _lists(rng: Random, orbits: float) -> Iterator[Nested]:
    """Telecommands, faults and requirements, each list as a whole."""
    if rng.random() < 0.3:
        models = get_args(get_args(Telecommand)[0])
        yield {"telecommand": [_section(rng, rng.choice(models), {}) for _ in range(rng.randrange(1, 5))]}
    if rng.random() < 0.2:
        yield {"fault": [_fault(rng) for _ in range(rng.randrange(1, 3))]}
    if rng.random() < 0.3:
        law = rng.choice([law for law, row in LAWS.items() if row.gains is not None])
        names = list(LAWS[law].gains.__dataclass_fields__)  # type: ignore[union-attr]  # chosen so
        yield {"control": {"gains": {law: {rng.choice(names): _number(rng, 1.0)}}}}
    for _ in range(4):
        yield {"requirement": [_requirement(rng, orbits) for _ in range(rng.randrange(1, 4))]}


def _fault(rng: Random) -> Nested:
    kind = rng.choice([name for name, kind in KINDS.items() if kind.in_plant])
    parameters = {
        name: rng.choice((one.low, one.high, one.default, rng.uniform(one.low, one.high)))
        for name, one in KINDS[kind].parameters.items()
        if rng.random() < 0.5
    }
    return {
        "kind": kind,
        "at_s": rng.choice((0.0, rng.uniform(0.0, 6000.0))),
        **({"lasts_s": rng.uniform(0.1, 3000.0)} if rng.random() < 0.7 else {}),
        "parameters": parameters,
    }


def _requirement(rng: Random, orbits: float) -> Nested:
    """One that a flight of so many orbits is long enough for, and may meet."""
    index = rng.choice([*INDICES])
    row = INDICES[index]
    what = rng.choice((None, *row.of))
    unit = "at_most_degps" if what == "spin" and row.unit.key == "at_most_deg" else row.unit.key
    by_orbit = rng.uniform(0.05, 1.0) * orbits
    found: Nested = {
        "index": index,
        unit: by_orbit * rng.uniform(0.2, 1.0) if index == "settling" else 10.0 ** rng.uniform(-2.0, 2.3),
        "by_orbit": by_orbit,
        "last_orbits": by_orbit * rng.uniform(0.05, 1.0),
    }
    if what is not None:
        found["what"] = what
    if row.chosen:
        found["window"] = rng.choice(("last_orbits", "settled"))
        found["sunlit"] = index not in ("mpe", "rpe") and rng.random() < 0.3
        if rng.random() < 0.5:
            found["probability"] = rng.choice((1.0, 0.95, rng.uniform(0.01, 1.0)))
    found["settled_deg"] = 10.0 ** rng.uniform(-1.0, 2.0)
    return found


def _one_key(rng: Random, model: type[BaseModel], values: Nested) -> Nested:
    """A value for one key of a model or of one of its sections, nested as in a file."""
    keys = [*_keys(model, "")]
    key, field = rng.choice(keys)
    present: Any = values
    for part in key.split("."):
        present = present.get(part) if isinstance(present, dict) else None
    value: Any = _value(rng, field.annotation, field.metadata, present)
    for part in reversed(key.split(".")):
        value = {part: value}
    found: Nested = value
    return found


def _keys(model: type[BaseModel], prefix: str) -> Iterator[tuple[str, FieldInfo]]:
    for name, field in model.model_fields.items():
        key = f"{prefix}{name}"
        if key in NOT_DRAWN:
            continue
        section = field.annotation
        if isinstance(section, type) and issubclass(section, BaseModel):
            yield from _keys(section, f"{key}.")
        else:
            yield key, field


def _section(rng: Random, model: type[BaseModel], present: Any) -> Nested:  # noqa: ANN401  (any value of TOML)
    """All required keys of a section, and some of the others."""
    given = present if isinstance(present, dict) else {}
    return dict(given) | {
        name: _value(rng, field.annotation, field.metadata, given.get(name))
        for name, field in model.model_fields.items()
        if (field.is_required() and name not in given) or rng.random() < 0.3
    }


def _value(rng: Random, kind: Any, limits: Any, present: Any) -> Any:  # noqa: ANN401  (any type of a schema)
    """A value of a type; most often a legal one."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _value(rng, inner[0], (*limits, *inner[1:]), present)
    if origin in (Union, types.UnionType):
        choices = [one for one in inner if one is not type(None)]
        return _value(rng, rng.choice(choices), limits, present)
    if origin is Literal:
        return rng.choice(inner)
    if origin is tuple:
        return _list(rng, inner, limits, present)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return _section(rng, kind, present)
    scalar: Scalar = _SCALARS.get(kind, _text)
    return scalar(rng, limits, present)


def _list(rng: Random, inner: Any, limits: Any, present: Any) -> list[Any]:  # noqa: ANN401  (any type of a schema)
    if inner[-1] is Ellipsis:
        return [_value(rng, inner[0], (), None) for _ in range(rng.randrange(1, 6))]
    given = present if isinstance(present, list) and len(present) == len(inner) else [None] * len(inner)
    return [_value(rng, one, limits, before) for one, before in zip(inner, given, strict=True)]


def _number(rng: Random, present: float) -> float:
    """A number near the one that is there, or far from it, of either sign."""
    return rng.choice((1.0, 1.0, 1.0, -1.0)) * present * rng.choice(SCALES) * rng.uniform(0.5, 2.0)


def _float(rng: Random, limits: Any, present: Any) -> float:  # noqa: ANN401  (any limits of pydantic)
    low, high = _bounds(limits)
    if low is not None and high is not None and rng.random() < 0.6:
        return rng.choice((low, high, rng.uniform(low, high), rng.uniform(low, high)))
    if isinstance(present, int | float) and not isinstance(present, bool) and present and rng.random() < 0.8:
        return _number(rng, float(present))
    sign = 1.0 if low is not None else rng.choice((1.0, -1.0))
    return sign * (rng.choice(EXTREMES) if rng.random() < 0.2 else 10.0 ** rng.uniform(-9.0, 3.0))


def _int(rng: Random, limits: Any, present: Any) -> int:  # noqa: ANN401  (as _float)
    low, high = _bounds(limits)
    least = round(low or 0)
    return rng.randint(least, round(high) if high is not None else least + 100)


def _bool(rng: Random, limits: Any, present: Any) -> bool:  # noqa: ANN401  (as _float)
    return rng.random() < 0.5


def _text(rng: Random, limits: Any, present: Any) -> str:  # noqa: ANN401  (as _float)
    """A law or a time: the only texts that are drawn."""
    if rng.random() < 0.5:
        return f"{rng.randint(2015, 2029)}-{rng.randint(1, 12):02}-{rng.randint(1, 28):02}T12:00:00Z"
    return rng.choice([*LAWS])


_SCALARS: dict[Any, Scalar] = {float: _float, int: _int, bool: _bool}


def _bounds(limits: Any) -> tuple[float | None, float | None]:  # noqa: ANN401  (any limits of pydantic)
    low = high = None
    for one in limits:
        for part in getattr(one, "metadata", None) or (one,):
            low = next(filter(_is_given, (getattr(part, "ge", None), getattr(part, "gt", None))), low)
            high = next(filter(_is_given, (getattr(part, "le", None), getattr(part, "lt", None))), high)
    return low, high


def _is_given(limit: float | None) -> bool:
    return limit is not None
