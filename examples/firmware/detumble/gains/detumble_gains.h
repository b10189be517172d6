/* SPDX-License-Identifier: Apache-2.0 */
/* Gains and thresholds of one satellite: with what torquer header writes, all that differs from satellite to
 * satellite.
 *
 * These are for the default scenario, microsat.
 */
#ifndef DETUMBLE_GAINS_H
#define DETUMBLE_GAINS_H

/* Of the rate, for B-dot and PD [N m s / T^2]; of the attitude, for PD [N m / T^2]. */
#define GAINS_K_W 6.2694e6F
#define GAINS_K_A 1614.9F

/* Of the integral of the attitude, against a constant torque [N m / (T^2 s)]. It grows while the error is less
 * than this [rad]: 20 deg. */
#define GAINS_K_I 0.2F
#define GAINS_NEAR_RAD 0.34907F

/* Time constant with which an owed impulse is forgotten [s]. */
#define GAINS_LEAK_S 300.0F

/* PD from below the first rate on, B-dot from above the second on; against the orbital frame: 0.3 and 0.6 deg/s [rad/s]. */
#define GAINS_SLOW_RADPS 5.236e-3F
#define GAINS_FAST_RADPS 1.0472e-2F

/* Largest read-back of coils that are off, a tenth of the current of level 1; above it one is stuck [mA]. */
#define GAINS_OFF_MA 2

/* How old a sample of the magnetometer may be: for so many ticks after a pulse none is used. */
#define GAINS_BLANK_TICKS 0U

#endif
