"""Packages that not everybody needs."""

from importlib import import_module
from types import ModuleType

from sim.errors import HarnessError


def required(package: str, for_what: str) -> ModuleType:
    """A package of the extra ``torquer[data]``.

    Raises:
        HarnessError: it is missing.
    """
    try:
        return import_module(package)
    except ImportError:
        raise HarnessError(f"{for_what} needs the package {package}: pip install 'torquer[data]'") from None
