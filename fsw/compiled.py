"""The compiled form of the flight code: used whole, and only where its sources are those it was built from.

``tools/compile_group.py`` compiles a group of modules into one library in the folder ``_compiled``, with a
manifest. A finder, which ``install`` puts before those of Python, serves the modules of the group from that
library. Where anything has changed since the build, or ``TORQUER_INTERPRETED=1``, it serves none, and all of
them run interpreted.
"""

import hashlib
import json
import os
import sys
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, ModuleSpec
from importlib.util import module_from_spec, spec_from_file_location
from mmap import ACCESS_READ, mmap
from pathlib import Path
from types import ModuleType
from typing import Any, Final, NamedTuple
from zlib import crc32

ROOT: Final = Path(__file__).resolve().parents[1]
"""The folder that holds the packages."""
FOLDER: Final = "fsw/_compiled"
MANIFEST: Final = "manifest.json"
PACKAGES: Final = ("fsw", "hil_stub", "sim")
LIBRARY: Final = "torquer__mypyc"
"""Module of the library, by which mypyc's code knows it."""
STARTER: Final = "torquer_start"
"""A second module of the library, whose ``start`` runs a module of the group."""
SWITCH: Final = "TORQUER_INTERPRETED"
ABI: Final = EXTENSION_SUFFIXES[0]


class CodeStanding(NamedTuple):
    """Whether the flight code runs compiled.

    Attributes:
        modules: the compiled ones by name; none if all run interpreted.
        reason: why they run interpreted; empty where they do not.
    """

    modules: frozenset[str]
    reason: str

    @property
    def code(self) -> str:
        """``compiled`` or ``interpreted``."""
        return "interpreted" if self.reason else "compiled"

    def __str__(self) -> str:
        return f"interpreted: {self.reason}" if self.reason else f"compiled: {len(self.modules)} modules"


class BuildError(Exception):
    """A build cannot be used; the message says why."""


class Build:
    """A build, as its manifest has it; the library is loaded once the sources have been compared."""

    def __init__(self, root: Path = ROOT) -> None:
        self._root = root
        self._folder = root / FOLDER
        try:
            self.manifest: dict[str, Any] = json.loads((self._folder / MANIFEST).read_bytes())
            self.modules = frozenset(self.manifest["modules"])
        except FileNotFoundError:
            raise BuildError("nothing is built") from None
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise BuildError(f"{FOLDER}/{MANIFEST} is damaged: {error!r}") from None

    def check(self) -> None:
        """Compare Python, library and sources with those of the build.

        Raises:
            BuildError: one of them differs; of the sources, the first.
        """
        try:
            if self.manifest["abi"] != ABI:
                raise BuildError(f"built for {self.manifest['abi']}, and this Python loads {ABI}")
            library = self._folder / self.manifest["library"]
            if _file_crc(library) != self.manifest["library_crc"]:
                raise BuildError(f"{FOLDER}/{library.name} is not what was built")
            changed = [
                path
                for path, digest in self.manifest["sources"].items()
                if source_digest(self._root / path) != digest
            ]
        except (KeyError, TypeError, AttributeError) as error:
            raise BuildError(f"{FOLDER}/{MANIFEST} is damaged: {error!r}") from None
        if changed:
            raise BuildError(f"{changed[0]} has changed since the build")

    def load(self) -> None:
        """Load the library.

        Raises:
            BuildError: it cannot be loaded.
        """
        try:
            for name in (LIBRARY, STARTER):
                sys.modules[name] = _extension(name, str(self._folder / self.manifest["library"]))
            # by this each module derives its own file
            sys.modules[LIBRARY].__file__ = str(self._root / self.manifest["library"])
        except ImportError as error:
            sys.modules.pop(LIBRARY, None)
            raise BuildError(f"{FOLDER}/{self.manifest['library']} cannot be loaded: {error}") from None


def _file_crc(path: Path) -> int | None:
    """CRC-32 of a file; None where there is none.

    It is mapped, not read: from a large block once freed, malloc learns to keep such blocks.
    """
    try:
        with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
            return crc32(content)
    except (OSError, ValueError):  # ValueError: it is empty
        return None


def _extension(name: str, path: str) -> ModuleType:
    spec = spec_from_file_location(name, path, loader=ExtensionFileLoader(name, path))
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def source_digest(path: Path) -> str:
    """SHA-256 of a source; empty where there is none."""
    try:
        return sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


class Finder(MetaPathFinder):
    """Serves the modules of the group."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Where a module comes from; None: from where Python finds it."""
        if name.partition(".")[0] not in PACKAGES or name not in _named() or name not in standing().modules:
            return None
        spec = ModuleSpec(name, ModuleLoader(), origin=str(ROOT / f"{name.replace('.', '/')}.py"))
        spec.has_location = True
        return spec


class ModuleLoader(Loader):
    """Runs a module of the library."""

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Run it: like any extension's, its body is run when it is created."""
        library, starter = sys.modules[LIBRARY], sys.modules[STARTER]
        module: ModuleType = starter.start(getattr(library, f"init_{spec.name.replace('.', '___')}"))
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Name its source as its file, as an interpreted module does."""
        assert module.__spec__ is not None
        module.__file__ = module.__spec__.origin


@cache
def _named() -> frozenset[str]:
    """The modules of the build, whether it can be used or not."""
    try:
        return Build().modules
    except BuildError:
        return frozenset()


@cache
def standing() -> CodeStanding:
    """Whether the flight code of this process runs compiled, or why not; decided once."""
    if os.environ.get(SWITCH, "0") not in ("", "0"):
        return CodeStanding(frozenset(), f"{SWITCH} is set")
    try:
        build = Build()
        build.check()
        build.load()
    except BuildError as error:
        return CodeStanding(frozenset(), str(error))
    return CodeStanding(build.modules, "")


def install() -> None:
    """Put the finder before those of Python, once a process."""
    if not any(isinstance(finder, Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, Finder())


# --- The filter's kernel: one that was built from another source than its own does not fly

KERNEL = "fsw.core.estimation._kalman_kernel"
KERNEL_FOLDER = Path(__file__).parent / "core" / "estimation"
KERNEL_SOURCE = "kalman_kernel.c"


def refuse_stale_kernel(folder: Path = KERNEL_FOLDER) -> None:
    """Let no module import a kernel that was built from another source; without its source, none is stale.

    The binary holds the SHA-256 of its source. It is not imported here, which would load numpy.
    """
    binaries = [folder / f"_kalman_kernel{suffix}" for suffix in EXTENSION_SUFFIXES]
    try:
        digest = hashlib.sha256((folder / KERNEL_SOURCE).read_bytes()).hexdigest().encode()
        stale = any(digest not in path.read_bytes() for path in binaries if path.exists())
    except OSError:
        return
    if stale:
        sys.modules[KERNEL] = None  # type: ignore[assignment]  # an import of it raises ImportError
