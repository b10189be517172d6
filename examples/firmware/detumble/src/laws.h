/* SPDX-License-Identifier: Apache-2.0 */
/* Control laws: from field, attitude and rate to the dipole that is wanted. All in body axes and SI. */
#ifndef LAWS_H
#define LAWS_H

#include "vector.h"

/* m = -k_w db/dt, by the difference of two samples interval_s apart. It brakes, and needs nothing but the field.
 *
 * Ovchinnikov, Roldugin 2019, eq. 2. b_t, before_t [T], interval_s > 0 [s], k_w [N m s / T^2]; returns A m^2. */
vec3 bdot_dipole(vec3 b_t, vec3 before_t, float interval_s, float k_w);

/* E = 4 qv of the shorter turn: about twice the angle near zero, largest at 180 deg.
 *
 * q: vector part of the unit quaternion from orbital frame to body axes whose scalar part is not negative. */
vec3 attitude_error(vec3 q);

/* m = -k_w b x Omega - k_a b x E: it brakes against the orbital frame, and turns the body into it.
 *
 * Ovchinnikov, Roldugin, Ivanov, Penkov 2015, eq. 3. omega_radps [rad/s], k_a [N m / T^2]; returns A m^2. */
vec3 pd_dipole(vec3 b_t, vec3 omega_radps, vec3 error, float k_w, float k_a);

/* m = -k_i b x I, against a torque that lasts. integral_s: of the error [s], k_i [N m / (T^2 s)]; returns A m^2. */
vec3 holding_dipole(vec3 b_t, vec3 integral_s, float k_i);

/* A term x of the law, shortened to where gain |b| |x| is at most the dipole most_am2.
 *
 * So the integral does not wind up, and an error far from the goal does not take all that the coils give: the rate
 * would have no say, and the body would tumble on. Wie, Lu 1995: the attitude's term is limited, not the rate's. */
vec3 within_dipole(vec3 b_t, vec3 term, float gain, float most_am2);

#endif
