# SPDX-License-Identifier: Apache-2.0
"""The scheduler of PoSAT-1: pulses of 3 s, one coil at a time, three levels, then a back-off of 100 s.

What the law demands is owed: the angular impulse of its torque, added up tick by tick, forgotten with a time
constant, and never more than one pulse can pay. When the timer lets a coil fire, the pulse is chosen that
leaves least of the rate that is due by the middle between this pulse and the next. None is a choice too.

The timer is an integer of ticks that were answered: a tick that is lost makes no back-off shorter.
"""

import math

import satellite

PULSE_TICKS = satellite.PULSE_MS * satellite.TICK_HZ // 1000
BACKOFF_TICKS = -(-satellite.BACKOFF_MS * satellite.TICK_HZ // 1000)
DURATION_MS = PULSE_TICKS * 1000 // satellite.TICK_HZ
PULSE_S = DURATION_MS / 1000.0
TICK_S = 1.0 / satellite.TICK_HZ
METRIC = [1.0 / (moment * moment) for moment in satellite.INERTIA_KGM2]  # impulse to rate, squared


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def impulse_nms(coil, level, b_t):
    """That of a pulse, body axes."""
    m_am2 = [0.0, 0.0, 0.0]
    m_am2[coil] = math.copysign(satellite.LEVELS_AM2[abs(level) - 1], level)
    return [PULSE_S * axis for axis in cross(m_am2, b_t)]


def within_a_pulse(impulse, b_t):
    """The impulse, shortened to the largest that one pulse can pay."""
    size = math.sqrt(sum([axis * axis for axis in impulse]))
    most = PULSE_S * satellite.LEVELS_AM2[-1] * math.sqrt(sum([axis * axis for axis in b_t]))
    return [most / size * axis for axis in impulse] if size > most else impulse


class Scheduler:
    """What is owed, and how long no coil may fire. After boot a whole back-off comes first."""

    def __init__(self):
        self.wait_ticks = BACKOFF_TICKS
        self.owed_nms = [0.0, 0.0, 0.0]

    def tick(self):
        """The next tick has come."""
        self.wait_ticks = max(0, self.wait_ticks - 1)

    def forget(self):
        self.owed_nms = [0.0, 0.0, 0.0]

    def owe(self, torque_nm, b_t):
        """Add a tick of this torque."""
        kept = 1.0 - TICK_S / satellite.LEAK_S
        owed = [kept * self.owed_nms[n] + TICK_S * torque_nm[n] for n in range(3)]
        self.owed_nms = within_a_pulse(owed, b_t)

    def choose(self, torque_nm, b_t):
        """(coil, level) of the best pulse; level 0: none, or none yet."""
        best, least = (0, 0), 0.0  # of (r - u)' W (r - u) - r' W r, for the impulse u of a pulse
        if self.wait_ticks:
            return best
        half_s = 0.5 * TICK_S * (PULSE_TICKS + BACKOFF_TICKS)
        due = within_a_pulse([self.owed_nms[n] + half_s * torque_nm[n] for n in range(3)], b_t)
        for coil in range(3):
            for level in (1, -1, 2, -2, 3, -3):
                paid = impulse_nms(coil, level, b_t)
                change = sum([METRIC[n] * paid[n] * (paid[n] - 2.0 * due[n]) for n in range(3)])
                if change < least:
                    best, least = (coil, level), change
        return best

    def fire(self, coil, level, b_t):
        """This pulse has been requested."""
        paid = impulse_nms(coil, level, b_t)
        self.wait_ticks = PULSE_TICKS + BACKOFF_TICKS
        self.owed_nms = [self.owed_nms[n] - paid[n] for n in range(3)]
