"""A user law that a program gives as an object: its name, its source's digest, where it is known.

A table names it ``object MODULE:NAME``. The object itself is known in the block that gives it alone, so that
nothing but the program that has it flies it.
"""

import hashlib
import inspect
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from textwrap import dedent
from typing import NamedTuple

from fsw.input.schema import TableError
from fsw.own_law import ControlLaw

LAMBDA = "<lambda>"


class GivenLaw(NamedTuple):
    """A law that was given as an object.

    Attributes:
        law: a function or a ``ControlLaw``, not yet checked.
        reference: by which a table names it.
        sha256: of its source in hex; None: the source cannot be read.
    """

    law: object
    reference: str
    sha256: str | None


_STANDING: ContextVar[GivenLaw | None] = ContextVar("given_law", default=None)


@contextmanager
def standing(law: object) -> Iterator[str]:
    """A block in which a law is known that is given as an object; of other threads nothing changes.

    Yields:
        The reference by which a table names it.

    Raises:
        TableError: it is no law.
    """
    if not callable(law) and not isinstance(law, ControlLaw):
        raise TableError(
            f"law = {law!r:.80}: give FILE.py:NAME, an installed law, a function or a ControlLaw"
        )
    given = GivenLaw(law, _reference(law), _sha256(law))
    before = _STANDING.set(given)
    try:
        yield given.reference
    finally:
        _STANDING.reset(before)


def given_law() -> GivenLaw | None:
    """The law that is given here; None: none is."""
    return _STANDING.get()


def _reference(law: object) -> str:
    """Module and name of the function, or where that has none, of the variable that holds the law."""
    form = law.point if isinstance(law, ControlLaw) else law
    module = str(getattr(form, "__module__", None) or type(form).__module__)
    name = str(getattr(form, "__qualname__", type(form).__qualname__))
    if form is not law or name == LAMBDA or not hasattr(form, "__qualname__"):
        module, name = _variable(law, module) or (module, name)
    return f"object {module}:{name}"


def _variable(law: object, module: str) -> tuple[str, str] | None:
    """The module, this or the one that runs, and the name of its variable that is the law."""
    for place in (module, "__main__"):
        for name, value in list(getattr(sys.modules.get(place), "__dict__", {}).items()):
            if value is law and not name.startswith("_"):  # a notebook calls what a cell gave _ and _3
                return place, name
    return None


def _sha256(law: object) -> str | None:
    """The digest of the source of its functions, and of the defaults of its gains."""
    if not isinstance(law, ControlLaw):
        source = _source(law)
        return None if source is None else hashlib.sha256(source.encode()).hexdigest()
    sources = [_source(law.point), "" if law.acquire is None else _source(law.acquire)]
    fields = getattr(law.gains, "__dataclass_fields__", {})
    gains = [f"{name} = {field.default!r}" for name, field in fields.items()]
    if None in sources:
        return None
    return hashlib.sha256(repr([*sources, gains, law.aim]).encode()).hexdigest()


def _source(form: object) -> str | None:
    """The source of a function; None: there is none, or it is that of the statement around a lambda."""
    if getattr(form, "__name__", LAMBDA) == LAMBDA:
        return None
    try:
        return dedent(inspect.getsource(form))  # type: ignore[arg-type]  # whatever they gave
    except (OSError, TypeError, SyntaxError):
        return None
