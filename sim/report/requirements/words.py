"""Numbers of verdicts and their causes in words."""

from collections.abc import Iterable


def number(value: float) -> str:
    """Three significant digits, without an exponent where it reads well."""
    if value and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.2e}"
    return f"{value:.3g}" if abs(value) < 100.0 else f"{value:.0f}"


def orbits(value: float) -> str:
    """A time in orbits."""
    return f"{value:.2f} orbits" if round(value, 2) != 1.0 else "1 orbit"


def part(value: float) -> str:
    """A fraction in percent."""
    return f"{100.0 * value:.0f} %"


def limit_words(values: Iterable[float], unit: str) -> str:
    """The limits that runs have."""
    return f"at most {' or '.join(f'{value:g}' for value in values)} {unit}"
