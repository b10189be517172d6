"""The section of the onboard table for Sun cells, which take the place of a Sun sensor."""

from math import cos, hypot, radians
from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from fsw.core.algebra.vector import Vec3, unit
from fsw.core.estimation.cells.cell_set import CellSet, Shade
from fsw.core.estimation.parameters import MOST_CELLS
from fsw.input.schema import Positive, Section, StepPercent, Triple

QUANTUM = 1.0 / 128.0
"""Step of a current on the bus, as a fraction of full sunlight."""


class ShadeTable(Section):
    """A cone about ``axis``, body axes, in which the satellite shades a cell; cell 1 is the first."""

    cell: int = Field(ge=1, le=MOST_CELLS)
    axis: Triple
    half_deg: float = Field(gt=0.0, le=90.0)

    @model_validator(mode="after")
    def _axis_has_a_direction(self) -> Self:
        if not any(self.axis):
            raise ValueError("axis must not be zero")
        return self


class CellShapes(Section):
    """Where up to six cells look, body axes, and the directions in which the satellite itself shades them."""

    normals: Annotated[tuple[Triple, ...], Strict(False), Field(min_length=1, max_length=MOST_CELLS)]
    shades: Annotated[tuple[ShadeTable, ...], Strict(False)] = ()

    @model_validator(mode="after")
    def _cells_are_there(self) -> Self:
        if not all(any(normal) for normal in self.normals):
            raise ValueError("normals must not be zero")
        if any(shade.cell > len(self.normals) for shade in self.shades):
            raise ValueError(f"shades: there is no such cell, normals has {len(self.normals)}")
        return self


class CellTable(CellShapes):
    """Sun cells as the flight software knows them.

    ``full_sun`` is what each shows facing the Sun, as a fraction of its nominal current; ``noise_percent`` is
    of full sunlight, and so are ``dark_percent``, below which a cell counts as dark, and ``quantum_percent``,
    the step of a current where it is coarser than that of the bus, 0: it is not. ``albedo`` is the
    fraction of sunlight that the Earth reflects; with 0 the Earth's light is not modelled.
    """

    full_sun: Annotated[tuple[Positive, ...], Strict(False)] | None = None
    noise_percent: Positive = 1.0
    quantum_percent: StepPercent = 0.0
    dark_percent: float = Field(default=5.0, gt=0.0, le=20.0)
    albedo: float = Field(default=0.3, ge=0.0, le=1.0)

    @model_validator(mode="after")
    def _each_has_its_full_sun(self) -> Self:
        if self.full_sun is not None and len(self.full_sun) != len(self.normals):
            raise ValueError(f"full_sun must be {len(self.normals)} numbers, one for each of normals")
        return self


def cell_set(table: CellTable, excess_sigma: float, gain_sigma: float, light_sigma: float) -> CellSet:
    """The cells as the filter uses them.

    Args:
        table: the section.
        excess_sigma: standard deviation of what a cell shows beyond its model, fraction of full sunlight.
        gain_sigma: of the relative error of a gain.
        light_sigma: of the albedo; 0 where the Earth's light is not modelled.
    """
    normals, step = tuple(unit(normal) for normal in table.normals), 0.01 * table.quantum_percent
    return CellSet(
        normals_body=normals,
        full_sun=table.full_sun or (1.0,) * len(normals),
        shades=tuple(_shades(table, number) for number in range(1, len(normals) + 1)),
        dark=0.01 * table.dark_percent,
        sigma=hypot(0.01 * table.noise_percent, max(QUANTUM, step) / 12.0**0.5),
        excess_sigma=excess_sigma,
        gain_sigma=gain_sigma,
        light_sigma=light_sigma,
        albedo=table.albedo,
        step=step,
    )


def _shades(table: CellTable, number: int) -> tuple[Shade, ...]:
    return tuple(_shade(one.axis, one.half_deg) for one in table.shades if one.cell == number)


def _shade(axis: Vec3, half_deg: float) -> Shade:
    return Shade(unit(axis), cos(radians(half_deg)))
