"""A copy of an object with other values of some of its fields, whatever kind of class it is of."""

from dataclasses import is_dataclass, replace

from fsw.core.packing import field_names


def with_values(one, **fields):
    """The copy; what is not named is shared."""
    if is_dataclass(one):
        return replace(one, **fields)
    if isinstance(one, tuple):
        return one._replace(**fields)
    if hasattr(one, "replace"):
        return one.replace(**fields)
    values = {name: getattr(one, name) for name in field_names(type(one))}
    return type(one)(**(values | fields))
