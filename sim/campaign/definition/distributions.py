"""Distributions of a campaign file: ``[[disperse]]`` gives keys of the scenario, and how they are drawn.

A parameter is one number for all components of the key's value, or one for each of them.
"""

from collections.abc import Sequence
from math import prod
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, Strict, model_validator
from typing_extensions import override

from fsw.input.schema import Section
from sim.value_types import Array

# --- What every dispersion of a campaign has: keys, how the drawn value is applied, parameters that fit

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


# --- The distributions

LEAST_PART = 1e-6
"""Fraction of a normal distribution that must lie between its limits."""


def _part_below(limits: Array) -> Array:
    """The part of a standard normal distribution below each limit."""
    from scipy.special import ndtr  # noqa: PLC0415  (slow to load)

    below: Array = ndtr(limits)
    return below


class Normal(OneKey):
    """Gaussian, independent by component; between ``low`` and ``high`` where they are given."""

    distribution: Literal["normal"]
    mean: Numbers
    sigma: Numbers
    low: Numbers = None
    high: Numbers = None

    @model_validator(mode="after")
    def _is_a_distribution(self) -> Self:
        if not np.all(np.array(self.sigma) >= 0.0):
            raise ValueError(f"sigma = {self.sigma} is not allowed: allowed is a number at least 0")
        low, high = self._limits()
        if np.any(_part_below(high) - _part_below(low) < LEAST_PART):
            raise ValueError("low to high must hold at least a millionth of the distribution")
        return self

    def _limits(self) -> tuple[Array, Array]:
        """In units of sigma from the mean; a sigma of 0 has none."""
        sigma = np.array(self.sigma, dtype=float)
        scale = np.where(sigma > 0.0, sigma, np.inf)
        low = -np.inf if self.low is None else (np.array(self.low) - self.mean) / scale
        high = np.inf if self.high is None else (np.array(self.high) - self.mean) / scale
        return np.where(sigma > 0.0, low, -np.inf), np.where(sigma > 0.0, high, np.inf)

    @override
    def parameters(self) -> tuple[Any, ...]:
        return tuple(part for part in (self.mean, self.sigma, self.low, self.high) if part is not None)

    @override
    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        from scipy.special import ndtri  # noqa: PLC0415  (slow to load)

        low, high = map(_part_below, self._limits())
        part = random.uniform(size=shapes[0])
        return [np.array(self.mean + self.sigma * ndtri(low + part * (high - low)))]

    @override
    def probes(self, shapes: Sequence[Shape]) -> list[Values]:
        ends = [end for end in (self.low, self.high) if end is not None]
        return [[np.broadcast_to(np.asarray(end, float), shapes[0])] for end in (ends or [self.mean])]


class Uniform(OneKey):
    """Uniform from ``low`` to ``high``, independent by component."""

    distribution: Literal["uniform"]
    low: Numbers
    high: Numbers

    @model_validator(mode="after")
    def _is_an_interval(self) -> Self:
        if not np.all(np.array(self.low) <= np.array(self.high)):
            raise ValueError(f"low = {self.low} must not be above high = {self.high}")
        return self

    @override
    def parameters(self) -> tuple[Any, ...]:
        return self.low, self.high

    @override
    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        low, high = np.array(self.low, float), np.array(self.high, float)
        return [np.array(low + (high - low) * random.uniform(size=shapes[0]))]

    @override
    def probes(self, shapes: Sequence[Shape]) -> list[Values]:
        return [[np.broadcast_to(np.asarray(end, float), shapes[0])] for end in (self.low, self.high)]


class LogUniform(Uniform):
    """As ``Uniform``, of the logarithm."""

    distribution: Literal["log_uniform"]  # type: ignore[assignment]  # another of the union

    @model_validator(mode="after")
    def _is_positive(self) -> Self:
        if not np.all(np.array(self.low) > 0.0):
            raise ValueError(f"low = {self.low} is not allowed: allowed is a number above 0")
        return self

    @override
    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        low, high = np.log(self.low), np.log(self.high)
        return [np.array(np.exp(low + (high - low) * random.uniform(size=shapes[0])))]


