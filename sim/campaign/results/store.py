"""results.sqlite: one row per run, committed when the run is done.

Table ``runs`` depends on campaign and version alone, however it was flown: the columns are known before the
first run, and what differs from one flight to the next (wall time, worker, attempts) is in ``attempts``.
``profiles`` has the arrays of a run, ``meta`` the versions and the campaign that the rows are of.
"""

import json
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from enum import StrEnum
from importlib.metadata import version
from itertools import islice
from pathlib import Path

import numpy as np

from sim.campaign.code_digest import code_digest
from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.columns import NUMBERS, TEXTS, Cell, input_cells, requirement_kinds
from sim.campaign.results.consistency import find_contradiction, quoted
from sim.errors import HarnessError, needing
from sim.record.run_dir import fingerprint
from sim.record.whole_file import replacing
from sim.value_types import Array

# --- The result of a run, as it travels from a worker to the results


class Status(StrEnum):
    """What became of a run."""

    DONE = "done"
    FAILED = "failed"
    """It was not flown to its end; ``failure`` says why."""


@dataclass(frozen=True, slots=True)
class RunRow:
    """A run.

    Attributes:
        run: its number.
        status: whether it was flown.
        failure: why it was not, in a sentence; otherwise empty.
        seed: of the plant's random streams.
        success: whether it meets all requirements and kept the limits of the coils.
        missed: the requirements that it does not meet, as text.
        cells: inputs, figures and digests by column.
        profiles: by name, arrays of 4-byte floats, little-endian.
        wall_s: how long it took.
        worker: which process flew it.
    """

    run: int
    status: Status
    failure: str
    seed: int
    success: bool
    missed: str
    cells: dict[str, Cell]
    profiles: dict[str, bytes] = field(default_factory=dict)
    wall_s: float = 0.0
    worker: str = ""


# --- The file

RESULTS, LOCK = "results.sqlite", "campaign.lock"
CODE = "code_digest"
"""Key in ``meta`` of the digest of the code that began the campaign; results of before it have none."""
SCHEMA_VERSION = 1
DIGESTS = ("frames_sha256", "commands_sha256")
FIGURES = dict.fromkeys(NUMBERS, "REAL") | dict.fromkeys((*TEXTS, *DIGESTS), "TEXT")
"""Columns that every campaign has, each with its type in SQLite."""
_TABLES = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE runs (run INTEGER PRIMARY KEY, status TEXT NOT NULL, failure TEXT NOT NULL,
    seed INTEGER NOT NULL, success INTEGER NOT NULL, missed TEXT NOT NULL{columns});
CREATE TABLE profiles (run INTEGER NOT NULL, name TEXT NOT NULL, f4 BLOB NOT NULL, PRIMARY KEY (run, name));
CREATE TABLE attempts (run INTEGER NOT NULL, at_utc TEXT NOT NULL, worker TEXT NOT NULL,
    wall_s REAL NOT NULL, failure TEXT NOT NULL);
