"""``run.plot``: the figures of a run for papers, as matplotlib draws them."""

from functools import cached_property
from pathlib import Path
from typing import Literal

from matplotlib import pyplot
from matplotlib.axes import Axes
from pydantic import Field

from fsw.input.schema import Section, TableError
from sim.errors import HarnessError
from sim.report.charts.drawn_flight import DrawnFlight, flight_as_estimated, flight_as_flown
from sim.report.paper import COLUMN_IN, FIGURES, paper_style
from sim.scenario.law_named import with_law_named
from sim.scenario.schema import Scenario
from torquer.api.arguments import checked
from torquer.api.errors import one_sentence
from torquer.api.laws import LawLike, law_given

MOST_HIGH_IN = 4.5
"""A wider figure grows no higher."""


class _PlotOptions(Section):
    width_in: float | None = Field(ge=1.0, le=100.0)


class RunPlots:
    """The figures of a run: each method draws one, and gives its axes.

    Without ``ax`` a figure of its own is made, ``width_in`` inches wide, in the look of a paper; the default
    is a column's. With ``ax`` it is drawn there, in the look that this has. ``axes.figure.savefig`` writes
    it, and ``torquer.report(run, figures="pdf")`` all of them. Grey bands are eclipses.

    Args:
        path: the directory of the run.
        scenario: of the run.
        law: of its own, named or given again; needed where the flight software is replayed.
    """

    def __init__(self, path: Path, scenario: Scenario, law: LawLike | None = None) -> None:
        self._path, self._scenario, self._law = path, scenario, law

    def pointing(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """Angle of the whole attitude from the nominal one, and of axis 1 from the vertical [deg]."""
        return self._draw("pointing", ax, width_in)

    def rates(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """Rate relative to the orbital frame, body axes [deg/s, or mdeg/s where it is slow]."""
        return self._draw("rates", ax, width_in)

    def rate_magnitude(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """Magnitude of the rate relative to the orbital frame [deg/s], on a logarithmic scale."""
        return self._draw("rate_magnitude", ax, width_in)

    @one_sentence
    def estimate_errors(
        self,
        of: Literal["attitude", "rate"] = "attitude",
        *,
        ax: Axes | None = None,
        width_in: float | None = None,
    ) -> Axes:
        """True error of the estimated attitude [deg] or rate [mdeg/s], and 3 sigma of the filter.

        The first call replays the log, which takes about as long as the flight.

        Raises:
            InputError: the flight software had no estimate.
        """
        if of not in ("attitude", "rate"):
            raise TableError(f"estimate_errors: of = {of!r:.80}: allowed is 'attitude' or 'rate'")
        return self._draw(f"{of}_error", ax, width_in)

    def dipoles(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """True dipole of the coils, body axes [A m^2]."""
        return self._draw("dipoles", ax, width_in)

    def pulses(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """A lane for each coil, a bar for each pulse, up or down by its polarity, as high as its level.

        Raises:
            InputError: there is no pulse.
        """
        return self._draw("pulses", ax, width_in)

    def field(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """Geomagnetic field, body axes [uT]."""
        return self._draw("field", ax, width_in)

    def torques(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """Magnitude of the torques by source [uN m]; of the coils, which act in pulses, of a mean."""
        return self._draw("torques", ax, width_in)

    def modes(self, *, ax: Axes | None = None, width_in: float | None = None) -> Axes:
        """Mode of the flight software, by a replay of the log as for ``estimate_errors``."""
        return self._draw("modes", ax, width_in)

    @cached_property
    def _flown(self) -> DrawnFlight:
        return flight_as_flown(self._path, self._scenario)

    @cached_property
    def _estimated(self) -> DrawnFlight:
        with law_given(self._law) as named:
            return flight_as_estimated(self._path, with_law_named(self._scenario, named)[0])

    @one_sentence
    def _draw(self, name: str, ax: Axes | None, width_in: float | None) -> Axes:
        wide_in = checked(_PlotOptions, f"plot.{name}", width_in=width_in).width_in or COLUMN_IN
        figure = FIGURES[name]
        flight = self._estimated if figure.replayed else self._flown
        if why := figure.why_not(flight):
            raise HarnessError(f"{self._path}: {why}: there is nothing to draw")
        if ax is not None:
            figure.draw(ax, flight)
            return ax
        with paper_style():
            _, made = pyplot.subplots(figsize=(wide_in, figure.aspect * min(wide_in, MOST_HIGH_IN)))
            figure.draw(made, flight)
        return made
