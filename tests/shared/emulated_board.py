"""The coil board in C on an emulated Cortex-M3: in a test's hands, and in real time with its two UARTs."""

import re
import shutil
import subprocess
import time
from queue import SimpleQueue
from threading import Thread

from firmware_bench import BOARD, REPLY, limits_header
from process_target import ProcessTarget

from fsw.bus import can_frame
from fsw.bus.open_bus import open_bus

EMULATOR = "qemu-system-arm"
MACHINE = "mps2-an385"
CROSS = "arm-none-eabi-"
NEEDED = (EMULATOR, f"{CROSS}gcc", "cmake")
NO_EMULATOR = f"the coil board on an emulated processor needs {', '.join(NEEDED)}, and one is not installed"


def has_emulator():
    return all(shutil.which(program) for program in NEEDED)


def build_images(folder, **limits):
    """``coil_board.elf`` and ``harness.elf`` of a board with these limits, in the folder that is returned."""
    (folder / "limits").mkdir(parents=True)
    (folder / "limits" / "coil_limits.h").write_text(limits_header(**limits))
    toolchain = f"-DCMAKE_TOOLCHAIN_FILE={BOARD / 'qemu' / 'cortex-m3.cmake'}"
    words = ("-S", str(BOARD), "-B", str(folder / "build"), toolchain, f"-DLIMITS_DIR={folder / 'limits'}")
    for command in (("cmake", *words), ("cmake", "--build", str(folder / "build"))):
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            raise AssertionError(f"the images are not built:\n{done.stdout}{done.stderr}")
    return folder / "build"


def emulate(image, *words, **pipes):
    command = [EMULATOR, "-M", MACHINE, "-kernel", str(image), "-display", "none", "-monitor", "none", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, **pipes)


class EmulatedStep:
    """The board in an emulated processor, ``harness.elf``: from request to reply, until it is closed."""

    def __init__(self, image):
        semihosting = ("-serial", "none", "-semihosting-config", "enable=on,target=native")
        self._process = emulate(image, *semihosting, stdin=subprocess.PIPE, bufsize=0)

    def __call__(self, request):
        self._process.stdin.write(request)
        head = self._read(REPLY.size)
        count = REPLY.unpack(head)[2]
        return head + self._read(count * can_frame.SIZE)

    def _read(self, count):
        read = b""
        while len(read) < count:
            part = self._process.stdout.read(count - len(read))
            if not part:
                raise AssertionError("the emulated board has ended")
            read += part
        return read

    def close(self):
        self._process.kill()
        self._process.communicate()


def start_board(image):
    """``coil_board.elf`` in real time: its process, whose stdout tells its pins, and the bus of its UART."""
    process = emulate(image, "-serial", "pty", "-serial", "stdio", stdin=subprocess.DEVNULL, text=True)
    for line in process.stdout:
        if found := re.search(r"/dev/pts/\d+", line):
            return process, f"slcan:{found[0]}"
    raise AssertionError(f"{EMULATOR} does not start")


class EmulatedTarget(ProcessTarget):
    """The emulated board under attack; its pins by its own clock, counted from when it was heard first."""

    AHEAD_MS = 1000  # its first line may be heard late
    STOP = 0.0  # what stops this processor stops its timer too

    def __init__(self, image, judge, random):
        self._image = image
        super().__init__(None, judge, random)

    def stop(self):
        self._bus.close()
        super().stop()

    def close(self):
        self.stop()

    def _open(self):
        """Each start has a bus of its own."""

    def _start(self):
        self._process, spec = start_board(self._image)
        assert self._process.stdout.readline() == "0 off\n"
        self._began_ms = self.now_ms()
        self._lines = SimpleQueue()
        self._reader = Thread(target=self._read, args=(self._process.stdout, self._lines), daemon=True)
        self._reader.start()
        self._bus = open_bus(spec)
        time.sleep(STARTS_S)

    def _true_ms(self, told_ms):
        return self._began_ms + told_ms


STARTS_S = 1.1
"""The emulator looks once a second whether its serial port has been opened."""
