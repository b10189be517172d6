"""The guest with vcan0 runs on every processor: when its shim is loaded, what that does, how it fails."""

import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
WITH_VCAN = TESTS / "with-vcan"
SHIM = TESTS / "uml_xstate.c"
GUEST_BYTES = 2696
"""What user-mode Linux 6.1 keeps of a process's extended registers."""
SSE, AVX = 0b011, 0b111
HAS_AMX = "amx_tile" in Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else False

pytestmark = [
    pytest.mark.skipif(
        platform.machine() != "x86_64" or sys.platform != "linux", reason="the guest is for amd64"
    ),
    pytest.mark.skipif(not shutil.which("cc"), reason="the shim needs a C compiler"),
]

needs_guest = pytest.mark.skipif(not shutil.which("linux.uml"), reason="user-mode-linux is not installed")


def with_vcan(*command, path=(), **settings):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("VCAN_")}
    environment |= {
        "VCAN_GUEST": "1",
        "PATH": os.pathsep.join((*map(str, path), os.environ["PATH"])),
        **settings,
    }
    words = [WITH_VCAN, *command]
    return subprocess.run(words, env=environment, capture_output=True, text=True, check=False, timeout=60)


@pytest.fixture
def stub(tmp_path):
    """Puts scripts in the place of programs that with-vcan calls; gives the folder that they are in."""

    def put(**scripts):
        for name, script in scripts.items():
            program = tmp_path / name.replace("_", ".")
            program.write_text(f"#!/bin/bash\n{script}\n")
            program.chmod(0o755)
        return tmp_path

    return put


class TestChoice:
    GUEST = 'echo "${LD_PRELOAD-}" >&3; for shared; do :; done; echo 0 >"$shared/status"'
    """Says what was preloaded, to COMMAND's standard output; its last argument is the shared directory."""

    @pytest.mark.parametrize("amx", [True, False])
    @pytest.mark.parametrize(
        ("setting", "loaded"), [("on", True), ("off", False), ("auto", None), (None, None)]
    )
    def test_the_shim_is_loaded_where_it_is_needed_or_told(self, stub, setting, loaded, amx):
        looks = f'[[ "$*" = *amx_tile* ]] && exit {int(not amx)}; exec {shutil.which("grep")} "$@"'
        settings = {} if setting is None else {"VCAN_SHIM": setting}
        ended = with_vcan("true", path=[stub(linux_uml=self.GUEST, grep=looks)], **settings)
        assert (ended.returncode, ended.stderr) == (0, "")
        assert ("uml_xstate.so" in ended.stdout) is (amx if loaded is None else loaded)

    def test_what_was_preloaded_before_still_is(self, stub):
        ended = with_vcan("true", path=[stub(linux_uml=self.GUEST)], VCAN_SHIM="on", LD_PRELOAD="libm.so.6")
        assert ended.stdout.endswith("uml_xstate.so libm.so.6\n")

    @pytest.mark.parametrize("guest", ["", "1"])
    def test_another_word_is_refused(self, guest):
        ended = with_vcan("true", VCAN_SHIM="yes", VCAN_GUEST=guest)
        assert ended.returncode == 2
        assert ended.stderr == "with-vcan: VCAN_SHIM is auto, on or off, not 'yes'\n"


class TestFailures:
    def test_a_guest_that_died_of_its_registers_is_told_in_a_sentence(self, stub):
        dies = "echo 'ptrace set fp regs failed, errno = 14'; kill -ABRT $$"
        ended = with_vcan("true", path=[stub(linux_uml=dies)], VCAN_SHIM="off")
        assert ended.returncode == 125
        assert ended.stderr == (
            "with-vcan: the guest cannot restore the AMX registers of this processor: set VCAN_SHIM=on\n"
        )

    @pytest.mark.parametrize(
        ("setting", "said"), [("off", "kernel panic"), ("on", "ptrace set fp regs failed, errno = 14")]
    )
    def test_of_any_other_death_the_console_is_shown(self, stub, setting, said):
        ended = with_vcan("true", path=[stub(linux_uml=f"echo '{said}'; exit 1")], VCAN_SHIM=setting)
        assert (ended.returncode, ended.stderr) == (125, f"{said}\n")

    def test_no_compiler(self, stub):
        ended = with_vcan("true", path=[stub(linux_uml="exit 0")], VCAN_SHIM="on", CC="false")
        assert ended.returncode == 125
        assert ended.stderr == (
            "with-vcan: the shim for AMX, uml_xstate.c, does not compile: gcc and libc6-dev are needed\n"
        )


@needs_guest
class TestGuest:
    @pytest.mark.long
    @pytest.mark.parametrize("setting", ["auto", "on"])
    def test_it_boots_and_ends_with_the_status_of_its_command(self, setting):
        ended = with_vcan("bash", "-c", "ip -br link show vcan0; exit 7", VCAN_SHIM=setting)
        assert (ended.returncode, ended.stderr) == (7, "")
        assert ended.stdout.startswith("vcan0")

    @pytest.mark.long
    def test_without_the_shim_it_boots_where_the_processor_has_no_amx(self):
        ended = with_vcan("true", VCAN_SHIM="off")
        assert ended.returncode == (125 if HAS_AMX else 0)
        assert ("AMX" in ended.stderr) is HAS_AMX


