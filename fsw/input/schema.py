"""Checked values from TOML: sections, and the sentence that reports their faults."""

import tomllib
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, Strict, ValidationError

from fsw.input.near import did_you_mean, toml_files_near
from fsw.input.toml_text import BoundsError, load_toml

Triple = Annotated[tuple[float, float, float], Strict(False)]
Square = Annotated[tuple[Triple, Triple, Triple], Strict(False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
StepNt = Annotated[float, Field(ge=0.0, le=1e5)]
StepPercent = Annotated[float, Field(ge=0.0, le=100.0)]
StepOfOne = Annotated[float, Field(ge=0.0, le=1.0)]
"""Steps of a quantised reading: no coarser than all that it measures."""

Nested = dict[str, Any]
Model = TypeVar("Model", bound=BaseModel)


class TableError(Exception):
    """A table that cannot be used; the message is one sentence for the user."""


MOST_FAULTS = 12
LONGEST_VALUE = 80
"""Most faults, and most characters of a value, in one sentence: more would be unreadable."""


class Section(BaseModel):
    """A section that accepts only its own keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def merge(base: Nested, over: Nested) -> Nested:
    """``base`` with the values of ``over`` laid over it, section by section."""
    merged = dict(base)
    for key, value in over.items():
        below = merged.get(key)
        merged[key] = merge(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
    return merged


def read_toml(path: Path) -> Nested:
    """The content of a TOML file.

    Raises:
        TableError: the file is missing, unreadable, not TOML or beyond the bounds of ``toml_text``.
    """
    try:
        return load_toml(path)
    except OSError as error:
        files = toml_files_near(path) if isinstance(error, FileNotFoundError) else []
        hint = f"; did you mean {' or '.join(files)}?" if files else ""
        raise TableError(f"{path}: cannot be read ({error.strerror or error}){hint}") from None
    except BoundsError as error:
        raise TableError(f"{path}: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise TableError(f"{path}: not TOML: {error}") from None


def validated(model: type[Model], values: Nested, source: str) -> Model:
    """``values`` as a checked model.

    Raises:
        TableError: one sentence: the source and, for each wrong key, its path and what is allowed.
    """
    try:
        return model.model_validate(values)
    except ValidationError as error:
        raise TableError(f"{source}: {faults(model, error)}") from None


def faults(model: type[Any], error: ValidationError) -> str:
    """The first wrong keys, each with what is allowed, and the number of the others."""
    text = "; ".join(_fault(model, dict(detail)) for detail in islice(error.errors(), MOST_FAULTS))
    others = error.error_count() - MOST_FAULTS
    return f"{text}; and {others} more" if others > 0 else text


def _fault(model: type[Any], detail: Nested) -> str:
    path = ".".join(str(part) for part in detail["loc"])
    if detail["type"] == "extra_forbidden":
        return f"{path} is not a known key{_near_key(model, detail['loc'])}"
    if detail["type"] == "missing":
        return f"{path} is missing"
    if detail["type"] == "union_tag_not_found":
        name = detail["ctx"]["discriminator"].strip("'")
        return f"{path}.{name} is missing"
    if detail["type"] == "union_tag_invalid":
        name, tag = detail["ctx"]["discriminator"].strip("'"), detail["ctx"]["tag"]
        kinds = detail["ctx"]["expected_tags"].replace("'", "").split(", ")
        near = did_you_mean(tag, kinds)
        return f"{path}.{name} = {_shortened(tag)} is not allowed: allowed is one of {', '.join(kinds)}{near}"
    message = str(detail["msg"]).removeprefix("Value error, ")
    if detail["type"] in ("value_error", "json_invalid"):
        return f"{path}: {message}" if path else message
    allowed = _allowed_range(model, detail["loc"]) or _allowed_by(detail["type"], detail.get("ctx", {}))
    hint = f"allowed is {allowed}" if allowed else f"{message[0].lower()}{message[1:]}"
    if detail["type"] == "less_than_equal":
        hint += _unit_asked(str(detail["loc"][-1]), detail["input"], detail["ctx"]["le"])
    if detail["type"] == "literal_error":
        hint += _near_value(model, detail["loc"], detail["input"])
    return f"{path} = {_shortened(detail['input'])} is not allowed: {hint}"


def section_in(annotation: object) -> type[BaseModel] | None:
    """The section that a key of this type holds, also one of a list of them; None for any other value."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(section_in, get_args(annotation))), None)


def words_of(annotation: object) -> tuple[str, ...]:
    """The words that a key of this type may be; none for one that is not a choice of words."""
    if annotation is bool:
        return ("true", "false")
    if get_origin(annotation) is Literal:
        return tuple(str(word) for word in get_args(annotation))
    return next(filter(None, map(words_of, get_args(annotation))), ())


def _owner(model: type[Any], location: tuple[int | str, ...]) -> type[BaseModel] | None:
    """The section that holds the last part of a location; None where a model has no sections."""
    owner: type[BaseModel] | None = model if issubclass(model, BaseModel) else None
    for part in location[:-1]:
        if isinstance(part, str) and owner is not None and part in owner.model_fields:
            owner = section_in(owner.model_fields[part].annotation)
    return owner


def _near_key(model: type[Any], location: tuple[int | str, ...]) -> str:
    owner = _owner(model, location)
    return "" if owner is None else did_you_mean(str(location[-1]), owner.model_fields)


def _near_value(model: type[Any], location: tuple[int | str, ...], given: object) -> str:
    owner = _owner(model, location)
    field = None if owner is None else owner.model_fields.get(str(location[-1]))
    return "" if field is None else did_you_mean(str(given), words_of(field.annotation))


def _unit_asked(key: str, given: float, most: float) -> str:
    """The question after the unit of a number that is far too large and whose thousandth would be allowed."""
    unit = key.rpartition("_")[2]
    is_smaller = unit in _THOUSANDFOLD and 10.0 * most <= given <= 1000.0 * most
    return f"; is it in {unit}?" if is_smaller else ""


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}..."


_THOUSANDFOLD = ("km", "m", "s", "kg")
"""Units that are taken for their thousandth: m, mm, ms, g."""
_KINDS = {
    "model_type": "a section of keys",
    "model_attributes_type": "a section of keys",
    "dict_type": "a section of keys",
    "tuple_type": "a list",
    "string_type": "a text",
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "finite_number": "a finite number",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number at least {ge:g}",
    "less_than": "a number below {lt:g}",
    "less_than_equal": "a number at most {le:g}",
    "literal_error": "{expected}",
    "too_short": "a list of at least {min_length}",
    "too_long": "a list of at most {max_length}",
    "string_pattern_mismatch": "a text that matches {pattern}",
}
"""What a value should have been, by what is wrong with it."""

_BOUNDS = (("gt", "above"), ("ge", "at least"), ("lt", "below"), ("le", "at most"))


def _allowed_by(error_type: str, context: Nested) -> str:
    """What pydantic allows at this place, in our words; empty where it is of another kind."""
    return _KINDS.get(error_type, "").format_map(context)


def _allowed_range(model: type[Any], location: tuple[int | str, ...]) -> str:
    """What a number at this place may be, in words; empty where no bounds are known."""
    if not location:
        return ""
    owner: Any = model
    for part in location[:-1]:
        owner = getattr(getattr(owner, "model_fields", {}).get(part), "annotation", None)
    field: Any = getattr(owner, "model_fields", {}).get(location[-1])
    limits = getattr(field, "metadata", ())
    bounds = {name: getattr(limit, name) for limit in limits for name, _ in _BOUNDS if hasattr(limit, name)}
    if not bounds:
        return ""
    kind = "a whole number" if field.annotation is int else "a number"
    return f"{kind} {' and '.join(f'{word} {bounds[name]:g}' for name, word in _BOUNDS if name in bounds)}"
