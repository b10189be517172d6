"""The flight software in C on an emulated Cortex-M3: size of its image, its answers, instructions a tick."""

import shutil
import subprocess
from struct import Struct

from detumble_bench import FIRMWARE, SCHEDULED, STEP, write_contract

from fsw.bus import can_frame

EMULATOR = "qemu-system-arm"
MACHINE = "mps2-an385"
CROSS = "arm-none-eabi-"
NEEDED = (EMULATOR, f"{CROSS}gcc", "cmake")
NO_EMULATOR = (
    f"the flight software on an emulated processor needs {', '.join(NEEDED)}, and one is not installed"
)
SHIFT = 6
"""An instruction takes 2^SHIFT ns of the emulated time."""
CLOCK_NS = 40
_CLOCKS = Struct("<I")


def has_emulator():
    return all(shutil.which(program) for program in NEEDED)


def build_image(folder, scenario):
    """``harness.elf`` for the satellite of this scenario."""
    contract = write_contract(folder / "contract", scenario)
    toolchain = f"-DCMAKE_TOOLCHAIN_FILE={FIRMWARE / 'qemu' / 'cortex-m3.cmake'}"
    words = ("-S", str(FIRMWARE), "-B", str(folder / "build"), toolchain, f"-DCONTRACT_DIR={contract}")
    for command in (("cmake", *words), ("cmake", "--build", str(folder / "build"))):
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            raise AssertionError(f"the image is not built:\n{done.stdout}{done.stderr}")
    return folder / "build" / "harness.elf"


def sizes(image):
    """Bytes of text, data and bss."""
    rows = subprocess.run([f"{CROSS}size", str(image)], check=True, capture_output=True, text=True)
    text, data, bss, *_ = rows.stdout.splitlines()[-1].split()
    return int(text), int(data), int(bss)


class EmulatedStep:
    """The flight software in an emulated processor, from request to reply, until it is closed."""

    def __init__(self, image):
        words = (EMULATOR, "-M", MACHINE, "-kernel", str(image), "-display", "none", "-monitor", "none")
        words += ("-serial", "none", "-semihosting-config", "enable=on,target=native")
        words += ("-icount", f"shift={SHIFT}")
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self._process = subprocess.Popen(words, bufsize=0, **pipes)
        self.instructions = 0

    def __call__(self, request):
        self._process.stdin.write(request)
        (clocks,) = _CLOCKS.unpack(self._read(_CLOCKS.size))
        self.instructions = clocks * CLOCK_NS >> SHIFT
        if request[0] > STEP:
            return self._read(SCHEDULED.size)
        head = self._read(4)
        return head + self._read(head[0] * can_frame.SIZE)

    def _read(self, count):
        read = b""
        while len(read) < count:
            part = self._process.stdout.read(count - len(read))
            if not part:
                raise AssertionError("the emulated flight software has ended")
            read += part
        return read

    def close(self):
        self._process.kill()
        self._process.communicate()
