"""The run directory: its files, and run.json, which is replaced atomically."""

import hashlib
import json
import os
import platform
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from fsw.compiled import standing
from fsw.core.estimation.kalman import Algebra, available
from fsw.input import gzip_text
from fsw.input.own_code import given_as
from fsw.input.schema import Nested, TableError
from sim.errors import HarnessError, writing
from sim.record.destination import check_folder
from sim.record.destination import new_folder as dated_folder
from sim.record.log_index import SUFFIX
from sim.record.pace import Pace
from sim.record.run_record import SCHEMA_VERSION, RunRecord, read_record
from sim.record.whole_file import replace_file
from sim.scenario.law_named import with_law_withheld
from sim.scenario.schema import Scenario, flight_table, load
from sim.scenario.written import scenario_toml
from sim.value_types import Json

RUN, SCENARIO, BUS_LOG, TRUTH, SUMMARY, REPORT = (
    "run.json",
    "scenario.toml",
    "bus.log",
    "truth.h5",
    "summary.json",
    "report.html",
)
SCENARIO_DIGEST: Final = "scenario_sha256"
DIGESTS: Final = "digests"
"""Keys of run.json: SHA-256 of the scenario, and of further files by name, added when each is finished."""
COMPRESSED_LOG = BUS_LOG + gzip_text.SUFFIX
FILES = (RUN, SCENARIO, BUS_LOG, COMPRESSED_LOG, BUS_LOG + SUFFIX, TRUTH, SUMMARY, REPORT)
RESULTS = (RUN, SUMMARY, REPORT)
"""Files written when a flight is over, and again by ``torquer report``."""


def new_folder(scenario: Scenario) -> Path:
    """Create ``runs/<scenario>-<UTC time>``, a folder of this call alone.

    Raises:
        HarnessError: it cannot be created.
    """
    return dated_folder(Path("runs"), scenario.name)


def bus_log(folder: Path) -> Path:
    """The log of a run, compressed or not."""
    return gzip_text.stored(folder / BUS_LOG)


def begin(
    out: Path | None, scenario: Scenario, seed: int, ticks: int, bus: str, pace: Pace, compress: bool = False
) -> Path:
    """Create the directory with scenario.toml and a run.json that says ``complete: false``.

    Args:
        out: the directory; None: a new folder of ``runs``.
        scenario: of the run.
        seed: of all random streams.
        ticks: length of the flight.
        bus: kind of the bus.
        pace: of the flight.
        compress: whether its log will be compressed.

    Returns:
        The directory.

    Raises:
        TableError: its scenario could not be read again; nothing was created.
        HarnessError: the directory holds a run already, or cannot be written.
    """
    text = scenario_toml(scenario, f"scenario {scenario.name}")
    path = out or new_folder(scenario)
    check_folder(path)
    if any(os.path.lexists(path / name) for name in FILES):
        raise HarnessError(f"{path} already holds a run: choose another --out")
    with writing(path):
        replace_file(path / SCENARIO, text.encode())
        write_json(
            path / RUN,
            {
                "schema_version": SCHEMA_VERSION,
                "torquer_version": version("torquer"),
                "scenario": scenario.name,
                SCENARIO_DIGEST: hashlib.sha256(text.encode()).hexdigest(),
                "flight_table_crc": f"{flight_table(scenario).crc:08x}",
                "seed": seed,
                "ticks": ticks,
                "bus": bus,
                "pace": "lockstep" if pace.factor is None else "realtime",
                "pace_factor": pace.factor,
                "compressed": compress,
                "code": standing().code,
                "platform": fingerprint(),
                "algebra": available(Algebra(flight_table(scenario).estimator.algebra)),
                **_law_object(scenario),
                DIGESTS: {},
                "complete": False,
            },
        )
    return path


def _law_object(scenario: Scenario) -> Json:
    """The key of run.json that a law has which was given as an object."""
    control = flight_table(scenario).control
    given = given_as(control.law)
    if given is None:
        return {}
    module, name = given
    return {"law_object": {"module": module, "qualname": name, "source_sha256": control.law_sha256}}


