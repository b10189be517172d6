"""What tasks that fly have given, kept outside the project: work that was stopped goes on where it was.

A result lies under a digest of its function, its arguments and all code that these load, so that other code
finds nothing of it. Only tasks whose arguments are values and functions of the project are kept. The folder
may be deleted at any time; what no one has asked for in ``KEPT_FOR_S`` is.
"""

import hashlib
import json
import os
import pickle
import time
import zlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from enum import Enum
from errno import EPERM
from functools import partial
from pathlib import Path
from types import FunctionType
from typing import Any

from sim.campaign.claim import Study, Task
from sim.campaign.code_digest import PACKAGES, code_digest
from sim.console import counted
from sim.errors import HarnessError
from sim.progress import note
from sim.record.whole_file import replace_file

VARIABLE = "TORQUER_CACHE"
"""Of the environment: the folder; empty: nothing is kept."""
KEPT_FOR_S = 60 * 86400.0
SUFFIX = ".result"


@dataclass(frozen=True, slots=True)
class CachedTask:
    """A task whose result is kept in a file: it is read from there if it is there."""

    task: Task
    path: Path

    def __call__(self) -> Any:  # noqa: ANN401  (as in Task)
        """The result."""
        try:
            result = pickle.loads(zlib.decompress(self.path.read_bytes()))
        except Exception:
            result = self.task()
            _write(self.path, result)
            return result
        with suppress(OSError):  # then it counts as old a little earlier
            os.utime(self.path)
        return result


def with_cache(studies: Sequence[Study], folder: Path | None = None) -> list[Study]:
    """The studies, each task that flies one whose result is kept; how many are known is noted.

    Where the user's cache folder cannot be made, all is computed.

    Args:
        studies: any; those without flights stay as they are.
        folder: None: ``cache_folder()``.

    Raises:
        HarnessError: the folder that the environment names cannot be made.
    """
    folder = folder or cache_folder()
    if folder is None:
        return list(studies)
    try:
        _prepare(folder)
    except OSError as error:
        why = f"{folder} keeps no results ({error.strerror})"
        if VARIABLE in os.environ:
            raise HarnessError(f"{VARIABLE}: {why}") from None
        note(f"{why}: all is computed")
        return list(studies)
    cached = [_cached(study, folder) if study.has_flights else study for study in studies]
    tasks = [task for study in cached for task in study.tasks if isinstance(task, CachedTask)]
    if known := sum(task.path.exists() for task in tasks):
        note(f"{folder}: {known} of {counted(len(tasks), 'result')} known; {VARIABLE}= computes all")
    return cached


def cache_folder() -> Path | None:
    """Where results are kept; None: nowhere."""
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) if named else None
    of_user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return None if of_user.startswith("~") else Path(of_user) / "torquer"


def _prepare(folder: Path) -> None:
    """Make it, for this user alone, and delete from it what is old."""
    oldest = time.time() - KEPT_FOR_S
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if os.name == "posix" and (folder.stat().st_uid != os.getuid() or folder.stat().st_mode & 0o022):
        raise PermissionError(EPERM, "others may write there, and what is read from it runs as this user")
    for path in folder.glob(f"*/*{SUFFIX}"):
        with suppress(FileNotFoundError):  # another process may have been first
            if path.stat().st_mtime < oldest:
                path.unlink()


def _write(path: Path, result: object) -> None:
    """Keep a result; what cannot be kept is computed again the next time."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, zlib.compress(pickle.dumps(result), 1))
    except OSError as error:
        note(f"{path}: a result cannot be kept ({error.strerror})")


def _cached(study: Study, folder: Path) -> Study:
    digests = ((task, task_digest(task)) for task in study.tasks)
    tasks = (
        task if digest is None else CachedTask(task, folder / digest[:2] / (digest + SUFFIX))
        for task, digest in digests
    )
    return replace(study, tasks=tuple(tasks))


def task_digest(task: Task) -> str | None:
    """What distinguishes a task from others, and its code from other code; None where nothing does."""
    try:
        text = json.dumps(_canonical(task), sort_keys=True)
    except TypeError:
        return None
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _canonical(value: object) -> object:
    """A value as one that JSON can write, the same for equal values and another for others.

    Raises:
        TypeError: it cannot be distinguished from others, as a path, which does not say what is in the file.
    """
    if value is None or (isinstance(value, bool | int | float | str) and not isinstance(value, Enum)):
        return value
    kind = f"{type(value).__module__}.{type(value).__qualname__}"
    parts: object
    if isinstance(value, Enum):
        parts = str(value)
    elif isinstance(value, FunctionType):
        parts = _of_project(value)
    elif isinstance(value, partial):
        parts = _canonical((value.func, value.args, value.keywords))
    elif is_dataclass(value) and not isinstance(value, type):
        parts = [_canonical(getattr(value, field.name)) for field in fields(value)]
    elif isinstance(value, tuple | list):
        parts = [_canonical(one) for one in value]
    elif isinstance(value, dict) and all(isinstance(key, str) for key in value):
        parts = {key: _canonical(one) for key, one in value.items()}
    else:
        raise TypeError(f"{kind} cannot be distinguished from others")
    return [kind, parts]


def _of_project(function: FunctionType) -> list[str]:
    """A function of a module of the project, with the digest of the code that it loads."""
    if function.__module__.partition(".")[0] not in PACKAGES or "<" in function.__qualname__:
        raise TypeError(f"{function} is not of the project")
    return [function.__module__, function.__qualname__, code_digest(function.__module__)]
