"""What every dispersion of a campaign has: keys, how the drawn value is applied, parameters that fit."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator
from typing_extensions import override

from fsw.input.schema import Section

Shape = tuple[int, ...]
Values = list[Any]
"""A value for each key: numbers as arrays, those of a choice as in the file."""


def _numbers(value: Any) -> Any:  # noqa: ANN401  (as in the file)
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if isinstance(value, bool | str) or not np.isfinite(array).all():
        raise ValueError("must be a number, or a list of numbers as long as the value of the key")
    return value


Numbers = Annotated[Any, AfterValidator(_numbers)]


class Dispersion(Section):
    """One ``[[disperse]]``.

    ``apply`` says what becomes of the scenario's own value: the drawn one replaces it, is added to it or
    multiplies it, component by component.
    """

    apply: Literal["replace", "add", "multiply"] = "replace"

    @property
    def targets(self) -> tuple[str, ...]:
        """The keys that are drawn together."""
        raise NotImplementedError

    def applied(self, nominal: object, drawn: object) -> Any:  # noqa: ANN401  (any value of a scenario)
        """The value that a run flies with."""
        if not isinstance(drawn, np.ndarray):
            return drawn
        if self.apply == "add":
            drawn = np.asarray(nominal) + drawn
        elif self.apply == "multiply":
            drawn = np.asarray(nominal) * drawn
        return drawn.tolist()

    def shape_of(self, nominal: Any) -> Shape:  # noqa: ANN401  (any value of a scenario)
        """The shape of the value, or of the parameters where the scenario has no value.

        Raises:
            ValueError: the parameters do not fit it.
        """
        given = np.broadcast_shapes(*(np.shape(part) for part in self.parameters()))
        if nominal is None and self.apply == "replace":
            return given
        try:
            shape: Shape = np.shape(_numbers(nominal))
        except ValueError:
            raise ValueError(f"the scenario's value is {nominal!r}, not a number or numbers") from None
        if given not in ((), shape):
            raise ValueError(f"parameters are {_words(given)}, the scenario's value is {_words(shape)}")
        return shape

    def parameters(self) -> tuple[Any, ...]:
        """The parameters that have the shape of the value."""
        return ()

    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        """A value for each key."""
        raise NotImplementedError

    def probes(self, shapes: Sequence[Shape]) -> list[Values]:
        """Values that the scenario must accept before anything is flown: the limits, or the mean."""
        raise NotImplementedError


class OneKey(Dispersion):
    """A dispersion of one key."""

    key: str

    @property
    @override
    def targets(self) -> tuple[str, ...]:
        return (self.key,)


def _words(shape: Shape) -> str:
    return f"{' x '.join(map(str, shape))} numbers" if shape else "one number"
