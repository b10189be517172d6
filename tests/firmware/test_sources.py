"""The sources of the coil board: their own tests, static analysis, and what they must not contain."""

import re
import shutil
import subprocess

import pytest
from c_compiler import has_compiler
from firmware_bench import BOARD, LEVELS_MA, NO_COMPILER, limit, limits_header
from planted_firmware import PLANTED, Planted, compile_planted

from hil_stub.bench import DEADMAN_MS
from sim.scenario.assemble import coil_limits
from sim.scenario.schema import load

CORE = sorted((BOARD / "src").glob("*.[ch]"))
SOURCES = sorted(path for path in BOARD.rglob("*") if path.suffix in (".c", ".h", ".ld"))
FREE_OF_FINDINGS = ("src/*.c", "host/record.c", "host/slcan.c", "host/harness.c")
"""What bears MISRA C:2012; the program of this machine uses its operating system, and does not."""


def needs(program, package):
    return pytest.mark.skipif(
        shutil.which(program) is None, reason=f"{program} is not installed: Debian's package {package}"
    )


def run(*words, cwd=None):
    done = subprocess.run([str(word) for word in words], check=False, capture_output=True, text=True, cwd=cwd)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.long
@pytest.mark.skipif(not has_compiler(), reason=NO_COMPILER)
@needs("cmake", "cmake")
def test_its_own_tests_pass(tmp_path):
    run("cmake", "-S", BOARD, "-B", tmp_path)
    run("cmake", "--build", tmp_path)
    said = run("ctest", "--test-dir", tmp_path, "--output-on-failure")
    assert "100% tests passed, 0 tests failed out of 4" in said


@pytest.mark.long
@needs("cppcheck", "cppcheck")
def test_it_is_free_of_findings_of_misra_and_cppcheck():
    files = [path for pattern in FREE_OF_FINDINGS for path in sorted(BOARD.glob(pattern))]
    includes = [f"-I{BOARD / folder}" for folder in ("limits", "src", "host")]
    quiet = ("--suppress=missingIncludeSystem", "--suppress=unusedFunction", "--suppress=misra-c2012-2.5:*.h")
    rules = ("--addon=misra", "--enable=all", "--std=c99", "--error-exitcode=1", *quiet)
    assert run("cppcheck", "-q", *rules, *includes, *files) == ""


@pytest.mark.long
@needs("frama-c", "frama-c-base")
class TestProof:
    """No step is undefined and each keeps the invariant: proved for every state, frame and time."""

    def prove(self, *folders):
        said = run("sh", BOARD / "proof" / "prove.sh", *folders)
        assert "100% coverage" in said, "every function was analysed"
        return "0 alarms generated" in said and bool(
            re.search(r"Assertions +11 valid +0 unknown +0 inv", said)
        )

    @pytest.mark.parametrize(
        "limits", [{}, {"tick_hz": 1000}, {"tick_hz": 7, "pulse_ms": 437, "shared": 0}], ids=str
    )
    def test_it_holds_with_all_limits(self, tmp_path, limits):
        (tmp_path / "coil_limits.h").write_text(limits_header(**limits))
        assert self.prove(BOARD / "src", tmp_path)

    @pytest.mark.parametrize(
        "error",
        [
            "there is a coil 3",
            "level 4 is driven",
            "a pulse is a tick too long",
            "a flood of requests fills it",
        ],
    )
    def test_an_error_is_not_proved(self, tmp_path, error):
        compile_planted(tmp_path, PLANTED.get(error) or OVERFLOW)
        assert not self.prove(tmp_path / "coil_board" / "src")


OVERFLOW = Planted(
    "coil_board.c",
    "if (board->refusal_count < REFUSALS_MOST) {",
    "if (board->refusal_count <= REFUSALS_MOST) {",
    "",
)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(BOARD).as_posix())
def test_each_source_names_its_licence(path):
    assert path.read_text().splitlines()[0] == "/* SPDX-License-Identifier: Apache-2.0 */"


def test_the_limits_that_ship_are_those_of_the_default_scenario():
    scenario = load("microsat")
    ours = coil_limits(scenario.coils, scenario.time.tick_hz)
    assert {name: limit(name) for name in ("tick_hz", "pulse_ms", "backoff_ms", "shared")} == {
        "tick_hz": ours.tick_hz,
        "pulse_ms": ours.pulse_ms,
        "backoff_ms": ours.backoff_ms,
        "shared": ours.shared,
    }
    assert limit("deadman_ms") == DEADMAN_MS
    assert pytest.approx(scenario.coils.levels_ma) == LEVELS_MA


@pytest.mark.parametrize("file", ["CMakeLists.txt", "zephyr/CMakeLists.txt"])
def test_each_build_has_the_whole_core(file):
    named = set(re.findall(r"src/(\w+\.c)", (BOARD / file).read_text()))
    assert named == {path.name for path in CORE if path.suffix == ".c"}


@pytest.mark.parametrize("path", CORE, ids=lambda path: path.name)
def test_the_core_is_integers_in_memory_of_its_own(path):
    code = re.sub(r"(?s)/\*.*?\*/", "", path.read_text())
    assert not re.search(r"\b(float|double|malloc|calloc|free|goto|static\s+\w+\s+\w+\s*;)\b", code)
    included = set(re.findall(r"#include <(.+)>", code))
    assert included <= {"stdbool.h", "stdint.h", "stddef.h"}, "it does no input or output and tells no time"
