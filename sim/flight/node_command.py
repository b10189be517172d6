"""A user's node, flight software or board: a command that is started with the address of the bus."""

import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sim.errors import HarnessError

MOST_QUOTED = 200
_TAIL_BYTES = 4096


@dataclass(frozen=True, slots=True)
class NodeCommand:
    """A command and its arguments, started without a shell.

    In each word ``{bus}`` stands for the bus, ``{port}`` for the TCP port of a loop bus, and further names
    for what is given; its environment has the same as TORQUER_BUS, TORQUER_PORT and so on.
    """

    words: tuple[str, ...]

    @property
    def text(self) -> str:
        """As one would type it."""
        return shlex.join(self.words)

    def start(self, spec: str, given: Mapping[str, str], output: Path) -> subprocess.Popen[bytes]:
        """Start it on a bus; what it prints, on stdout and stderr, goes into ``output``.

        Raises:
            HarnessError: it cannot be started.
        """
        values = {"bus": spec, "port": spec.partition(":")[2], **given}
        words = [_filled(word, values) for word in self.words]
        environment = {**os.environ, **{f"TORQUER_{name.upper()}": text for name, text in values.items()}}
        try:
            with output.open("wb") as file:
                return subprocess.Popen(
                    words,
                    stdin=subprocess.DEVNULL,
                    stdout=file,
                    stderr=subprocess.STDOUT,
                    env=environment,
                    start_new_session=True,
                )
        except OSError as error:
            raise HarnessError(f"{words[0]}: cannot be started: {error.strerror}") from None


def parse_command(text: str, option: str) -> NodeCommand:
    """The command of a command line.

    Raises:
        HarnessError: it is empty, a quote is open, or there is no such program.
    """
    try:
        words = tuple(shlex.split(text))
    except ValueError as error:
        raise HarnessError(f"{option} {text!r}: {str(error).lower()}") from None
    if not words:
        raise HarnessError(f"{option}: the command is empty")
    if shutil.which(words[0]) is None:
        raise HarnessError(f"{option}: there is no program {words[0]!r} that can be executed")
    return NodeCommand(words)


def last_words(output: Path) -> str:
    """The last line that a command printed, cut to a readable length; empty if there is none."""
    try:
        with output.open("rb") as file:
            file.seek(0, os.SEEK_END)
            file.seek(max(0, file.tell() - _TAIL_BYTES))
            lines = file.read().decode(errors="backslashreplace").split("\n")
    except OSError:
        return ""
    said = [line.strip() for line in lines if line.strip()]
    return said[-1][:MOST_QUOTED] if said else ""


def _filled(word: str, values: Mapping[str, str]) -> str:
    """The word with each name in braces replaced, once: what is put in is not looked through again."""
    return re.sub(r"\{(\w+)\}", lambda match: values.get(match[1], match[0]), word)
