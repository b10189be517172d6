"""Fly the sweep of sim/design/limits, and write docs/pulse-limits.md with its picture.

Some whole flights with perfect knowledge stand beside the linear ones. A run that was stopped goes on where
it was. Exit code 1 where a law points better than the bound, or where whole and linear flights do not agree.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from argument_types import count

from fsw.input.schema import TableError
from sim.design.limits.page import Agreement, draw, page
from sim.design.limits.sweep import better_than_bound
from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replace_text
from sim.validate.page import platform_line
from sim.validate.pulse_limits import WHOLE, Rows, fly_all

PAGE = Path(__file__).resolve().parent.parent / "docs" / "pulse-limits.md"
AGREED_PART, AGREED_DEG = 0.1, 0.02
"""By so much whole and linear flight may differ."""


def agreements(rows: Rows) -> list[Agreement]:
    """Whole flights beside linear ones."""
    return [Agreement(name, rows[name][0], tuple(rows[name][1:])) for name, _, _ in WHOLE]


def faults(rows: Rows) -> Iterator[str]:
    """What cannot be."""
    for what in better_than_bound({name: values[0] for name, values in rows.items()}):
        yield f"less error than the bound: {what}"
    for one in agreements(rows):
        apart = min(abs(one.whole_deg - error) for error in one.linear_deg)
        if not apart <= AGREED_PART * one.whole_deg + AGREED_DEG:
            yield f"linear and whole flight differ by {apart:.3f} deg: {one.name}"


def main(words: Sequence[str] | None = None) -> int:
    """Fly, write the page; 1 if something cannot be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its picture lies beside it")
    arguments = parser.parse_args(words)
    try:
        check_file(arguments.out)
        rows = fly_all(arguments.workers)
    except (HarnessError, TableError) as error:
        print(f"pulse_limits: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("pulse_limits: interrupted; flights that are done are not flown again", file=sys.stderr)
        return 130
    flown = {name: values[0] for name, values in rows.items()}
    draw(flown, arguments.out.with_suffix(".svg"))
    replace_text(arguments.out, page(flown, agreements(rows), platform_line()))
    found = list(faults(rows))
    print("\n".join([*found, str(arguments.out)]))
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
