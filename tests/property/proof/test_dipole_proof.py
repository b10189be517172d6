"""The continuous driver by exhaustion: every three ticks of a board that is on, off or restarts.

The flight side (``update_view`` and ``actuate``, unchanged) is run against the board, through encoded frames.
COIL_DIPOLE_STATUS is heard or lost; COIL_DIPOLE comes, is lost, or comes a tick late. Demanded is a dipole,
an impulse, or nothing.
"""

from itertools import product

import pytest

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, actuate, update_view
from fsw.core.actuation.dipoles import DipoleConfig
from fsw.core.gate.calibration import NO_CALIBRATION, measure
from fsw.core.gate.readings import GateState, admit
from fsw.core.laws.interface import Demand
from fsw.wire.messages import CoilBoot, CoilDipole, CoilDipoleStatus
from hil_stub.coils.dipole_driver import DipoleDriver

TICKS = 3
FIELD = (2e-5, -1e-5, 3e-5)
DEMANDS = {
    "dipole": Demand((0.3, -4.0, 0.1)),
    "impulse": Demand(impulse_body_nms=(1e-4, 2e-4, -1e-4)),
    "nothing": None,
}
SEQUENCES = [
    *([name] * TICKS for name in DEMANDS),
    ["impulse", "nothing", "impulse"],
    ["dipole", "nothing", "nothing"],
    ["nothing", "impulse", "dipole"],
    ["dipole", "impulse", "impulse"],
]
BOARDS, STATUSES, REQUESTS = ("on", "off", "restarts"), ("heard", "lost"), ("comes", "lost", "late")
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
TIMING = pulses.PulseConfig(1, 1, 1000, True, (1.0, 2.0, 3.0), 1.0, 1.0, 300.0, IDENTITY, IDENTITY)
CONFIG = ActuatorConfig(TIMING, DipoleConfig(5.0, IDENTITY, genetic=False))


class Line:
    """Flight side and board, the frames between them, and what may be demanded of both."""

    def __init__(self):
        self.state = pulses.boot(-TIMING.backoff_ticks, TIMING)  # its back-off is over
        self.view, self.gate = CoilView(), GateState()
        self.board = DipoleDriver(1)
        self.late = []
        self.sent = self.driven = 0
        self.began = None

    def tick(self, tick, demand, board, status, request):
        if board == "restarts" or (board == "on" and self.board is None):
            self.board = DipoleDriver(1)
        if board == "off":
            self.board = None
        said = [] if self.board is None else self.board.begin_tick(tick, 0.0)
        heard = [f for f in said if status == "heard" or f.can_id in (CoilBoot.ID,)]
        readings = measure(admit(tuple(heard), self.gate), NO_CALIBRATION)
        update_view(self.view, readings, tick, CONFIG)
        asked = actuate(self.state, self.view, demand, FIELD, readings, tick, CONFIG)
        self.judge_request(tick, asked, demand, told=any(f.can_id == CoilDipoleStatus.ID for f in heard))
        self.judge_drive(asked, request)

    def judge_request(self, tick, asked, demand, told):
        """Nothing to a board that is not heard, nothing undemanded; an impulse for a pulse alone."""
        assert asked is None or isinstance(asked, CoilDipole)
        assert asked is None or told
        assert asked is None or demand is not None
        assert asked is not None or demand is None or not told
        self.sent += asked is not None
        if demand is None:
            assert self.state.held_am2 == (0.0, 0.0, 0.0)
        elif demand.impulse_body_nms is not None and any(self.state.held_am2):
            self.began = (
                tick if self.began is None or tick > self.began + TIMING.backoff_ticks else self.began
            )
            assert tick == self.began, "held for a pulse alone"

    def judge_drive(self, asked, fate):
        """Each request is driven once at most, in the tick in which it comes."""
        new = [asked.replace(counter=self.sent & 0xF).encode()] if asked is not None else []
        come = self.late + (new if fate == "comes" else [])
        self.late = new if fate == "late" else []
        if self.board is None:
            return
        for frame in come:
            self.board.receive(frame)
        drive = self.board.drive()
        if not come:
            assert drive.dipole == (0.0, 0.0, 0.0)
        self.driven += any(drive.dipole)
        assert self.driven <= self.sent


@pytest.mark.long
@pytest.mark.parametrize("demands", SEQUENCES, ids=" ".join)
def test_nothing_is_sent_to_a_board_that_is_off_and_nothing_driven_unasked(demands):
    driven = 0
    for course in product(product(BOARDS, STATUSES, REQUESTS), repeat=TICKS):
        line = Line()
        for tick, (name, fates) in enumerate(zip(demands, course, strict=True)):
            line.tick(tick, DEMANDS[name], *fates)
        driven += line.driven
    assert (driven > 0) is (set(demands) != {"nothing"})


def test_a_board_that_is_off_is_asked_again_when_it_is_back():
    line = Line()
    for tick, board in enumerate(["on", "off", "off", "on", "on"]):
        before = line.driven
        line.tick(tick, DEMANDS["dipole"], board, "heard", "comes")
        assert line.driven - before == (board == "on")
