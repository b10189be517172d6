"""Packages that not everybody needs."""

from importlib import import_module
from types import ModuleType

from sim.errors import needing


def required(package: str, for_what: str) -> ModuleType:
    """A package of the extra ``torquer[data]``.

    Raises:
        HarnessError: it is missing.
    """
    with needing(for_what, package, "data"):
        return import_module(package)
