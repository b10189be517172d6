"""The coil board in C, compiled for this machine and called as the stub's bench is."""

import re
from pathlib import Path
from struct import Struct

from c_compiler import COMPILER, compile_c, harness_of

from fsw.bus import can_frame
from hil_stub.coils.coil_driver import Pin

ROOT = Path(__file__).resolve().parents[2]
BOARD = ROOT / "examples" / "firmware" / "coil_board"
NO_COMPILER = f"the coil board in C needs the compiler {COMPILER}, which is not installed"
_REQUEST = Struct("<B3xIi16s")
REPLY = Struct("<BbBxI")
_REPLY_MOST = REPLY.size + can_frame.SIZE * 69
_CLOCK = 2**32


def limits_header(**values):
    """The header of limits that ships, with other values: ``tick_hz=10``."""
    text = (BOARD / "limits" / "coil_limits.h").read_text()
    for name, value in values.items():
        text, found = re.subn(rf"(?m)^(#define LIMITS_{name.upper()}) \d+(U?)$", rf"\1 {value:d}\2", text)
        assert found == 1, name
    return text


def limit(name):
    """The value of a limit in the header that ships."""
    return int(re.search(rf"(?m)^#define LIMITS_{name.upper()} (\d+)U?$", limits_header())[1])


LEVELS_MA = tuple(limit(f"level_{level}_ma") for level in (1, 2, 3))
"""Nominal currents of the header that ships."""


def compile_board(folder, limits=None, board=BOARD, strict=True):
    """The sources of ``board`` as a library in ``folder``, which holds the header of its limits, too."""
    host = board / "host"
    words = ["-shared", "-fPIC", str(host / "harness.c"), str(host / "record.c")]
    return _compile(folder / "coil_board.so", limits, board, words, strict)


def compile_program(folder, limits=None):
    """The board as a program of this machine."""
    host = BOARD / "host"
    words = [str(host / name) for name in ("main.c", "record.c", "slcan.c")]
    return _compile(folder / "coil_board", limits, BOARD, words)


def _compile(product, limits, board, words, strict=True):
    folder = product.parent
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "coil_limits.h").write_text(limits_header() if limits is None else limits)
    sources = [str(source) for source in sorted((board / "src").glob("*.c"))]
    includes = [f"-I{folder}", f"-I{board / 'src'}"]
    return compile_c(product, [*includes, *sources, *words], "the coil board", strict)


def loaded(library):
    """The board of a library, as ``compile_board`` gives it: from request to reply. There is one in each."""
    step = harness_of(library, _REPLY_MOST)

    def answer(request):
        reply, _ = step(request)
        return reply

    return answer


class FirmwareBench:
    """A board in C as a bench: its coils draw their nominal current at once.

    Args:
        step: the board, from request to reply, as ``loaded`` gives it.
        clock_ms: what the board's clock reads when the bench's reads 0; it counts modulo 2^32.
        current_ma: what the board measures; None: the current of what it drives.
    """

    def __init__(self, step, clock_ms=0, current_ma=None):
        self._step = step
        self._clock_ms = clock_ms
        self._current_ma = self._nominal_ma if current_ma is None else current_ma
        self.pin = None

    def switch_on(self, tick=0, now_ms=0):
        self.pin = None
        return self._do(0, now_ms, Struct("<I12x").pack(tick))

    def receive(self, frame, now_ms=0):
        return self._do(1, now_ms, can_frame.pack(frame))

    def watch(self, now_ms):
        self._do(2, now_ms, bytes(16))

    def due_ms(self):
        return None if self.pin is None else self.pin.until_ms

    def _nominal_ma(self):
        pin = self.pin
        if pin is None:
            return 0
        current_ma = LEVELS_MA[abs(pin.level) - 1]
        return current_ma if pin.level > 0 else -current_ma

    def _do(self, what, now_ms, record):
        clock_ms = (self._clock_ms + now_ms) % _CLOCK
        reply = self._step(_REQUEST.pack(what, clock_ms, self._current_ma(), record))
        coil, level, count, until_ms = REPLY.unpack_from(reply)
        left_ms = (until_ms - clock_ms) % _CLOCK
        self.pin = Pin(coil, level, now_ms + left_ms) if level else None
        if not count:
            return []
        return list(can_frame.unpack(reply[REPLY.size : REPLY.size + count * can_frame.SIZE]))
