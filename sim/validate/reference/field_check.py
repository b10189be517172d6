"""igrf14.csv: both implementations of the geomagnetic field, Earth-fixed position to Earth-fixed field."""

from collections.abc import Iterator

import numpy as np

from fsw.core.orbit import igrf as onboard
from fsw.core.orbit.igrf_coefficients import EPOCHS_UNIX_S, MAX_DEGREE
from sim.campaign.claim import Threshold
from sim.errors import HarnessError
from sim.plant.environment.igrf import Igrf
from sim.validate.reference.comparison import ReferenceComparison, largest
from sim.validate.reference.reference_table import ReferenceTable, names_of
from sim.value_types import Array

SAME_EPOCHS_NT = 1e-3
"""Rounding of other software near the poles; the formulas agree to 1e-10 nT."""
SAME_FORMULA_NT = 5e-10
"""Rounding of the two implementations of one series."""
OTHER_EPOCHS_NT = 0.5
"""Coefficients linear in decimal years instead of elapsed days differ by up to 0.22 nT."""


def check(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare the plant's field at every row, the onboard one at those in the years of its model.

    Raises:
        HarnessError: a row is malformed or outside the years of the model.
    """
    unix_s = table.unix_s("utc_iso")
    r_m = 1e3 * table.columns(*names_of("r_ecef_", "xyz", "_km"))
    reference_nt = table.columns(*names_of("b_ecef_", "xyz", "_nT"))
    other_nt = table.columns(*names_of("b_decyear_", "xyz", "_nT"))
    _check_places(table, r_m)
    plant_nt = 1e9 * _field_at_rows(table, Igrf(), unix_s, r_m)
    yield ReferenceComparison(
        "plant",
        "Plant's field, IGRF-14 to degree 13",
        "nT",
        largest(plant_nt - reference_nt),
        SAME_EPOCHS_NT,
    )
    yield ReferenceComparison(
        "decimal_years",
        "The same against coefficients linear in decimal years",
        "nT",
        largest(plant_nt - other_nt),
        OTHER_EPOCHS_NT,
    )
    rows = np.flatnonzero((unix_s >= EPOCHS_UNIX_S[0]) & (unix_s <= EPOCHS_UNIX_S[-1]))
    flight_nt = _onboard_nt(unix_s[rows], r_m[rows])
    short_nt = 1e9 * Igrf(MAX_DEGREE).at(unix_s[rows], r_m[rows]) if len(rows) else flight_nt
    yield ReferenceComparison(
        "onboard",
        f"Onboard field against the plant's, both to degree {MAX_DEGREE}",
        "nT",
        largest(flight_nt - short_nt),
        SAME_FORMULA_NT,
        Threshold.OWN,
        rows=rows,
    )
    beyond_nt = plant_nt[rows] - short_nt
    yield ReferenceComparison(
        "onboard_reference",
        f"Onboard field with the plant's degrees above {MAX_DEGREE} added",
        "nT",
        largest(flight_nt + beyond_nt - reference_nt[rows]),
        SAME_EPOCHS_NT,
        rows=rows,
    )


def _onboard_nt(unix_s: Array, r_m: Array) -> Array:
    """The field as it is computed on board, (n, 3)."""
    field_nt = np.zeros_like(r_m)
    for row, (at_s, (x, y, z)) in enumerate(zip(unix_s.tolist(), r_m.tolist(), strict=True)):
        model = onboard.prepare(at_s // 86400.0 * 86400.0)
        field_nt[row] = 1e9 * np.array(onboard.field_ecef_t((x, y, z), at_s, model))
    return field_nt


def _field_at_rows(table: ReferenceTable, model: Igrf, unix_s: Array, r_m: Array) -> Array:
    """The field at all rows; an error gives the first row that the model rejects."""
    try:
        return model.at(unix_s, r_m)
    except ValueError:
        for row, line in enumerate(table.lines):
            try:
                model.at(unix_s[row : row + 1], r_m[row : row + 1])
            except ValueError as error:
                raise HarnessError(f"{table.path}, line {line}, column utc_iso: {error}") from None
        raise


def _check_places(table: ReferenceTable, r_m: Array) -> None:
    for line, r in zip(table.lines, r_m, strict=True):
        if not np.any(r):
            raise HarnessError(f"{table.path}, line {line}, column r_ecef_x_km: the centre of the Earth")
