# SPDX-License-Identifier: Apache-2.0
"""All that differs from satellite to satellite: limits, levels, inertia and gains. These are of microsat."""

TICK_HZ = 1
PULSE_MS = 3000
BACKOFF_MS = 100000  # of all coils, from the end of a pulse
LEVELS_AM2 = (0.5, 2.0, 8.0)  # per polarity, of the coils along the axes of the body
OFF_MA = 2  # largest read-back of coils that are off, a tenth of the current of level 1

INERTIA_KGM2 = (1.02, 1.85, 1.95)  # principal moments
K_W = 6.2694e6  # of B-dot, N m s / T^2
LEAK_S = 300.0  # time constant with which an owed impulse is forgotten

SPAN_TICKS = 10 * TICK_HZ  # over which the change of the field is taken: a small part of a turn
LEAP_TICKS = 60 * TICK_HZ  # a SYNC no further ahead is believed: those between were lost