"""
_BESIDE = ("-wal", "-shm", "-journal")
"""Ends of the names of files that SQLite keeps beside a database."""


class ResultsLostError(HarnessError):
    """The results cannot be written any longer."""

    exit_code = 1


class Results:
    """The results of a campaign, open for reading and writing."""

    def __init__(self, connection: sqlite3.Connection, path: Path) -> None:
        self._connection = connection
        self.path = path

    def add(self, row: RunRow) -> None:
        """Store a run, in one transaction; an earlier row of it is replaced."""
        values: dict[str, Cell] = {
            "run": row.run, "status": row.status.value, "failure": row.failure, "seed": row.seed,
            "success": int(row.success), "missed": row.missed, **row.cells,
        }  # fmt: skip
        now = datetime.now(UTC).isoformat(timespec="seconds")
        with self._connection as connection:
            connection.execute(
                f"REPLACE INTO runs ({', '.join(map(quoted, values))}) VALUES ({_marks(values)})",
                tuple(values.values()),
            )
            connection.execute("DELETE FROM profiles WHERE run = ?", (row.run,))
            connection.executemany(
                "INSERT INTO profiles VALUES (?, ?, ?)",
                [(row.run, name, content) for name, content in row.profiles.items()],
            )
            connection.execute(
                "INSERT INTO attempts VALUES (?, ?, ?, ?, ?)",
                (row.run, now, row.worker, row.wall_s, row.failure),
            )

    def runs(self, status: Status | None = None) -> list[int]:
        """The numbers of the runs that have a row, with this status if one is given."""
        return [run for (run,) in self.each(("run",), status) if isinstance(run, int)]

    def kinds(self) -> dict[str, str]:
        """The columns of ``runs``, each with its type in SQLite."""
        return {name: kind for _, name, kind, *_ in self._connection.execute("PRAGMA table_info(runs)")}

    def each(self, names: Sequence[str], status: Status | None = None) -> Iterator[tuple[Cell, ...]]:
        """These columns of the runs in order."""
        where, arguments = ("", ()) if status is None else (" WHERE status = ?", (status.value,))
        wanted = ", ".join(map(quoted, names))
        yield from self._connection.execute(f"SELECT {wanted} FROM runs{where} ORDER BY run", arguments)

    def numbers(self, names: Sequence[str]) -> dict[str, Array]:
        """These columns of the runs that were flown, NaN where a run has no figure."""
        if not names:
            return {}
        rows = np.array(list(self.each(names, Status.DONE)), dtype=float).reshape(-1, len(names))
        return dict(zip(names, rows.T, strict=True))

    def row(self, run: int) -> dict[str, Cell] | None:
        """The row of a run by column; None if it has none."""
        cursor = self._connection.execute("SELECT * FROM runs WHERE run = ?", (run,))
        found = cursor.fetchone()
        return found and dict(zip((name for name, *_ in cursor.description), found, strict=True))

    def profiles(self, name: str) -> dict[int, Array]:
        """An array of each run that has it, by run."""
        rows = self._connection.execute("SELECT run, f4 FROM profiles WHERE name = ? ORDER BY run", (name,))
        return {run: np.frombuffer(content, "<f4").astype(float) for run, content in rows}

    def meta(self, key: str) -> str:
        """A value of ``meta``.

        Raises:
            HarnessError: it is missing.
        """
        found = self._connection.execute("SELECT value FROM meta WHERE key = ?", (key,)).fetchone()
        if found is None:
            raise HarnessError(f"{self.path}: no results of a campaign: {key} is missing")
        return str(found[0])

    def all_meta(self) -> dict[str, str]:
        """All of ``meta``."""
        return dict(self._connection.execute("SELECT key, value FROM meta"))


@contextmanager
def open_results(folder: Path, campaign: Campaign) -> Iterator[Results]:
    """The results in a folder, created if there are none; no other process may write them meanwhile.

    Raises:
        HarnessError: they are of another campaign or version, being written, or no results at all.
    """
    with _lock(folder / LOCK), _database(folder / RESULTS) as results:
        if not results.kinds():
            _create(results, campaign)
        _check(results, campaign)
        yield results


@contextmanager
def read_results(folder: Path) -> Iterator[Results]:
    """The results of a campaign, while it is flown or later.

    Raises:
        HarnessError: there are none, or they are of another version.
    """
    path = folder / RESULTS
    if not path.is_file():
        raise HarnessError(f"{folder} has no {RESULTS}")
    with _database(path) as results:
        _check(results, None)
        yield results


def _check_no_link(path: Path) -> None:
    """Check that a database and what SQLite writes beside it lie in this folder.

    Raises:
        HarnessError: one of its files is a symbolic link.
    """
    for name in (path.name + suffix for suffix in ("", *_BESIDE)):
        if path.with_name(name).is_symlink():
            raise HarnessError(f"{path.with_name(name)} is a symbolic link, through which nothing is written")


@contextmanager
def _database(path: Path) -> Iterator[Results]:
    _check_no_link(path)
    try:
        with closing(sqlite3.connect(path, timeout=60.0)) as connection:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = NORMAL")
            yield Results(connection, path)
    except sqlite3.OperationalError as error:  # such as a full disk
        raise ResultsLostError(f"{path}: {error}") from None
    except sqlite3.DatabaseError as error:
        raise HarnessError(f"{path}: {error}") from None
    except UnicodeDecodeError:  # SQLite says what is malformed in its own bytes
        raise HarnessError(f"{path}: malformed database, with text that is not UTF-8") from None


@contextmanager
def _lock(path: Path) -> Iterator[None]:
    """Hold a lock that ends with this process, however it ends."""
    _check_no_link(path)
    with closing(sqlite3.connect(path, timeout=0.0, isolation_level=None)) as connection:
        try:
            connection.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError:
            raise HarnessError(f"{path.parent}: another process is flying this campaign") from None
        yield


def _create(results: Results, campaign: Campaign) -> None:
    inputs = input_cells(campaign.draw(0).inputs)
    kinds = {name: "TEXT" if isinstance(value, str) else "NUMERIC" for name, value in inputs.items()}
    kinds |= FIGURES | requirement_kinds(len(campaign.base["requirement"]))
    columns = "".join(f", {quoted(name)} {kind}" for name, kind in kinds.items())
    meta = {
        "schema_version": str(SCHEMA_VERSION),
        "torquer_version": version("torquer"),
        CODE: code_digest(),
        "campaign_sha256": campaign.digest,
        "platform": json.dumps(fingerprint()),
    }
    with results._connection as connection:
        connection.execute("BEGIN IMMEDIATE")  # all tables or none
        for statement in _TABLES.format(columns=columns).split(";")[:-1]:
            connection.execute(statement)
        connection.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())


def _check(results: Results, campaign: Campaign | None) -> None:
    found = results.meta("schema_version")
    if found != str(SCHEMA_VERSION):
        raise HarnessError(f"{results.path}: schema_version is {found}, only {SCHEMA_VERSION} can be read")
    if campaign is not None:
        _check_campaign(results, campaign)
    requirements = campaign.requirements if campaign is not None else ()
    if contradiction := find_contradiction(results._connection, results.kinds(), requirements):
        raise HarnessError(f"{results.path}: {contradiction}")


def _check_campaign(results: Results, campaign: Campaign) -> None:
    folder, kinds = results.path.parent, results.kinds()
    wanted = FIGURES | requirement_kinds(len(campaign.base["requirement"]))
    if absent := [name for name in wanted if name not in kinds]:
        raise HarnessError(
            f"{folder} was begun by an older torquer, whose runs have no {absent[0]}: choose another --out"
        )
    if results.meta("campaign_sha256") != campaign.digest:
        raise HarnessError(
            f"{folder} holds the runs of another campaign, which differs in more than the number of runs, "
            "or of another version of torquer: choose another --out"
        )


def _marks(values: dict[str, Cell]) -> str:
    return ", ".join("?" * len(values))


# --- Export of the results to Parquet, for pandas, DuckDB, Spark and the like

ROWS_A_GROUP = 10_000


def check_parquet() -> None:
    """Check that the results can be exported, before anything is flown.

    Raises:
        HarnessError: the package pyarrow is missing.
    """
    with needing("--parquet", "pyarrow", "parquet"):
        import pyarrow.parquet  # noqa: F401, PLC0415  an extra


def export(results: Results, path: Path) -> None:
    """Write table ``runs``, column by column as in SQLite; numbers are doubles, a missing figure is null.

    Raises:
        HarnessError: the package pyarrow is missing.
    """
    check_parquet()
    import pyarrow as pa  # noqa: PLC0415  an extra
    import pyarrow.parquet as pq  # noqa: PLC0415  an extra

    kinds = {"INTEGER": pa.int64(), "TEXT": pa.string(), "REAL": pa.float64(), "NUMERIC": pa.float64()}
    schema = pa.schema([(name, kinds[kind]) for name, kind in results.kinds().items()])
    schema = schema.with_metadata(results.all_meta())
    rows = results.each(schema.names)
    with replacing(path) as temporary, pq.ParquetWriter(temporary, schema) as writer:
        while block := list(islice(rows, ROWS_A_GROUP)):
            columns = zip(*block, strict=True)
            arrays = [pa.array(column, kind) for column, kind in zip(columns, schema.types, strict=True)]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
