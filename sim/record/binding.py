"""The binding of a run's files: their SHA-256 digests in run.json, each written when the file is finished.

A digest detects a file that was replaced, edited or lost. It protects against accidents, not against a
forger who rewrites run.json too: for that there is its signature (``sim.record.signature``).
"""

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from fsw.input.gzip_text import open_text
from fsw.input.schema import TableError
from sim.errors import HarnessError, reading
from sim.progress import Watch, progress
from sim.record import run_dir
from sim.record.run_dir import BUS_LOG, DIGESTS, RUN, SCENARIO, SCENARIO_DIGEST, SUMMARY, TRUTH
from sim.record.run_record import RunRecord
from sim.record.signature import PrivateKey, PublicKey, sign, signature_fault

FILES = (SCENARIO, BUS_LOG, TRUTH, SUMMARY)
"""Files of a finished run whose digests are in run.json."""
CHUNK = 1 << 20
BAR_FROM = 400_000_000
"""Size of a file from which a progress bar is shown [bytes]: hashing it takes a second or two."""


class BindingError(HarnessError):
    """Files are not those of their run."""

    exit_code = 1


class Binding(NamedTuple):
    """Result of comparing the files of a run with run.json.

    Attributes:
        mismatches: a sentence for each file that differs from its digest, by the name of the file.
        note: the files without a digest, in a sentence; empty if there are none.
    """

    mismatches: dict[str, str]
    note: str = ""

    @property
    def holds(self) -> bool:
        """Whether nothing contradicts run.json."""
        return not self.mismatches

    @property
    def lines(self) -> list[str]:
        """The lines that a command prints."""
        notes = [f"note: {self.note}"] if self.note else []
        return [f"MISMATCH {sentence}" for sentence in self.mismatches.values()] + notes

    @contextmanager
    def beside_errors(self) -> Iterator[None]:
        """Add the mismatches to the message of an error in the block: one of them may be its cause."""
        try:
            yield
        except (HarnessError, TableError) as error:
            error.args = ("; ".join([str(error), *self.mismatches.values()]),)
            raise


def require_sources(folder: Path, key: PublicKey | None) -> Binding:
    """Compare, and refuse a run in which a source of the summary differs from its digest.

    Raises:
        BindingError: one differs, or is not signed.
        HarnessError: run.json or a file that it binds cannot be read.
    """
    run_dir.read_run(folder)  # raises where there is no run.json
    binding = compare(folder, key=key)
    faults = [sentence for name, sentence in binding.mismatches.items() if name != SUMMARY]
    if faults:
        raise BindingError(f"{folder}: {'; '.join(faults)}")
    return binding


def compare(folder: Path, log: Path | None = None, key: PublicKey | None = None) -> Binding:
    """Compare the files of a run with the digests in its run.json.

    Args:
        folder: of the run; without a run.json nothing is bound.
        log: a log to be compared as the run's, unless it is another of its files; None: its own.
        key: run.json must be signed by its private half, and have a digest of every file.

    Raises:
        HarnessError: run.json or a file that it binds cannot be read.
    """
    if not (folder / RUN).is_file():
        return Binding({} if key is None else {RUN: f"{folder} has no {RUN}, so that nothing is signed"})
    run = run_dir.read_run(folder)
    recorded = digests(run)
    paths = {name: _path(folder, name) for name in (*FILES, *recorded)}
    if log is not None and log.name not in (RUN, SCENARIO, TRUTH, SUMMARY):
        paths[BUS_LOG] = log
    mismatches = {}
    for name, digest in recorded.items():
        if sentence := _mismatch(paths[name], digest):
            mismatches[name] = sentence
    unbound = [name for name in FILES if name not in recorded and paths[name].is_file()]
    if key is not None:
        mismatches |= {name: f"{name} is not signed: {RUN} has no digest of it" for name in unbound}
        if sentence := signature_fault(folder / RUN, key):
            mismatches[RUN] = sentence
    return Binding(mismatches, _note(run, unbound))


def _path(folder: Path, name: str) -> Path:
    return run_dir.bus_log(folder) if name == BUS_LOG else folder / name


def digests(run: RunRecord) -> dict[str, str]:
    """The SHA-256 of each file that a run.json binds, by name."""
    return {SCENARIO: run[SCENARIO_DIGEST], **run.get(DIGESTS, {})}


def bind(folder: Path, *names: str) -> None:
    """Add the digests of finished files; a digest that is there already stays."""
    recorded = run_dir.read_run(folder)[DIGESTS]
    added = {name: sha256_of(_path(folder, name)) for name in names if name not in recorded}
    run_dir.update(folder, **{DIGESTS: {**recorded, **added}})


def release(folder: Path, name: str) -> None:
    """Remove the digest of a file that is about to be rewritten: a kill in between leaves it without one."""
    recorded = run_dir.read_run(folder)[DIGESTS]
    if recorded.pop(name, None) is not None:
        run_dir.update(folder, **{DIGESTS: recorded})


def sign_run(folder: Path, key: PrivateKey) -> None:
    """Sign the run.json of a finished run, and with it every file that it binds.

    Raises:
        BindingError: a file is not bound, or not the run's own.
        HarnessError: run.json or a file that it binds cannot be read.
    """
    faults = list(compare(folder).mismatches.values())
    recorded = digests(run_dir.read_run(folder))
    if missing := [name for name in FILES if name not in recorded]:
        faults.append(f"{RUN} has no digests of {', '.join(missing)}")
    if faults:
        raise BindingError(f"{folder} is not signed: {'; '.join(faults)}")
    sign(folder / RUN, key)


def sha256_of(path: Path, watch: Watch = lambda size: None) -> str:
    """The digest of a file in hex; for a compressed one, that of its text.

    ``watch`` is called with how much of the file has been read, in bytes.

    Raises:
        HarnessError: it cannot be read.
    """
    sha256 = hashlib.sha256()
    with reading(path), open_text(path) as file:
        while chunk := file.read(CHUNK):
            sha256.update(chunk)
            watch(os.lseek(file.fileno(), 0, os.SEEK_CUR))
    return sha256.hexdigest()


def _mismatch(path: Path, digest: str) -> str:
    """How a file of the run differs from its digest, in a sentence; empty if it does not."""
    if not path.is_file():
        return f"{path.name} is missing, and {RUN} has its digest"
    size = path.stat().st_size
    if size < BAR_FROM:
        found = sha256_of(path)
    else:
        with progress(f"reading {path.name}", size) as watch:
            found = sha256_of(path, watch)
    if found == digest:
        return ""
    return f"{path.name} is not the run's own: its SHA-256 begins with {found[:12]}, in {RUN} {digest[:12]}"


def _note(run: RunRecord, unbound: list[str]) -> str:
    if not unbound:
        return ""
    names = ", ".join(unbound)
    if DIGESTS not in run:
        return f"{RUN} is of an older version: no digests of {names}"
    return f"the run was not finished: no digests of {names}"
