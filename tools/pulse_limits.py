"""Fly the sweep of sim/design/limits, and write docs/pulse-limits.md with its picture.

Some whole flights with perfect knowledge stand beside the linear ones. Each error is kept in a file when it
is computed: with --keep a run that was stopped goes on where it was, --render writes the page without
flying. Exit code 1 where a law points better than the bound, which cannot be, or where whole and linear
flights do not agree.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from math import degrees, hypot
from pathlib import Path

import numpy as np

from fsw.input.schema import Nested, TableError, merge
from sim.campaign.flight import Figures, Order, fly_order
from sim.design.limits.linear_flight import COUNTED, ORBITS, fly
from sim.design.limits.page import Agreement, page
from sim.design.limits.picture import draw
from sim.design.limits.sweep import (
    NO_TORQUE,
    SCENARIO,
    STARTS_RAD,
    Orbits,
    all_orders,
    better_than_bound,
)
from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.record.whole_file import replace_file, replace_text
from sim.scenario.schema import Scenario, load
from sim.validate.microsat import pointing_deg
from sim.validate.page import platform_line

ROOT = Path(__file__).resolve().parent.parent
PAGE, ROWS = ROOT / "docs" / "pulse-limits.md", ROOT / "build" / "pulse-limits.json"
AGREED_PART, AGREED_DEG = 0.1, 0.02
"""By so much whole and linear flight may differ."""
WHOLE: tuple[tuple[str, str, Nested], ...] = (
    ("`mpc`, no torque", "mpc", NO_TORQUE),
    ("`pulse_mpc`, no torque", "pulse_mpc", NO_TORQUE),
    ("`mpc`, the torque not told", "mpc", {}),
    ("`pulse_mpc`, the torque not told", "pulse_mpc", {}),
)
"""With perfect knowledge the law is told attitude and no torque, and so it is in these linear flights."""

Rows = dict[str, list[float]]


def rms_deg(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """RMS pointing error of the orbits that count."""
    error_deg = pointing_deg(truth)
    return {"rms_deg": float(np.sqrt(np.mean(error_deg[-round(COUNTED * len(error_deg)) :] ** 2)))}


def both(law: str, overrides: Nested, orbits: Orbits) -> list[float]:
    """The error of a whole flight from the first start, then that of linear flights from each."""
    overrides = merge(overrides, {"knowledge": "perfect", "control": {"law": law}})
    scenario, start = load(SCENARIO, overrides), STARTS_RAD[0]
    initial = {"axis": list(start), "angle_deg": degrees(hypot(*start)), "rate_degps": [0.0] * 3}
    order = Order(SCENARIO, merge(overrides, {"initial": initial}), orbits=ORBITS, measure=rms_deg)
    linear = [fly(scenario, theta_rad, orbits.of(scenario), told=False) for theta_rad in STARTS_RAD]
    return [fly_order(order).figures["rms_deg"], *(flight.rms_deg() for flight in linear)]


def fly_missing(rows: Rows, path: Path) -> None:
    """Fly what there is no row of, and keep each as it comes."""
    orbits, orders = Orbits(), {order.key: order for order in all_orders()}
    missing = [name for name in (*(name for name, _, _ in WHOLE), *orders) if name not in rows]
    checked = {name: (law, overrides) for name, law, overrides in WHOLE}
    for number, name in enumerate(missing, start=1):
        of_bus = name in checked
        rows[name] = both(*checked[name], orbits) if of_bus else [orders[name].error_deg(orbits)]
        replace_file(path, json.dumps(rows, indent=0).encode())
        print(f"flying: {number} of {len(missing)}", file=sys.stderr, flush=True)


def agreements(rows: Rows) -> list[Agreement]:
    """Those that there are."""
    return [Agreement(name, rows[name][0], tuple(rows[name][1:])) for name, _, _ in WHOLE if name in rows]


def faults(rows: Rows) -> Iterator[str]:
    """What cannot be."""
    for what in better_than_bound({name: values[0] for name, values in rows.items()}):
        yield f"less error than the bound: {what}"
    for one in agreements(rows):
        apart = min(abs(one.whole_deg - error) for error in one.linear_deg)
        if not apart <= AGREED_PART * one.whole_deg + AGREED_DEG:
            yield f"linear and whole flight differ by {apart:.3f} deg: {one.name}"


def read(path: Path) -> Rows:
    """The rows of a file.

    Raises:
        HarnessError: there is no such file, or it holds no rows.
    """
    try:
        rows: Rows = json.loads(path.read_text(encoding="utf-8"))
        numbers = all(isinstance(value, float) for values in rows.values() for value in values)
    except (OSError, ValueError, AttributeError, TypeError) as error:
        raise HarnessError(f"{path}: no rows can be read ({error})") from None
    if not numbers:
        raise HarnessError(f"{path}: no rows can be read (an error is no number)")
    return rows


def main(words: Sequence[str] | None = None) -> int:
    """Fly, write the page; 1 if something cannot be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rows", type=Path, default=ROWS, help="where the errors are kept")
    parser.add_argument(
        "--keep", action="store_true", help="fly only what there is no row of; rows of other code stay"
    )
    parser.add_argument("--render", action="store_true", help="fly nothing")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its picture lies beside it")
    arguments = parser.parse_args(words)
    try:
        check_file(arguments.out)
        check_file(arguments.rows)
        kept = arguments.render or (arguments.keep and arguments.rows.exists())
        rows = read(arguments.rows) if kept else {}
        if not arguments.render:
            fly_missing(rows, arguments.rows)
    except (HarnessError, TableError) as error:
        print(f"pulse_limits: {error}", file=sys.stderr)
        return 2
    flown = {name: values[0] for name, values in rows.items()}
    draw(flown, arguments.out.with_suffix(".svg"))
    replace_text(arguments.out, page(flown, agreements(rows), platform_line()))
    found = list(faults(rows))
    print("\n".join([*found, str(arguments.out)]))
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
