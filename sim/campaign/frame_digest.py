"""SHA-256 of the frames of a flight: of all, and of the commands to the coils alone.

Two flights with the same digest of all frames are equal to the last bit: each TICK_DONE has the CRC of the
flight state. Each frame is sealed by a CRC of its own that includes its identifier, so that the data suffice.
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipole, CoilFire
from sim.record.candump import read_log

COMMANDS = frozenset({CoilFire.ID, CoilDipole.ID})


class FrameDigest:
    """Digests of frames in their order."""

    def __init__(self) -> None:
        self._all, self._commands = hashlib.sha256(), hashlib.sha256()

    def take(self, frames: Sequence[Frame]) -> None:
        """Add the frames of a tick."""
        self._all.update(b"".join([frame.data for frame in frames]))
        for frame in frames:
            if frame.can_id in COMMANDS:
                self._commands.update(frame.data)

    @property
    def frames(self) -> str:
        """Of all frames, in hex."""
        return self._all.hexdigest()

    @property
    def commands(self) -> str:
        """Of the commands, in hex."""
        return self._commands.hexdigest()


def digest_of(log: Path) -> FrameDigest:
    """The digest of a bus log.

    Raises:
        HarnessError: it cannot be read.
    """
    digest = FrameDigest()
    for entry in read_log(log):
        digest.take((entry.frame,))
    return digest
