"""Parameters of the user's own code: a frozen dataclass of numbers, with units and ranges, set by a table."""

from collections.abc import Mapping
from dataclasses import MISSING, Field, field, fields, is_dataclass
from math import inf, isfinite
from typing import Any, NamedTuple, TypeGuard

from fsw.input.own_code import error_clause
from fsw.input.schema import TableError

_KEY = "torquer"


class _Range(NamedTuple):
    unit: str = ""
    least: float = -inf
    most: float = inf

    def __str__(self) -> str:
        """The range in words."""
        bounds = [f"at least {self.least:g}"] if self.least > -inf else []
        bounds += [f"at most {self.most:g}"] if self.most < inf else []
        return " ".join(["a finite number", *[" and ".join(bounds)][: len(bounds)], self.unit]).rstrip()


def quantity(default: float, unit: str = "", least: float = -inf, most: float = inf) -> Any:  # noqa: ANN401  (as dataclasses.field)
    """A field of a dataclass of parameters: its default, its unit, and the range that a table may set."""
    return field(default=default, metadata={_KEY: _Range(unit, least, most)})


def with_values(kind: type[Any], given: Mapping[str, object], key: str, source: str) -> Any:  # noqa: ANN401  (of that kind)
    """An instance with the given values, the others being its defaults.

    Args:
        kind: a frozen dataclass of numbers with defaults.
        given: values by field.
        key: of the section that gives them, for messages.
        source: of the dataclass, for messages.

    Raises:
        TableError: it is not such a dataclass, or a key or value is not allowed.
    """
    known = _fields(kind, source)
    for name, value in given.items():
        if name not in known:
            allowed = ", ".join(known) or "none"
            raise TableError(f"{source}: {key}.{name} is not a known key (allowed: {allowed})")
        allowed_range = known[name].metadata.get(_KEY, _Range())
        if not _is_number(value) or not allowed_range.least <= value <= allowed_range.most:
            raise TableError(f"{source}: {key}.{name} = {value!r} is not allowed: allowed is {allowed_range}")
    try:
        return kind(**{name: float(value) for name, value in given.items() if _is_number(value)})
    except (Exception, SystemExit) as error:  # of its own __post_init__
        raise TableError(f"{source}: {key}: {error_clause(error)}") from None


def _fields(kind: type[Any], source: str) -> dict[str, Field[Any]]:
    """The fields by name.

    Raises:
        TableError: it is not a frozen dataclass of numbers with defaults, or a default is out of its range.
    """
    if not isinstance(kind, type) or not is_dataclass(kind) or not kind.__dataclass_params__.frozen:  # type: ignore[attr-defined]  # missing from typeshed
        raise TableError(f"{source}: {getattr(kind, '__name__', kind)!s:.80} is no frozen dataclass")
    found = {each.name: each for each in fields(kind) if each.init}
    for name, each in found.items():
        allowed = each.metadata.get(_KEY, _Range())
        default = None if each.default is MISSING else each.default
        if not _is_number(default) or not allowed.least <= default <= allowed.most:
            raise TableError(
                f"{source}: {kind.__name__}.{name} has the default {default!r}: it must be {allowed}"
            )
    return found


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
