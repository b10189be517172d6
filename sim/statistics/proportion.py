"""A proportion, and its bounds by Clopper and Pearson."""

from dataclasses import asdict, dataclass

from scipy.special import betaincinv


@dataclass(frozen=True, slots=True)
class Proportion:
    """``count`` of ``total``, with two-sided bounds of the probability."""

    count: int
    total: int
    low: float
    high: float

    @property
    def value(self) -> float:
        """The estimate."""
        return self.count / self.total

    @property
    def values(self) -> dict[str, float]:
        """The numbers and the estimate by name, as values of JSON."""
        return {**asdict(self), "value": self.value}


def clopper_pearson(count: int, total: int, confidence: float) -> Proportion:
    """The exact bounds (Clopper and Pearson 1934), half of the remaining probability on each side.

    P(B(n, low) >= count) = P(B(n, high) <= count) = (1 - confidence) / 2, by the beta distribution.
    """
    tail = 0.5 * (1.0 - confidence)
    low = float(betaincinv(count, total - count + 1, tail)) if count else 0.0
    high = float(betaincinv(count + 1, total - count, 1.0 - tail)) if count < total else 1.0
    return Proportion(count, total, low, high)
