"""The firmware in C, from the generated headers alone, flies and is judged sound."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from sim.export.c_source import c_files
from sim.flight.node_command import NodeCommand
from sim.judge.flight import fly_and_judge
from sim.judge.render import failed_text
from sim.scenario.schema import load

EXAMPLE = Path(__file__).parents[3] / "examples" / "tiny_firmware.c"
TUMBLER = str(Path(__file__).with_name("tumbler.toml"))
FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-D_POSIX_C_SOURCE=200809L")

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc"),
]


@pytest.fixture
def program(tmp_path):
    for name, text in c_files(load(TUMBLER)).items():
        (tmp_path / name).write_text(text)
    words = ["gcc", *FLAGS, f"-I{tmp_path}", str(EXAMPLE), str(tmp_path / "torquer.c"), "-lm", "-o"]
    built = subprocess.run([*words, str(tmp_path / "firmware")], capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    return tmp_path / "firmware"


@pytest.mark.slow
def test_it_brakes_a_tumble_and_nothing_is_held_against_it(program, firmware, tmp_path):
    software = replace(firmware(), command=NodeCommand((str(program), "{port}")))
    flight = fly_and_judge(software, load(TUMBLER), 1, tmp_path / "run")
    assert flight.ok, failed_text(flight)
    assert flight.law.brakes > 0.6
    assert [one["verdict"] for one in flight.requirements] == ["met"]
