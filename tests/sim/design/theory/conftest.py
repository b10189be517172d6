"""Bodies and reference multipliers for the design tests."""

import csv

import pytest

from sim.design.theory.bodies import Body, diagonal
from sim.validate.reference.reference_table import DATA

REFERENCE = DATA / "floquet.csv"


def reference_rows():
    """The rows of the reference file, as numbers where they are numbers."""
    lines = REFERENCE.read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert len(rows) == 12
    return [
        {key: value if key in ("name", "gg") else float(value) for key, value in row.items()} for row in rows
    ]


def pytest_generate_tests(metafunc):
    if "row" in metafunc.fixturenames:
        rows = reference_rows()
        metafunc.parametrize("row", rows, ids=[row["name"] for row in rows])


@pytest.fixture
def reference_body(row):
    """The satellite of a row."""
    return Body(
        row["name"], diagonal((row["A"], row["B"], row["C"])), row["altitude_km"], row["inclination_deg"]
    )


@pytest.fixture(scope="session")
def skewed():
    """A body with three different moments and all products of inertia, on an inclined orbit."""
    tensor = ((1.02, 0.11, -0.07), (0.11, 1.85, 0.05), (-0.07, 0.05, 2.35))
    return Body("skewed", tensor, 731.0, 63.0)
