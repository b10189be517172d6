"""The base of short-lived values: messages, frames, demands."""

from typing import Any, ClassVar, Self

from mypy_extensions import mypyc_attr


@mypyc_attr(allow_interpreted_subclasses=True)
class Value:
    """Equal by type and attributes, and shown by them. Never changed once it has been passed on.

    A subclass names its attributes in ``FIELDS``, in the order of its constructor's parameters.
    """

    FIELDS: ClassVar[tuple[str, ...]] = ()
    __slots__ = ()

    def values(self) -> tuple[Any, ...]:
        """The attributes in order."""
        return tuple([getattr(self, name) for name in self.FIELDS])

    def by_name(self) -> dict[str, Any]:
        """The attributes by name, in order."""
        return {name: getattr(self, name) for name in self.FIELDS}

    def replace(self, **changes: Any) -> Self:  # noqa: ANN401  (of any attribute)
        """A copy in which these attributes have other values."""
        return type(self)(**self.by_name() | changes)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Value) and type(self) is type(other) and self.values() == other.values()

    def __hash__(self) -> int:
        return hash(self.values())

    def __repr__(self) -> str:
        attributes = ", ".join([f"{name}={value!r}" for name, value in self.by_name().items()])
        return f"{type(self).__name__}({attributes})"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self.values()
