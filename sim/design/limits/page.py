"""docs/pulse-limits.md, from the template ``page.md.j2`` and what was flown alone."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, sqrt

from jinja2 import Environment, PackageLoader, StrictUndefined

from sim.design.limits.linear_flight import LOST_DEG
from sim.design.limits.sweep import BOUND, QUANTITIES, Line, Sweep, all_orders, error_deg


@dataclass(frozen=True, slots=True)
class Agreement:
    """A whole flight beside linear ones, their RMS errors in deg, of the same orbits."""

    name: str
    whole_deg: float
    linear_deg: tuple[float, ...]


def page(flown: Mapping[str, float], agreements: Sequence[Agreement], platform: str) -> str:
    """The page.

    Args:
        flown: by the key of an order, its error in deg.
        agreements: whole flights beside linear ones.
        platform: what it was computed with.
    """

    def deg(title: str, label: str, law: str, torque: bool = True) -> str:
        return _figure(_error_deg(title, label, Line(law, torque), flown))

    def beyond(title: str, label: str, law: str) -> str:
        error = _error_deg(title, label, Line(law), flown)
        least = _error_deg(title, label, Line(BOUND), flown)
        return "" if error is None or least is None else _figure(sqrt(max(0.0, error**2 - least**2)))

    environment = Environment(
        loader=PackageLoader("sim.design.limits"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    orders = all_orders()
    return environment.get_template("page.md.j2").render(
        quantities=[(one.title, list(_table(one, flown))) for one in QUANTITIES],
        agreements=agreements,
        deg=deg,
        beyond=beyond,
        platform=platform,
        there=sum(order.key in flown for order in orders),
        orders=len(orders),
    )


def _error_deg(title: str, label: str, line: Line, flown: Mapping[str, float]) -> float | None:
    """What was flown of a quantity at the value that is so called."""
    quantity = next(one for one in QUANTITIES if one.title == title)
    setting = next(one for one in quantity.settings if one.label == label)
    return error_deg(setting, line, flown)


def _table(quantity: Sweep, flown: Mapping[str, float]) -> Iterator[str]:
    """A row for each value, a column for each line."""
    names = [line.law if line.torque else f"{line.law}, no torque" for line in quantity.lines]
    yield _row(quantity.label, *names)
    yield "|---" * (1 + len(names)) + "|"
    for setting in quantity.settings:
        errors = (error_deg(setting, line, flown) for line in quantity.lines)
        yield _row(setting.label, *map(_figure, errors))


def _figure(error: float | None) -> str:
    if error is None:
        return ""
    return f"{error:.3g}" if isfinite(error) else f"> {LOST_DEG:g}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
