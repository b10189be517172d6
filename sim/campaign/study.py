"""Studies of flights: a set of orders, and figures of their results."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, isnan, nan
from statistics import fmean, median

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Spread, Study, Threshold
from sim.campaign.flight import FlightResult, Order, fly_order
from sim.scenario.settings import flat

Pick = Callable[[FlightResult], float]


@dataclass(frozen=True, slots=True)
class Figure:
    """One claim about a set of flights.

    Attributes:
        id: last word of the claim's id.
        statement: what it is.
        unit: of figure and limits.
        pick: the figure of one flight.
        of: how the flights' figures are combined: ``median``, ``mean`` or, by default, the worst.
        group: the flights that count, by the group of their order.
        counts: which of them count; None: all.
        low: least that passes.
        high: most that passes.
        threshold: where the limits come from.
        wide: why limits chosen here are far from the figure; empty where they are close.
    """

    id: str
    statement: str
    unit: str
    pick: Pick
    of: str = "worst"
    group: str = ""
    counts: Callable[[FlightResult], bool] | None = None
    low: float = -inf
    high: float = inf
    threshold: Threshold = Threshold.OWN
    wide: str = ""


@dataclass(frozen=True, slots=True)
class Group:
    """Orders that belong together."""

    name: str
    orders: tuple[Order, ...]


@dataclass(frozen=True, slots=True)
class FlightStudy(Study):
    """A study whose tasks are flights.

    Attributes:
        source: of its claims.
        counted: what its claims state the number of; empty: nothing.
        made_for: the number of flights that claims on a median or mean are made for: fewer are too few to
            judge them by; 0: any.
        groups: its orders.
        figures: by which they are judged.
    """

    source: str = ""
    counted: str = ""
    made_for: int = 0
    groups: tuple[Group, ...] = ()
    figures: tuple[Figure, ...] = ()

    @property
    def orders(self) -> tuple[Order, ...]:
        """The orders of all groups, as its tasks fly them."""
        return tuple(order for group in self.groups for order in group.orders)


def campaign(
    study_id: str,
    source: str,
    groups: Sequence[Group],
    figures: Sequence[Figure],
    counted: str = "",
    made_for: int = 0,
) -> FlightStudy:
    """The study that flies all orders and judges every figure; the arguments as in ``FlightStudy``."""
    names = [group.name for group in groups for _ in group.orders]
    tasks = tuple(partial(fly_order, order) for group in groups for order in group.orders)
    stated = f"{source}; {len(tasks)} {counted}" if counted else source

    def conclude(flights: Sequence[FlightResult]) -> list[ClaimOutcome]:
        named_flights = list(zip(names, flights, strict=True))
        short = len(flights) < made_for
        few = f"{len(flights)} of the {made_for} {counted} that it is claimed for" if short else ""
        return [_judge(study_id, stated, figure, _counted(figure, named_flights), few) for figure in figures]

    return FlightStudy(
        study_id,
        tasks,
        conclude,
        has_flights=True,
        source=source,
        counted=counted,
        made_for=made_for,
        groups=tuple(groups),
        figures=tuple(figures),
    )


def summary_number(flight: FlightResult, key: str, missing: float = nan) -> float:
    """A number of the summary, ``a.b`` for its nested keys; ``missing`` where the summary has none."""
    value: object = flight.summary
    for part in key.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    return float(value) if isinstance(value, int | float) else missing


def summary_value(key: str, missing: float = nan) -> Pick:
    """Picks a number of the summary."""
    return lambda flight: summary_number(flight, key, missing)


def figure_of(name: str) -> Pick:
    """Picks a figure that the flight's measure gave."""
    return lambda flight: flight.figures.get(name, nan)


def describe_order(order: Order) -> str:
    """A text that identifies a flight."""
    if order.name:
        return order.name
    words = [f"{key}={_text(value)}" for key, value in flat(order.overrides)]
    name = order.scenario if isinstance(order.scenario, str) else order.scenario.name
    return ", ".join([name, f"seed {order.seed}", *words])


_COMBINATIONS: dict[str, Callable[[list[float]], float]] = {"median": median, "mean": fmean}


def _counted(figure: Figure, named_flights: Sequence[tuple[str, FlightResult]]) -> list[FlightResult]:
    group = [flight for name, flight in named_flights if name == figure.group]
    return group if figure.counts is None else [flight for flight in group if figure.counts(flight)]


def _judge(
    study_id: str, source: str, figure: Figure, flights: Sequence[FlightResult], few: str
) -> ClaimOutcome:
    """The outcome of a figure; ``few``: why a median or mean is not judged, empty where it is."""
    claim = Claim(
        f"{study_id}.{figure.id}",
        figure.statement,
        source,
        figure.unit,
        figure.low,
        figure.high,
        figure.threshold,
        figure.wide,
    )
    if not flights:
        return ClaimOutcome(claim, ClaimVerdict.ABSENT)
    values = [figure.pick(flight) for flight in flights]
    spread, without = spread_of(claim, values), [place for place, value in enumerate(values) if isnan(value)]
    if without:
        first = describe_order(flights[without[0]].order)
        return claim.judge(nan, f"no figure in {len(without)} of {len(values)} flights: {first}", spread)
    excess = [max(figure.low - value, value - figure.high) for value in values]
    worst = max(range(len(values)), key=lambda place: excess[place])
    if figure.of not in _COMBINATIONS:
        value = values[worst]
    else:
        value = _COMBINATIONS[figure.of](values)
        if few:
            return ClaimOutcome(claim, ClaimVerdict.TOO_FEW, value, few, spread)
    where = f"worst: {describe_order(flights[worst].order)}: {values[worst]:.3g}"
    return claim.judge(value, where, spread)


def spread_of(claim: Claim, values: Sequence[float]) -> Spread:
    """What all flights give; one without a number counts as the largest, and does not meet the claim."""
    numbers = sorted(inf if isnan(value) else value for value in values)
    meet = sum(map(claim.meets, values))
    return Spread(len(values), meet, numbers[0], median(numbers), numbers[-1])


def _text(value: object) -> str:
    """A value with its numbers rounded."""
    if isinstance(value, list):
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
