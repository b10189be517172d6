"""The user's own code that a table names: ``FILE.py:NAME``, or the name of an entry point.

Finding it reads its source and gives its SHA-256; only loading it executes it, and only if its source has
the digest that was named. ``object MODULE:NAME`` names what a program has given as an object: there is no
source to execute, and it is neither found nor loaded here.
"""

import hashlib
import re
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from fsw.input.regular_file import read_regular
from fsw.input.schema import TableError

MOST_BYTES = 1_000_000
LONGEST_ERROR = 300
"""Most characters of an error of the user's code in a sentence."""
GUARD = 'put the call under if __name__ == "__main__"'

_IN_FILE = re.compile(r"(?P<file>.+\.py):(?P<name>[A-Za-z_]\w{0,99})", re.S)
_GIVEN = re.compile(r"object (?P<module>[^:]*):(?P<name>[^:]+)", re.S)
_LOADING: ContextVar[tuple[str, ...]] = ContextVar("loading", default=())
"""What is being executed for what it defines, the innermost last."""


class Found(NamedTuple):
    """Code that a table names: the reference, with an absolute path, and the SHA-256 of its source in hex."""

    reference: str
    sha256: str


def in_file(reference: str) -> bool:
    """Whether a reference is of the form ``FILE.py:NAME``."""
    return _IN_FILE.fullmatch(reference) is not None


def given_as(reference: str) -> tuple[str, str] | None:
    """Module and qualified name of what was given as an object; None: a reference of another form."""
    match = None if in_file(reference) else _GIVEN.fullmatch(reference)
    return (match["module"], match["name"]) if match else None


def short_name(reference: str) -> str:
    """The NAME of ``FILE.py:NAME``, or the last of an object's; the name of an entry point as it is."""
    match, given = _IN_FILE.fullmatch(reference), given_as(reference)
    if given is not None:
        return given[1].rpartition(".")[2]
    return match["name"] if match else reference


def display(reference: str) -> str:
    """A reference without the folders of its file."""
    match, given = _IN_FILE.fullmatch(reference), given_as(reference)
    if given is not None:
        return f"{given[1]} of {given[0]}, given as an object"
    return f"{match['name']} of {Path(match['file']).name}" if match else reference


def is_running(reference: str) -> bool:
    """Whether a reference is of the very file that Python runs as its script."""
    match = _IN_FILE.fullmatch(reference)
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    if match is None or not isinstance(script, str):
        return False
    return Path(script).resolve() == Path(match["file"]).resolve()


def refuse_while_loading(what: str) -> None:
    """Refuse what flies, in a file that is executed for what it defines: it would fly each time that it is.

    Raises:
        TableError: such a file is being executed.
    """
    if _LOADING.get():
        raise TableError(f"{what}: a file that is loaded for what it defines flies nothing: {GUARD}")


def find(reference: str, folder: Path, group: str) -> Found | None:
    """Where the code is, and its digest; nothing is executed.

    Args:
        reference: as a table has it.
        folder: base of a relative path.
        group: of entry points.

    Returns:
        None: there is no entry point of that name.

    Raises:
        TableError: the source cannot be read.
    """
    match = _IN_FILE.fullmatch(reference)
    if match:
        path = (folder / match["file"]).absolute()
        return Found(f"{path}:{match['name']}", _sha256([path], path.parent))
    entry = _entry(reference, group)
    return None if entry is None else Found(reference, _package_sha256(entry))


