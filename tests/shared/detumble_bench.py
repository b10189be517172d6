"""The flight software in C, compiled for this machine and fed with golden vectors."""

import json
import shutil
from pathlib import Path
from struct import Struct
from typing import NamedTuple

from c_compiler import COMPILER, compile_c, harness_of

from fsw.bus import can_frame
from fsw.wire.frame import Frame
from sim.export.c_source import SOURCE, c_files

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "examples" / "firmware" / "detumble"
NO_COMPILER = f"the flight software in C needs the compiler {COMPILER}, which is not installed"
BOOT, STEP, BOOT_SCHEDULER, SCHEDULE = range(4)
_FRAMES_MOST = 32
REQUEST = Struct(f"<BBxx{can_frame.SIZE * _FRAMES_MOST}s")
REPLY_MOST = 4 + can_frame.SIZE * 16
SCHEDULED = Struct("<Bbxx3I3fI")
_SIX = Struct("<6f")


def write_contract(folder, scenario):
    """What ``torquer header`` writes of this scenario."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in c_files(scenario).items():
        (folder / name).write_text(text)
    return folder


def compile_program(folder, scenario, planted=()):
    """The flight software as a program of this machine, for the satellite of this scenario.

    ``planted``: an error: file of the core, what stands there, and what is to stand there instead.
    """
    core = folder / "src"
    shutil.copytree(FIRMWARE / "src", core)
    if planted:
        name, right, wrong = planted
        text = (core / name).read_text()
        assert text.count(right) == 1, planted
        (core / name).write_text(text.replace(right, wrong))
    return _compile(folder / "detumble", scenario, ("main.c", "record.c"), core=core)


def compile_library(folder, scenario):
    """The flight software in a test's hands, for the satellite of this scenario."""
    flags = ("-shared", "-fPIC")
    return _compile(folder / "detumble.so", scenario, ("harness.c", "record.c"), flags=flags)


def _compile(product, scenario, host, core=FIRMWARE / "src", flags=()):
    contract = write_contract(product.parent / "contract", scenario)
    sources = [*sorted(core.glob("*.c")), *(FIRMWARE / "host" / name for name in host)]
    includes = [f"-I{folder}" for folder in (core, FIRMWARE / "host", FIRMWARE / "gains", contract)]
    return compile_c(product, [*flags, *includes, *sources, contract / SOURCE], "the flight software")


def loaded(library):
    """The flight software of a library, from request to reply. There is one in each."""
    step = harness_of(library, REPLY_MOST)

    def answer(request):
        reply, length = step(request)
        return reply.raw[:length]

    return answer


class Scheduled(NamedTuple):
    """What the scheduler in C fires in a tick, and its state then."""

    coil: int
    level: int
    wait_ticks: tuple[int, int, int]
    owed_nms: tuple[float, float, float]
    busy_ticks: int


class Firmware:
    """The flight software: frames in, frames out.

    Args:
        step: from request to reply, as ``loaded`` gives it.
    """

    def __init__(self, step):
        self._step = step

    def boot(self):
        return _frames(self._step(REQUEST.pack(BOOT, 0, b"")))

    def answer(self, frames):
        """What it answers to these frames, in which there are at most eight SYNC."""
        answers = []
        for first in range(0, len(frames), _FRAMES_MOST):
            part = frames[first : first + _FRAMES_MOST]
            answers += _frames(self._step(REQUEST.pack(STEP, len(part), can_frame.pack_all(part))))
        return answers

    def boot_scheduler(self):
        self._step(REQUEST.pack(BOOT_SCHEDULER, 0, b""))

    def schedule(self, m_body_am2, b_body_t):
        """A tick of the scheduler alone."""
        reply = self._step(REQUEST.pack(SCHEDULE, 0, _SIX.pack(*m_body_am2, *b_body_t)))
        coil, level, *rest = SCHEDULED.unpack(reply)
        return Scheduled(coil, level, tuple(rest[:3]), tuple(rest[3:6]), rest[6])


def _frames(reply):
    return list(can_frame.unpack(reply[4 : 4 + reply[0] * can_frame.SIZE]))


class Vector(NamedTuple):
    """A tick of golden vectors."""

    tick: int
    incoming: list[Frame]
    outgoing: list[Frame]


def read_vectors(path):
    """The ticks of a file that ``torquer vectors`` has written, the boot first."""
    with path.open(encoding="ascii") as file:
        assert json.loads(next(file))["format"] == "torquer-vectors/1"
        return [_vector(json.loads(line)) for line in file]


def _vector(line):
    return Vector(line["tick"], _of_texts(line["in"]), _of_texts(line["out"]))


def _of_texts(texts):
    parts = (text.split("#") for text in texts)
    return [Frame(int(can_id, 16), bytes.fromhex(data)) for can_id, data in parts]
