"""The sources of the flight software: their own tests, static analysis, and what they must not contain."""

import re
import shutil
import subprocess

import pytest
from c_compiler import COMPILER, has_compiler
from detumble_bench import FIRMWARE, NO_COMPILER, write_contract
from detumble_reference import gains_that_ship

from fsw.table.config import flight_config
from fsw.wire.coil_current import OFF_PART
from sim.scenario.schema import flight_table, load

CORE = sorted((FIRMWARE / "src").glob("*.[ch]"))
SOURCES = sorted(path for path in FIRMWARE.rglob("*") if path.suffix in (".c", ".h", ".ld"))


@pytest.fixture(scope="module")
def contract(tmp_path_factory):
    return write_contract(tmp_path_factory.mktemp("contract"), load("microsat"))


def needs(program, package):
    return pytest.mark.skipif(
        shutil.which(program) is None, reason=f"{program} is not installed: Debian's package {package}"
    )


def run(*words):
    done = subprocess.run([str(word) for word in words], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.long
@pytest.mark.skipif(not has_compiler(), reason=NO_COMPILER)
@needs("cmake", "cmake")
def test_its_own_tests_pass(contract, tmp_path):
    run("cmake", "-S", FIRMWARE, "-B", tmp_path, f"-DCONTRACT_DIR={contract}")
    run("cmake", "--build", tmp_path)
    said = run("ctest", "--test-dir", tmp_path, "--output-on-failure")
    assert "100% tests passed, 0 tests failed out of 5" in said


@pytest.mark.long
@needs("cppcheck", "cppcheck")
@pytest.mark.slow
def test_it_is_free_of_findings_of_misra_and_cppcheck(contract):
    files = [path for path in CORE if path.suffix == ".c"]
    includes = [f"-I{FIRMWARE / folder}" for folder in ("gains", "src")]
    quiet = ("--suppress=missingIncludeSystem", "--suppress=unusedFunction", "--suppress=misra-c2012-2.5:*.h")
    interface = "--suppress=misra-c2012-8.7:*/detumble.c"  # its callers are adapters
    theirs = (f"--suppress=*:{contract}/*", f"-I{contract}")
    rules = ("--addon=misra", "--enable=all", "--std=c99", "--error-exitcode=1", *quiet, interface, *theirs)
    assert run("cppcheck", "-q", *rules, *includes, *files) == ""


@pytest.mark.long
@needs(COMPILER, COMPILER)
def test_a_scenario_with_a_continuous_driver_does_not_compile(tmp_path):
    contract = write_contract(tmp_path, load("detumble3u"))
    words = (COMPILER, "-std=c99", "-fsyntax-only", f"-I{contract}", f"-I{FIRMWARE / 'gains'}")
    done = subprocess.run(
        [str(word) for word in (*words, FIRMWARE / "src" / "coils.c")],
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0
    assert "the scenario has a continuous driver" in done.stderr


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(FIRMWARE).as_posix())
def test_each_source_names_its_licence(path):
    assert path.read_text().splitlines()[0] == "/* SPDX-License-Identifier: Apache-2.0 */"


@pytest.mark.parametrize("file", ["CMakeLists.txt", "zephyr/CMakeLists.txt"])
def test_each_build_has_the_whole_core(file):
    named = set(re.findall(r"src/(\w+\.c)", (FIRMWARE / file).read_text()))
    assert named == {path.name for path in CORE if path.suffix == ".c"}


@pytest.mark.parametrize("path", CORE, ids=lambda path: path.name)
def test_the_core_is_in_memory_of_its_own(path):
    code = re.sub(r"(?s)/\*.*?\*/", "", path.read_text())
    assert not re.search(r"\b(malloc|calloc|free|goto|static\s+\w+\s+\w+\s*;)\b", code)
    assert not re.search(r"(?<!const )\bdouble \w+ =", code), "the laws are in single precision"
    included = set(re.findall(r"#include <(.+)>", code))
    assert included <= {"math.h", "stdbool.h", "stdint.h"}, "it does no input or output and tells no time"


def test_the_gains_that_ship_are_those_of_the_default_scenario():
    scenario = load("microsat")
    config, gains = flight_config(flight_table(scenario)), gains_that_ship()
    setpoint = config.control.setpoint
    assert (gains.k_w, gains.k_a) == (setpoint.k_w, setpoint.k_a)
    assert gains.off_ma == int(OFF_PART * scenario.coils.levels_ma[0])
    assert gains.leak_s == config.coils.pulses.leak_s
    assert gains.slow_radps == pytest.approx(config.modes.slow_radps, rel=1e-4)
    assert gains.fast_radps == pytest.approx(config.modes.fast_radps, rel=1e-4)
