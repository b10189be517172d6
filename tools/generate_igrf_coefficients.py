"""Write igrf_coefficients.py of the core from the IGRF-14 table; --check: exit 1 when the file is stale."""

import sys
from pathlib import Path

from sim.record.whole_file import replace_text

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "sim" / "plant" / "environment" / "igrf14.shc"
MODULE = ROOT / "fsw" / "core" / "orbit" / "igrf_coefficients.py"
DEGREE = 10
YEARS = (2015, 2020, 2025, 2030)

HEADER = '''"""Gauss coefficients of IGRF-14 to degree {degree}.

Written by tools/generate_igrf_coefficients.py. Do not edit.

Source: IAGA Division V-MOD, International Geomagnetic Reference Field, 14th generation, file IGRF14.shc,
doi 10.5281/zenodo.14012302. The last column is the 2025 model plus five years of its secular variation.
"""

EPOCHS_UNIX_S = {epochs}
"""{dates}, each 1 January 00:00 UTC."""

MAX_DEGREE = {degree}

COEFFICIENTS_NT: tuple[tuple[int, int, float, float, float, float], ...] = (
'''


def unix_s(year: int) -> int:
    leap_days = (year - 1969) // 4
    return 86400 * (365 * (year - 1970) + leap_days)


def module_text(table: str) -> str:
    lines = [line.split() for line in table.splitlines() if not line.startswith("#")]
    years = [float(year) for year in lines[1]]
    columns = [2 + years.index(year) for year in YEARS]
    rows = [
        f"    ({n}, {m}, {', '.join(repr(float(line[column])) for column in columns)}),\n"
        for line in lines[2:]
        for n, m in [(int(line[0]), int(line[1]))]
        if n <= DEGREE
    ]
    header = HEADER.format(
        degree=DEGREE,
        epochs=tuple(unix_s(year) for year in YEARS),
        dates=", ".join(str(year) for year in YEARS),
    )
    return (
        header
        + "".join(rows)
        + ')\n"""Rows (degree n, order m, value at each epoch): g(n, m) for m >= 0, h(n, -m) for m < 0."""\n'
    )


def main() -> int:
    text = module_text(TABLE.read_text(encoding="utf-8"))
    if "--check" in sys.argv[1:]:
        return 0 if MODULE.read_text(encoding="utf-8") == text else 1
    replace_text(MODULE, text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