def load(reference: str, sha256: str | None, group: str, afresh: bool = False) -> object:
    """Execute the code, and return what it has under the name; the script that runs is not executed again.

    Args:
        reference: as ``find`` gives it.
        sha256: the one that its source must have; None: any.
        group: of entry points.
        afresh: execute the script that runs as well, as another process does.

    Raises:
        TableError: it is not there, its source has another digest, it fails, it has no such name, or it is
            being executed already.
    """
    found = find(reference, Path(), group)
    if found is None:
        raise TableError(f"{reference!r} is not installed: no package offers it in the group {group}")
    if sha256 not in (None, found.sha256):
        raise TableError(
            f"{reference}: its source has the SHA-256 {found.sha256[:16]}..., not {str(sha256)[:16]}..."
        )
    match = _IN_FILE.fullmatch(reference)
    if match and is_running(reference) and not afresh:
        return _of_script(match["file"], match["name"])
    with _while_loading(match["file"] if match else reference):
        if match:
            return _of_file(Path(match["file"]), match["name"], found.sha256)
        return _of_entry(reference, group)


@contextmanager
def _while_loading(what: str) -> Iterator[None]:
    if what in _LOADING.get():
        raise TableError(f"{what} asks for what it defines while it is loaded for it: {GUARD}")
    before = _LOADING.set((*_LOADING.get(), what))
    try:
        yield
    finally:
        _LOADING.reset(before)


def error_clause(error: BaseException, file: str = "") -> str:
    """An error of the user's code: its kind, its text, and the line of the user's file where it arose."""
    text = f"{type(error).__name__}: {_text(error)}".rstrip(": ")
    if isinstance(error, SyntaxError):
        return f"line {error.lineno}: {error.msg}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return f"line {lines[-1]}: {text}" if lines else text


def _text(error: BaseException) -> str:
    try:
        return str(error)[:LONGEST_ERROR]
    except Exception:  # its own __str__ fails
        return "without a text"


def _of_script(file: str, name: str) -> object:
    """What the script that runs has under the name."""
    defined = vars(sys.modules["__main__"])
    if name not in defined:
        raise TableError(
            f"{file}: there is no {name} in it yet: define it above the call, or {GUARD} at its end"
        )
    found: object = defined[name]
    return found


def _of_entry(name: str, group: str) -> object:
    entry = _entry(name, group)
    assert entry is not None
    try:
        return entry.load()
    except (Exception, SystemExit) as error:
        raise TableError(f"{name} ({entry.value}): {error_clause(error)}") from None


def _of_file(path: Path, name: str, sha256: str) -> object:
    """Execute the file as a fresh module, so that nothing is left of an earlier flight."""
    module = ModuleType(f"torquer_own_{sha256[:16]}")
    module.__file__ = str(path)
    source = _read(path)
    if hashlib.sha256(source).hexdigest() != sha256:
        raise TableError(f"{path} has changed while it was read")
    sys.modules[module.__name__] = module  # dataclasses look their module up
    try:
        exec(compile(source, str(path), "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        raise TableError(f"{path}: {error_clause(error, str(path))}") from None
    if name not in module.__dict__:
        raise TableError(f"{path}: there is no {name} in it")
    found: object = module.__dict__[name]
    return found


def _entry(name: str, group: str) -> EntryPoint | None:
    return next(iter(entry_points(group=group, name=name)), None)


def _package_sha256(entry: EntryPoint) -> str:
    """Digest of the top package of an entry point, which is not imported for it."""
    top = entry.module.partition(".")[0]
    spec = find_spec(top)
    if spec is None or spec.origin is None:
        raise TableError(f"{entry.name} ({entry.value}): there is no module {top}")
    origin = Path(spec.origin)
    files = sorted(origin.parent.rglob("*.py")) if spec.submodule_search_locations else [origin]
    return _sha256(files, origin.parent)


def _sha256(files: list[Path], folder: Path) -> str:
    """The digest of one file; of several, that of their names and digests."""
    digests = [hashlib.sha256(_read(file)).hexdigest() for file in files]
    if len(files) == 1:
        return digests[0]
    named = zip(files, digests, strict=True)
    text = "".join(f"{digest}  {file.relative_to(folder).as_posix()}\n" for file, digest in named)
    return hashlib.sha256(text.encode()).hexdigest()


def _read(path: Path) -> bytes:
    try:
        return read_regular(path, MOST_BYTES)
    except OSError as error:
        raise TableError(f"{path}: cannot be read ({error.strerror or error})") from None