class Choice(OneKey):
    """One of ``values``, each as likely as its weight; values are any that the key accepts."""

    distribution: Literal["choice"]
    apply: Literal["replace"] = "replace"
    values: Annotated[tuple[Any, ...], Strict(False), Field(min_length=1)]
    weights: Annotated[tuple[float, ...], Strict(False)] = ()

    @model_validator(mode="after")
    def _has_a_weight_each(self) -> Self:
        if self.weights and (len(self.weights) != len(self.values) or not sum(self.weights) > 0.0):
            raise ValueError("weights must be as many as values, and one of them above 0")
        if any(weight < 0.0 for weight in self.weights):
            raise ValueError("weights must not be below 0")
        first, *others = map(_columns, self.values)
        if any(other != first for other in others):
            raise ValueError(
                "values must be all numbers, all texts, all switches, lists of the same shape, "
                "or tables with the same keys"
            )
        return self

    @override
    def shape_of(self, nominal: Any) -> Shape:
        return ()

    @override
    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        weights = np.array(self.weights or [1.0] * len(self.values))
        return [self.values[int(random.choice(len(self.values), p=weights / weights.sum()))]]

    @override
    def probes(self, shapes: Sequence[Shape]) -> list[Values]:
        return [[value] for value in self.values]


class Direction(OneKey):
    """A vector whose direction is uniform on the sphere; its length is uniform, or its logarithm is."""

    distribution: Literal["direction"]
    length: Literal["uniform", "log_uniform"] = "uniform"
    low: float = Field(ge=0.0)
    high: float = Field(ge=0.0)

    @model_validator(mode="after")
    def _is_an_interval(self) -> Self:
        if self.low > self.high or (self.length == "log_uniform" and self.low == 0.0):
            raise ValueError(f"low = {self.low:g} must be at most high, and above 0 if length is log_uniform")
        return self

    @override
    def shape_of(self, nominal: Any) -> Shape:
        if nominal is not None and np.shape(nominal) != (3,):
            raise ValueError("a direction is for a key whose value has three components")
        return (3,)

    @override
    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        vector, part = random.standard_normal(3), random.uniform()
        if self.length == "log_uniform":
            length = self.low * (self.high / self.low) ** part
        else:
            length = self.low + (self.high - self.low) * part
        return [np.array(length * vector / np.linalg.norm(vector))]

    @override
    def probes(self, shapes: Sequence[Shape]) -> list[Values]:
        return [[sign * self.high * axis] for axis in np.eye(3) for sign in (1.0, -1.0)]


class Correlated(Dispersion):
    """Jointly Gaussian over the components of several keys, in the order of the keys."""

    distribution: Literal["correlated"]
    keys: Annotated[tuple[str, ...], Strict(False), Field(min_length=1)]
    mean: Annotated[tuple[float, ...], Strict(False)]
    covariance: Numbers

    @model_validator(mode="after")
    def _is_a_covariance(self) -> Self:
        matrix = np.array(self.covariance, dtype=float)
        size = len(self.mean)
        if matrix.shape != (size, size) or not np.allclose(matrix, matrix.T):
            raise ValueError(f"covariance must be symmetric, {size} x {size} as mean is long")
        if np.linalg.eigvalsh(matrix)[0] < -1e-9 * np.abs(matrix).max():
            raise ValueError("covariance must not have a negative eigenvalue")
        return self

    @property
    @override
    def targets(self) -> tuple[str, ...]:
        return self.keys

    @override
    def draw(self, random: np.random.Generator, shapes: Sequence[Shape]) -> Values:
        values, vectors = np.linalg.eigh(np.array(self.covariance, dtype=float))
        root = (
            vectors * np.sqrt(np.clip(values, 0.0, None))
        ) @ vectors.T  # the same whatever the vectors' signs
        return self._parted(self.mean + root @ random.standard_normal(len(self.mean)), shapes)

    @override
    def probes(self, shapes: Sequence[Shape]) -> list[Values]:
        return [self._parted(np.array(self.mean), shapes)]

    def _parted(self, numbers: Array, shapes: Sequence[Shape]) -> Values:
        """By key.

        Raises:
            ValueError: there are more or fewer than the keys have components.
        """
        sizes = [prod(shape) for shape in shapes]
        if sum(sizes) != len(numbers):
            raise ValueError(f"mean has {len(numbers)} numbers, and the keys have {sum(sizes)} components")
        parts = np.split(numbers, np.cumsum(sizes)[:-1])
        return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]


AnyDispersion = Annotated[
    Normal | Uniform | LogUniform | Choice | Direction | Correlated, Field(discriminator="distribution")
]


def _columns(value: object, name: str = "") -> dict[str, str]:
    """The columns that a value has in the results, by key with dots, and what is in each."""
    if isinstance(value, dict | list | tuple):
        parts = value.items() if isinstance(value, dict) else enumerate(value)
        found: dict[str, str] = {}
        for key, part in parts:
            found |= _columns(part, f"{name}.{key}" if name else f"{key}")
        return found or {name: "empty"}
    return {name: "text" if isinstance(value, str) else "switch" if isinstance(value, bool) else "number"}
