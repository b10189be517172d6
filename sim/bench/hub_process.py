"""The hub of a loop bus as a process: prints its port, and serves until its standard input ends."""

import sys

from fsw.bus.hub import Hub


def main() -> int:
    """Serve the port given as the first argument, or a free one for 0."""
    try:
        hub = Hub(int(sys.argv[1]))
    except OSError:
        return 1
    hub.start()
    print(hub.port, flush=True)
    sys.stdin.read()
    hub.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
