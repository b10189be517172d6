"""One row of a recorded pass is spoilt: it is judged as without the row, and nothing is called surer or met.

Twenty passes, real and simulated, as a rule; ``make fuzz`` spoils two hundred.
"""

import json
import os
from functools import cache
from typing import NamedTuple

import pytest
from corrupt_rows import any_spoilt, seeded
from judged_commands import torquer
from recorded_samples import DATA, FACES, MATRIX, OFFSET_NT, RATIOS, TLE, made_up

pytestmark = pytest.mark.long

COUNT = int(os.environ.get("TORQUER_CORRUPT_PASSES", "20"))
LEAST_SIGMA = 0.9
"""Part of a deviation without the row that is left with it, at least."""

REAL = tuple(sorted(path.stem for path in DATA.glob("s3_*.csv")))
SIMULATED = (3, 4, 5, 6)
"""Seeds."""


class Pass(NamedTuple):
    """The lines of the file, its calibration, and the ratios of inertia that are declared."""

    lines: list[str]
    calibration: str
    ratios: str


class Ended(NamedTuple):
    """The exit code of a command, and the deviations that it states, by the names of the numbers."""

    code: int
    sigma: dict[str, float]


@cache
def sound(source):
    """The pass of a file, or of a seed."""
    if source in REAL:
        lines = (DATA / f"{source}.csv").read_text().splitlines()
        return Pass(lines, (DATA / "calibration.toml").read_text(), "0.9987,1,0.178")
    tables = [
        f"[calibration.magnetometer]\noffset_nt = {OFFSET_NT.tolist()}\nmatrix = {MATRIX.tolist()}",
        f"[recorded.body]\ninertia_ratios = {RATIOS.tolist()}\nprincipal_axes_turn_deg = [2.0, 0.0, -4.0]",
    ]
    tables += [
        f'[[recorded.cell]]\nname = "{name}"\nface_body = {face.tolist()}\nfull_scale = {scale}'
        for name, (face, scale) in FACES.items()
    ]
    return Pass(made_up(200, seed=source).text.splitlines(), "\n".join(tables), "0.93,1,0.31")


def ended(command, lines, source, folder):
    """How the command ends on these lines, with what is known of the pass."""
    known, path = sound(source), folder / "pass.csv"
    path.write_text("\n".join(lines) + "\n")
    (folder / "calibration.toml").write_text(known.calibration)
    options = {
        "calibrate": ("--inertia-ratios", known.ratios, "--out", folder / "found.toml"),
        "telemetry": ("--calibration", folder / "calibration.toml"),
    }[command]
    code, answer, said = torquer(command, path, "--tle", TLE, "--json", *options)
    assert code in (0, 1), said
    numbers = json.loads(answer).get("magnetometer", {})
    return Ended(code, {name: number["sigma"] for name, number in numbers.items()})


@cache
def ended_on_sound(command, source, folder):
    """How it ends on the pass as it is."""
    return ended(command, sound(source).lines, source, folder)


def is_as_without(code, without, clean):
    """Whether an exit code is that of the pass without the row.

    Where the row decides, so that the sound pass and that without it are judged otherwise, a refusal that
    the sound pass has too is as good. An exit code of 0 is only ever right where it is that without the row.
    """
    return code == without or (code == clean != 0)


@pytest.mark.parametrize("number", range(COUNT))
def test_it_is_judged_as_without_the_row(number, tmp_path, tmp_path_factory):
    sources = REAL if number % 2 else SIMULATED
    source = sources[number // 2 % len(sources)]
    lines = sound(source).lines
    spoilt, row, kind = any_spoilt(lines, seeded(number))
    case = f"{source}, line {row + 1}, {kind}: {spoilt[row]}"
    for command in ("calibrate", "telemetry"):
        found = ended(command, spoilt, source, tmp_path)
        without = ended(command, [*lines[:row], *lines[row + 1 :]], source, tmp_path)
        if found.code != without.code:
            clean = ended_on_sound(command, source, tmp_path_factory.getbasetemp())
            assert is_as_without(found.code, without.code, clean.code), case
        for name, sigma in without.sigma.items():
            assert found.sigma[name] >= LEAST_SIGMA * sigma, f"{case}: {name}"


@pytest.mark.parametrize(
    ("code", "without", "clean", "right"),
    [(0, 0, 0, True), (1, 1, 0, True), (1, 0, 1, True), (1, 0, 0, False), (0, 1, 0, False), (0, 1, 1, False)],
)
def test_no_refusal_is_new_and_no_exit_code_of_0_either(code, without, clean, right):
    assert is_as_without(code, without, clean) == right
