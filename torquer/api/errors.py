"""What the API raises: one sentence for the user, whichever part of torquer it comes from."""

from collections.abc import Callable
from functools import wraps
from importlib import import_module
from types import ModuleType
from typing import ParamSpec, TypeVar

from fsw.bus.interface import BusError
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from sim.errors import HarnessError, needing
from sim.plant.errors import PlantError

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")


class Error(Exception):
    """Nothing came of a call. The message is one sentence.

    Attributes:
        exit_code: with which the command of the same name ends.
    """

    def __init__(self, sentence: str, exit_code: int = 1) -> None:
        super().__init__(sentence)
        self.exit_code = exit_code


class InputError(Error):
    """A wrong argument, key or file, or a bus that cannot be used; nothing was done."""

    def __init__(self, sentence: str) -> None:
        super().__init__(sentence, exit_code=2)


def one_sentence(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """The function, with every error that its caller can correct as ``Error`` or ``InputError``."""

    @wraps(function)
    def call(*args: Parameters.args, **kwargs: Parameters.kwargs) -> Result:
        try:
            return function(*args, **kwargs)
        except (TableError, BusError, HarnessError, PlantError) as error:
            sentence, code = error_text(error), getattr(error, "exit_code", 2)
            raise (InputError(sentence) if code == 2 else Error(sentence, code)) from None

    return call


# --- Packages that not everybody needs


def required(package: str, for_what: str) -> ModuleType:
    """A package of the extra ``torquer[data]``.

    Raises:
        HarnessError: it is missing.
    """
    with needing(for_what, package, "data"):
        return import_module(package)
