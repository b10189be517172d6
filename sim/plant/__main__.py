"""``python -m sim.plant``: the plant alone on a bus, as ``torquer plant``, which this process becomes."""

import os
import sys

if __name__ == "__main__":
    os.execv(sys.executable, [sys.executable, "-m", "torquer", "plant", *sys.argv[1:]])
