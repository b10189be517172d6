"""Errors that a programmer might make in the flight software in C: ``torquer judge`` finds and names them."""

import pytest
from c_compiler import has_compiler
from click.testing import CliRunner
from detumble_bench import NO_COMPILER, compile_program

from sim.scenario.schema import load
from torquer.cli.main import main

pytestmark = [pytest.mark.long, pytest.mark.skipif(not has_compiler(), reason=NO_COMPILER)]

PLANTED = {
    "the sign of B-dot": (
        ("laws.c", "-k_w / interval_s", "k_w / interval_s"),
        0.4,
        "a sign error: its dipoles speed the body up",
    ),
    "two coils in each other's place": (
        (
            "detumble.c",
            "message.coil = pulse.coil;",
            "message.coil = (uint8_t)((pulse.coil < 2U) ? (1U - pulse.coil) : 2U);",
        ),
        1.0,
        "the axes x and y are swapped",
    ),
    "a pulse of a tick more": (
        ("detumble.c", "(uint16_t)DURATION_MS", "(uint16_t)(DURATION_MS + 1000U)"),
        0.2,
        "a pulse of 4 s, the longest pulse is 3 s",
    ),
    "a counter that stands": (
        ("detumble.c", "fsw->fire_counter++;", "fsw->fire_counter += 0U;"),
        0.2,
        "the counter of COIL_FIRE does not rise by one",
    ),
}
"""What is planted, how many orbits are flown, and what is said."""


@pytest.mark.parametrize(("planted", "orbits", "says"), PLANTED.values(), ids=PLANTED)
@pytest.mark.slow
def test_it_is_found(tmp_path, tumbler, planted, orbits, says):
    program = compile_program(tmp_path, load(tumbler), planted)
    words = ["judge", tumbler, "--flight-software", f"{program} {{port}}", "--profile", "detumble", "--json"]
    done = CliRunner().invoke(main, [*words, "--orbits", str(orbits), "--out", str(tmp_path / "run")])
    assert done.exit_code == 1, done.output
    assert says in done.stdout
