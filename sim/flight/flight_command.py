"""Flight software of one's own: a command that is started for each flight, with the address of the bus."""

import os
import shlex
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from sim.errors import HarnessError

OUTPUT = "flight-software.log"
"""In the run directory: what the command printed, on stdout and stderr."""
MOST_QUOTED = 200
_TAIL_BYTES = 4096


@dataclass(frozen=True, slots=True)
class FlightCommand:
    """A command and its arguments, started without a shell.

    In each word ``{bus}`` stands for the bus, ``{port}`` for the TCP port of a loop bus, ``{scenario}`` for
    the resolved scenario of the run; its environment has the same as TORQUER_BUS, TORQUER_PORT and
    TORQUER_SCENARIO.
    """

    words: tuple[str, ...]

    @property
    def text(self) -> str:
        """As one would type it."""
        return shlex.join(self.words)

    def start(self, spec: str, run: Path, scenario: Path) -> subprocess.Popen[bytes]:
        """Start it for a flight on a bus; what it prints goes into ``OUTPUT`` of the run directory.

        Raises:
            HarnessError: it cannot be started.
        """
        given = {"bus": spec, "port": spec.partition(":")[2], "scenario": str(scenario.absolute())}
        words = [_filled(word, given) for word in self.words]
        environment = {**os.environ, **{f"TORQUER_{name.upper()}": text for name, text in given.items()}}
        try:
            with (run / OUTPUT).open("wb") as output:
                return subprocess.Popen(
                    words,
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=subprocess.STDOUT,
                    env=environment,
                    start_new_session=True,
                )
        except OSError as error:
            raise HarnessError(f"{words[0]}: cannot be started: {error.strerror}") from None


def parse_command(text: str, option: str) -> FlightCommand:
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
    return FlightCommand(words)


def last_words(run: Path) -> str:
    """The last line that the command of a run printed, cut to a readable length; empty if there is none."""
    try:
        with (run / OUTPUT).open("rb") as file:
            file.seek(0, os.SEEK_END)
            file.seek(max(0, file.tell() - _TAIL_BYTES))
            lines = file.read().decode(errors="backslashreplace").split("\n")
    except OSError:
        return ""
    said = [line.strip() for line in lines if line.strip()]
    return said[-1][:MOST_QUOTED] if said else ""


def _filled(word: str, given: dict[str, str]) -> str:
    for name, text in given.items():
        word = word.replace(f"{{{name}}}", text)
    return word
