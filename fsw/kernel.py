"""Whether the filter's kernel is the one that its source says: a stale one does not fly."""

import hashlib
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

KERNEL = "fsw.core.estimation._kalman_kernel"
FOLDER = Path(__file__).parent / "core" / "estimation"
SOURCE = "kalman_kernel.c"


def refuse_stale_kernel(folder: Path = FOLDER) -> None:
    """Let no module import a kernel that was built from another source; without its source, none is stale.

    The binary holds the SHA-256 of its source. It is not imported here, which would load numpy.
    """
    binaries = [folder / f"_kalman_kernel{suffix}" for suffix in EXTENSION_SUFFIXES]
    try:
        digest = hashlib.sha256((folder / SOURCE).read_bytes()).hexdigest().encode()
        stale = any(digest not in path.read_bytes() for path in binaries if path.exists())
    except OSError:
        return
    if stale:
        sys.modules[KERNEL] = None  # type: ignore[assignment]  # an import of it raises ImportError
