"""Independent named random streams from one seed."""

from collections.abc import Iterator
from zlib import crc32

import numpy as np

_BLOCK = 3072


def normals(seed: int, name: str) -> Iterator[float]:
    """An endless sequence of standard normal numbers: the stream ``name`` of the seed.

    A stream depends on seed and name only, not on the other streams or how far they were drawn. PCG64 under
    numpy's SeedSequence, with the CRC-32 of the name as its spawn key.
    """
    sequence = np.random.SeedSequence(seed, spawn_key=(crc32(name.encode()),))
    generator = np.random.Generator(np.random.PCG64(sequence))
    while True:
        yield from generator.standard_normal(_BLOCK).tolist()
