"""A state as bytes, and copied: every field of every part finds its own way, so that none can be left out.

What each class consists of is looked up once. Its fields count in alphabetical order, an array by its shape
and numbers, whatever its layout in memory, a member of an enumeration by its value. The bytes are those of
``marshal`` in version 2, which depend on values and types alone.
"""

import marshal
from collections.abc import Callable
from dataclasses import is_dataclass
from enum import Enum
from functools import cache
from operator import attrgetter, is_
from types import UnionType
from typing import Any, Final, TypeVar, Union, final, get_args, get_origin, get_type_hints

import numpy as np

_MARSHAL_VERSION: Final = 2
"""Without references to earlier objects: equal values are equal bytes, shared or not."""

State = TypeVar("State")

_LEAVES: Final = frozenset({type(None), bool, int, float, str})


def pack(state: object) -> bytes:
    """The bytes of a state: two that differ in any field differ in them.

    Args:
        state: of objects, tuples, lists, arrays, numbers, texts.

    Raises:
        TypeError: a field holds something else; names it.
    """
    return marshal.dumps(_take_apart(state), _MARSHAL_VERSION)


@final
class _Plan:
    """How values of one class are taken apart.

    ``parts`` gives them in the order of ``names``; ``nested`` are the places of those that may consist of
    parts themselves. Without names ``parts`` gives what stands for the value. ``in_place``: they are changed.
    """

    __slots__ = ("in_place", "names", "nested", "parts")

    def __init__(
        self,
        parts: Callable[[Any], Any],
        names: tuple[str, ...] = (),
        nested: tuple[int, ...] = (),
        in_place: bool = False,
    ) -> None:
        self.parts = parts
        self.names = names
        self.nested = nested
        self.in_place = in_place


def _take_apart(value: Any) -> Any:  # noqa: ANN401  (any part of a state)
    """The value as tuples of numbers and texts.

    Raises:
        TypeError: it cannot be packed; names the fields that lead to it.
    """
    kind: Any = type(value)
    if kind in _LEAVES:
        return value
    if kind is tuple or kind is list:
        return tuple([_take_apart(part) for part in value])
    plan = _plan(kind)
    if not plan.names:
        return plan.parts(value)
    parts = []
    for name, part in zip(plan.names, plan.parts(value), strict=True):
        try:
            parts.append(_take_apart(part))
        except TypeError as error:
            raise TypeError(f"{kind.__name__}.{name}: {error}") from None
    return tuple(parts)


@cache
def _plan(kind: type) -> _Plan:
    if issubclass(kind, Enum):
        return _Plan(attrgetter("value"))
    if issubclass(kind, np.ndarray):
        return _Plan(_array)
    if issubclass(kind, float):
        return _Plan(float)
    names = tuple(sorted(field_names(kind)))
    if not names:
        raise TypeError(f"a {kind.__name__} cannot be packed")
    declared = _declarations(kind)
    nested = [index for index, name in enumerate(names) if not _is_plain(declared.get(name, object))]
    parts = attrgetter(*names)
    in_place = is_dataclass(kind) and not kind.__dataclass_params__.frozen  # type: ignore[attr-defined]
    return _Plan(parts if len(names) > 1 else lambda value: (parts(value),), names, tuple(nested), in_place)


def field_names(kind: type) -> tuple[str, ...]:
    """The fields of a class of a state: of a dataclass, a named tuple or a value, or the slots of another."""
    if is_dataclass(kind):
        return tuple(kind.__dataclass_fields__)
    for declaration in ("_fields", "FIELDS", "__mypyc_attrs__"):  # the last where the class is compiled
        if hasattr(kind, declaration):
            return tuple(getattr(kind, declaration))
    return tuple(name for each in kind.__mro__ for name in getattr(each, "__slots__", ()))


def _declarations(kind: type) -> dict[str, object]:
    """The declared types of fields, as far as they are known: those of the class, or of its arguments."""
    try:
        return {**get_type_hints(kind.__init__), **get_type_hints(kind)}  # type: ignore[misc]
    except NameError:  # of an import for the type check alone
        return {}


def _is_plain(declared: object) -> bool:
    """Whether a value of this type consists of numbers and texts, and tuples of them, alone."""
    if get_origin(declared) in (tuple, Union, UnionType):
        return all(part is ... or _is_plain(part) for part in get_args(declared))
    return declared is None or declared in _LEAVES


def _array(array: Any) -> object:  # noqa: ANN401  (of any shape and type)
    return (array.shape, array.dtype.str, array.tobytes())


def copy_state(state: State) -> State:
    """An independent copy of a state.

    What is changed in place is made anew, the arrays among it too; what never changes is shared.
    """
    copied: State = _copy(state)
    return copied


def _copy(value: Any) -> Any:  # noqa: ANN401  (any part of a state)
    kind: Any = type(value)
    if kind in _LEAVES:
        return value
    if kind is list:
        return [_copy(part) for part in value]
    if kind is tuple:
        copies = [_copy(part) for part in value]
        return value if all(map(is_, copies, value)) else tuple(copies)
    plan = _plan(kind)
    if not plan.names:
        return value
    parts, changed = list(plan.parts(value)), plan.in_place
    for index in plan.nested:
        part = parts[index]
        parts[index] = part.copy() if plan.in_place and type(part) is np.ndarray else _copy(part)
        changed = changed or parts[index] is not part
    return kind(**dict(zip(plan.names, parts, strict=True))) if changed else value
