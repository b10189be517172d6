"""What tells the code of one flight from the code of another, by the text of its files."""

import hashlib
from functools import cache
from pathlib import Path

import sim
from sim.errors import HarnessError

HOUSE = Path(sim.__file__).resolve().parents[1]
FLIGHT_CODE = (
    "fsw",
    "hil_stub",
    "sim/audit",
    "sim/campaign",
    "sim/design/from_scenario.py",
    "sim/design/theory",
    "sim/faults",
    "sim/flight",
    "sim/plant",
    "sim/record",
    "sim/replay",
    "sim/report",
    "sim/scenario",
    "sim/statistics",
)
"""Folders and files that a flight and its figures follow from."""
SUFFIXES = (".py", ".toml", ".dbc")


@cache
def code_digest(parts: tuple[str, ...] = FLIGHT_CODE, house: Path = HOUSE) -> str:
    """The same for the same text of some folders and files; by default all that flights follow from.

    Raises:
        HarnessError: one of them is not there, so that its changes would go unnoticed.
    """
    digest = hashlib.sha256()
    for part in (house / part for part in parts):
        whole = [part] if part.is_file() else sorted(part.rglob("*"))
        files = [path for path in whole if path.suffix in SUFFIXES]
        if not files:
            raise HarnessError(f"{part}: holds no code to tell from other code")
        for path in files:
            digest.update(path.relative_to(house).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]
