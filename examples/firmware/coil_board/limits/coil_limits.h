/* SPDX-License-Identifier: Apache-2.0 */
/* The limits of one satellite's coil driver board: the only file that differs from satellite to satellite.
 *
 * These are those of the scenario microsat. Nothing on the bus can change them.
 */
#ifndef COIL_LIMITS_H
#define COIL_LIMITS_H

/* Ticks a second, 1 to 1000. */
#define LIMITS_TICK_HZ 1U

/* Longest pulse, and from the end of a pulse to the next start [ms]. */
#define LIMITS_PULSE_MS 3000U
#define LIMITS_BACKOFF_MS 100000U

/* 1: a pulse locks out all coils; 0: its own alone. */
#define LIMITS_SHARED 1

/* Silence of SYNC after which all is off and locked out in full [ms]; 0: there is no dead-man. */
#define LIMITS_DEADMAN_MS 5000U

/* Nominal currents at levels 1, 2, 3 [mA]. */
#define LIMITS_LEVEL_1_MA 25
#define LIMITS_LEVEL_2_MA 100
#define LIMITS_LEVEL_3_MA 400

/* CRC-32 of the table that these values come from, reported in COIL_BOOT. */
#define LIMITS_TABLE_CRC 0U

#endif