def update(path: Path, **values: object) -> None:
    """Replace run.json with these values changed."""
    write_json(path / RUN, {**read_run(path), **values})


def read_run(path: Path) -> RunRecord:
    """The content of run.json.

    Raises:
        HarnessError: missing, not JSON, of another version, or a key is missing or not what it should be.
    """
    try:
        return read_record(path / RUN)
    except (FileNotFoundError, NotADirectoryError):
        raise HarnessError(f"{path} is no run directory: it has no {RUN}") from None
    except OSError as error:
        raise HarnessError(f"{path / RUN}: cannot be read ({error.strerror})") from None


def read_scenario(path: Path) -> Scenario:
    """The resolved scenario of a run; a user law is withheld until it is named again.

    Raises:
        HarnessError: missing or no longer valid.
    """
    try:
        return with_law_withheld(load(str(path / SCENARIO)))
    except TableError as error:
        raise HarnessError(str(error)) from None


def scenario_of_log(log: Path, folder: Path, named: str | None, settings: Nested) -> Scenario:
    """The scenario by which a log is judged: that of its folder, unless one is named.

    Args:
        log: the log.
        folder: where the files of its run would lie, as ``locate`` gives both.
        named: a shipped scenario or a path; None: none.
        settings: laid over it.

    Raises:
        HarnessError: there is none.
        TableError: it is not valid.
    """
    beside = folder / SCENARIO
    if named is None and not beside.is_file():
        raise HarnessError(f"{log}: no {SCENARIO} beside it: name its scenario by --scenario")
    return load(named or str(beside), settings)


def write_json(path: Path, content: Json) -> None:
    """Replace a JSON file atomically."""
    replace_file(path, (json.dumps(content, indent=2) + "\n").encode())


def identity(scenario: Scenario, seed: int) -> dict[str, int | str]:
    """What identifies a flight in files that may leave its directory."""
    return {
        "scenario": scenario.name,
        "seed": seed,
        "epoch_utc": datetime.fromtimestamp(scenario.epoch_unix_s, UTC).isoformat(),
        "epoch_unix_s": scenario.epoch_unix_s,
        "tick_hz": scenario.time.tick_hz,
        "torquer_version": version("torquer"),
    }


def locate(run_or_log: Path) -> tuple[Path, Path]:
    """(log, folder) of a run directory or of a log file.

    Raises:
        HarnessError: neither exists.
    """
    if os.path.isdir(run_or_log):  # unlike Path.is_dir, never an error, whatever the name
        log = bus_log(run_or_log)
        if not log.is_file():
            raise HarnessError(f"{run_or_log} has no {BUS_LOG}")
        return log, run_or_log
    if not os.path.isfile(run_or_log):
        raise HarnessError(f"{run_or_log} does not exist")
    return run_or_log, run_or_log.parent


def fingerprint() -> Json:
    """What the last bit of a result depends on: CPU, Python, numpy and its linear algebra, the kernel."""
    config: Any = np.show_config(mode="dicts")
    blas = config["Build Dependencies"]["blas"]
    return {
        "machine": platform.machine(),
        "cpu": _cpu_model(),
        "system": platform.system(),
        "libc": " ".join(platform.libc_ver()),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "simd": config["SIMD Extensions"],
        "blas": f"{blas.get('name')} {blas.get('version')}",
        "blas_core": os.environ.get("OPENBLAS_CORETYPE", ""),
        "algebra": available(Algebra.KERNEL),
    }


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    values = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    return " ".join(
        values.get(key, "") for key in ("vendor_id", "model name", "cpu family", "model", "stepping")
    ).strip()


# --- The figures for papers

FigureKind = Literal["pdf", "svg"]
FIGURES = "figures"
"""In that of the run."""


def figure_folder(run: Path) -> Path:
    """The folder, made if it is not there.

    Raises:
        HarnessError: it cannot be written, or is a link, which may lead out of the run.
    """
    folder = run / FIGURES
    if folder.is_symlink():
        raise HarnessError(f"{folder} is a symbolic link, through which nothing is written")
    check_folder(folder)
    return folder
