"""Files that are replaced at once: whole, or as they were.

The new content is written beside the file, under a name that nobody can foresee, created by this process and
by no other. A symbolic link of the file's name is replaced, and what it leads to stays as it is.
"""

import os
import re
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from platform import node

_NEW = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
_MACHINE = re.sub(r"\W+", "_", node())
_LEFT_OVER = re.compile(rf"\.torquer-{_MACHINE}-(?P<process>[0-9]+)-[0-9a-f]+\.part", re.ASCII)


def replace_file(path: Path, content: bytes) -> None:
    """Replace a file by one of this content.

    Raises:
        OSError: it cannot be written.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def replace_text(path: Path, text: str) -> None:
    """Replace a file by one of this text, in UTF-8.

    Raises:
        OSError: it cannot be written.
    """
    replace_file(path, text.encode("utf-8"))


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield the path of an empty file beside ``path``, which takes its place if the block succeeds.

    What writers that were killed have left in the folder is removed.

    Raises:
        OSError: it cannot be written.
    """
    _remove_left_over(path.parent)
    temporary = path.with_name(f".torquer-{_MACHINE}-{os.getpid()}-{secrets.token_hex(8)}.part")
    os.close(os.open(temporary, _NEW, 0o666))
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _remove_left_over(folder: Path) -> None:
    """Remove temporary files of processes of this machine that have ended; what cannot be removed stays."""
    if os.name != "posix":  # elsewhere asking for a process by a signal would end it
        return
    with suppress(OSError):
        for name in os.listdir(folder):
            found = _LEFT_OVER.fullmatch(name)
            if found and not _is_running(int(found["process"])):
                (folder / name).unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # of another user
        pass
    return True
