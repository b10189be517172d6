"""Independent named random streams from one seed."""

from typing import final
from zlib import crc32

import numpy as np

_BLOCK = 3072


@final
class Normals:
    """An endless sequence of standard normal numbers: the stream ``name`` of the seed.

    A stream depends on seed and name only, not on the other streams or how far they were drawn. PCG64 under
    numpy's SeedSequence, with the CRC-32 of the name as its spawn key.
    """

    def __init__(self, seed: int, name: str) -> None:
        sequence = np.random.SeedSequence(seed, spawn_key=(crc32(name.encode()),))
        self._generator = np.random.Generator(np.random.PCG64(sequence))
        self._block: list[float] = []
        self._drawn = 0

    def next(self) -> float:
        """The next number."""
        place = self._drawn
        if place == len(self._block):
            self._block, place = self._generator.standard_normal(_BLOCK).tolist(), 0
        self._drawn = place + 1
        return self._block[place]