KERNEL = """
#include <errno.h>
#include <string.h>
#include <sys/uio.h>

char taken[AREA];
int takes;

long ptrace(int request, int pid, void *address, struct iovec *area) {
    if (request != 0x4204 && request != 0x4205) return pid + 1;
    size_t size = area->iov_len < AREA ? area->iov_len : AREA;
    if (request == 0x4204) {
        memset(area->iov_base, 0xEE, size);
        area->iov_len = size;
        return 0;
    }
    if (size != AREA) { errno = EFAULT; return -1; }
    memcpy(taken, area->iov_base, size);
    takes++;
    return 0;
}
"""

TRACER = """
import ctypes, json, sys
class Area(ctypes.Structure):
    _fields_ = [("base", ctypes.c_void_p), ("size", ctypes.c_size_t)]
libs = ctypes.CDLL(None, use_errno=True)
size, components = map(int, sys.argv[1:])
mine = bytearray(b"\\x55" * size)
if size >= 520:
    mine[512:520] = components.to_bytes(8, "little")
memory = (ctypes.c_char * size).from_buffer(mine)
area = Area(ctypes.addressof(memory), size)
results = [libs.ptrace(0x4205, 1, 0x202, ctypes.byref(area)) for _ in range(2)]
taken = bytes((ctypes.c_char * AREA).in_dll(libs, "taken"))
print(json.dumps([results, ctypes.get_errno(), mine.hex(), taken.hex(), libs.ptrace(7, 41, None, None),
                  ctypes.c_int.in_dll(libs, "takes").value]))
"""


@pytest.fixture(scope="module")
def compile_c(tmp_path_factory):
    def compiled(source, name, *options):
        library = tmp_path_factory.mktemp("compiled") / name
        words = ["cc", "-O2", "-shared", "-fPIC", *options, "-o", library, source, "-ldl"]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        return library

    return compiled


@pytest.fixture(scope="module")
def shim(compile_c):
    return compile_c(SHIM, "shim.so", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")


@pytest.fixture
def restore(shim, compile_c, tmp_path):
    """Restores registers twice through the shim, on a kernel of our own whose area has so many bytes."""

    def restored(kernel_bytes, guest_bytes, components):
        source = tmp_path / "kernel.c"
        source.write_text(KERNEL)
        kernel = compile_c(source, "kernel.so", f"-DAREA={kernel_bytes}")
        program = TRACER.replace("AREA", str(kernel_bytes))
        words = [sys.executable, "-c", program, str(guest_bytes), str(components)]
        environment = {**os.environ, "LD_PRELOAD": f"{shim} {kernel}"}
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
        results, errno, mine, taken, other, takes = json.loads(done.stdout)
        assert other == 42, "another request must pass as it is"
        return results, errno, bytes.fromhex(mine), bytes.fromhex(taken), takes

    return restored


class TestShim:
    @pytest.mark.parametrize("kernel_bytes", [832, 2440, 2688, GUEST_BYTES])
    def test_an_area_that_is_large_enough_passes_untouched(self, restore, kernel_bytes):
        """As on every processor without AMX. No component is left out, not even one that nobody knows."""
        results, _, mine, taken, takes = restore(kernel_bytes, GUEST_BYTES, 2**62 | 2**18 | AVX)
        assert results == [0, 0]
        assert takes == 2
        assert taken == mine[:kernel_bytes]

    @pytest.mark.parametrize("kernel_bytes", [2697, 11008, 2**17])
    def test_one_that_is_too_short_is_made_whole(self, restore, kernel_bytes):
        results, _, mine, taken, takes = restore(kernel_bytes, GUEST_BYTES, AVX)
        assert results == [0, 0]
        assert takes == 2
        assert taken == mine + bytes(kernel_bytes - GUEST_BYTES)

    @pytest.mark.skipif("avx" not in Path("/proc/cpuinfo").read_text(), reason="a processor without AVX")
    def test_what_the_guest_has_only_a_part_of_gets_its_initial_state(self, restore):
        _, _, mine, taken, _ = restore(11008, 831, AVX)  # AVX ends at 832
        assert int.from_bytes(taken[512:520], "little") == SSE
        assert taken[:512] == mine[:512]
        assert taken[520:831] == mine[520:]

    @pytest.mark.skipif(not HAS_AMX, reason="a processor without AMX")
    def test_tiles_get_their_initial_state(self, restore):
        taken = restore(11008, GUEST_BYTES, 2**18 | 2**17 | AVX)[3]
        assert int.from_bytes(taken[512:520], "little") == AVX

    @pytest.mark.parametrize(("kernel_bytes", "guest_bytes", "errno"), [(2**18, 2696, 75), (11008, 575, 14)])
    def test_what_it_cannot_make_whole_fails(self, restore, kernel_bytes, guest_bytes, errno):
        results, failure, _, _, takes = restore(kernel_bytes, guest_bytes, AVX)
        assert results == [-1, -1]
        assert failure == errno
        assert takes == 0
