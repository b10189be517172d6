"""``torquer.size`` and ``torquer.new``: what coils can do, and a scenario for a user's satellite."""

from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Strict

from fsw.input.schema import Section
from sim.new_scenario.command import write_new
from sim.new_scenario.satellite import NewSatellite
from sim.sizing.command import SizingReport, sizing_report
from sim.value_types import Json
from torquer.api.arguments import (
    ScenarioLike,
    Settings,
    checked,
    chosen_scenario,
    optional_path,
    path_text,
    warn_of,
)
from torquer.api.errors import one_sentence
from torquer.api.printed import PrintedResult
from torquer.api.scenarios import TypedScenario

_Triple = Annotated[tuple[float, float, float], Strict(False)]


class _GivenSatellite(Section):
    tle: Annotated[tuple[str, str], Strict(False)] | None
    altitude_km: float | None
    inclination_deg: float | None
    mass_kg: float | None
    size_m: _Triple | None
    inertia_kgm2: _Triple | None
    axes: Annotated[tuple[str, str, str], Strict(False)] | None
    levels_am2: _Triple | None
    dipole_am2: float | None
    driver: Literal["pulsed", "continuous"]
    backoff: Literal["shared", "per_coil"]
    sun: Literal["sensor", "cells"]
    magnetometer_nt: float
    sun_deg: float
    bounds: Literal["exact", "ordinary"]


@dataclass(frozen=True)
class Sizing(PrintedResult):
    """What to expect of a satellite; ``print`` shows what the command prints.

    Attributes:
        found: as ``sim.sizing`` gives it.
    """

    found: SizingReport

    @property
    def values(self) -> Json:
        """Everything, as ``torquer size --json`` prints it."""
        return self.found.values

    @property
    def pointing_deg(self) -> float | None:
        """The pointing error to expect once settled, RMS; None if there is none to rely on."""
        expected = self.found.values["pointing_rms_deg"]
        return None if expected is None else float(expected)

    @property
    def ok(self) -> bool:
        """Whether the coils can balance the disturbance."""
        return self.found.balanced

    def __str__(self) -> str:
        return self.found.text

    def __repr__(self) -> str:
        expected = "none" if self.pointing_deg is None else f"{self.pointing_deg:.2f} deg"
        return f"<Sizing of {self.found.values['scenario']}: pointing {expected}>"


@dataclass(frozen=True)
class NewScenario:
    """A scenario that was written; ``torquer.fly`` takes it as it takes its path.

    Attributes:
        path: its file.
        scenario: what is in it.
        warnings: what is allowed and most likely wrong, a sentence each.
    """

    path: Path
    scenario: TypedScenario
    warnings: tuple[str, ...]

    def __fspath__(self) -> str:
        return fspath(self.path)


@one_sentence
def size(scenario: ScenarioLike, *, set: Settings | None = None) -> Sizing:
    """What pointing to expect, whether gravity holds the body, how long a tumble takes, what levels would do.

    Args:
        scenario: name of a shipped scenario, path of a file, or a scenario.
        set: values laid over the scenario by key.

    Raises:
        InputError: the scenario or a key of it.
    """
    chosen = chosen_scenario(scenario, set)
    warn_of(chosen)
    return Sizing(sizing_report(chosen))


@one_sentence
def new(
    name: str,
    *,
    out: str | PathLike[str] | None = None,
    tle: tuple[str, str] | None = None,
    altitude_km: float | None = None,
    inclination_deg: float | None = None,
    mass_kg: float | None = None,
    size_m: tuple[float, float, float] | None = None,
    inertia_kgm2: tuple[float, float, float] | None = None,
    axes: str | None = None,
    levels_am2: tuple[float, float, float] | None = None,
    dipole_am2: float | None = None,
    driver: str = "pulsed",
    backoff: str = "shared",
    sun: str = "sensor",
    magnetometer_nt: float = 200.0,
    sun_deg: float = 0.5,
    bounds: str = "exact",
) -> NewScenario:
    """Write a commented scenario for a user's satellite, which flies at once, as ``torquer new`` does.

    Args:
        name: of the scenario.
        out: the file; None: ``NAME.toml`` here.
        tle: two lines of elements, in place of altitude and inclination.
        altitude_km: of a circular orbit.
        inclination_deg: of it.
        mass_kg: of a homogeneous box, with ``size_m``.
        size_m: its edges; the longest points up unless ``axes`` says otherwise.
        inertia_kgm2: principal moments, in place of mass and edges.
        axes: your axes that look up, ahead and along the orbit's normal, ``"z x y"``.
        levels_am2: three dipoles of each coil, least first; None: as suggested.
        dipole_am2: the largest dipole of each coil, in place of the levels.
        driver: ``pulsed`` or ``continuous``.
        backoff: ``shared`` by the coils, or ``per_coil``.
        sun: ``sensor``, or ``cells`` on the six sides.
        magnetometer_nt: noise, standard deviation.
        sun_deg: noise of the Sun sensor.
        bounds: ``exact``: the onboard table is right but for bias, residual dipole and torque; ``ordinary``.

    Raises:
        InputError: an argument, or the file exists; nothing was written.
    """
    given = checked(
        _GivenSatellite,
        "new",
        tle=tle,
        altitude_km=altitude_km,
        inclination_deg=inclination_deg,
        mass_kg=mass_kg,
        size_m=size_m,
        inertia_kgm2=inertia_kgm2,
        axes=None if axes is None else tuple(axes.split()) if isinstance(axes, str) else axes,
        levels_am2=levels_am2,
        dipole_am2=dipole_am2,
        driver=driver,
        backoff=backoff,
        sun=sun,
        magnetometer_nt=magnetometer_nt,
        sun_deg=sun_deg,
        bounds=bounds,
    )
    chosen = {"driver", "backoff", "sun", "bounds"}
    satellite = NewSatellite(
        path_text(name, "name"),
        **given.model_dump(exclude=chosen),
        continuous=given.driver == "continuous",
        per_coil=given.backoff == "per_coil",
        cells=given.sun == "cells",
        exact=given.bounds == "exact",
    )
    written = write_new(satellite, optional_path(out, "out"))
    return NewScenario(written.file, TypedScenario.of(written.scenario), written.warnings)
