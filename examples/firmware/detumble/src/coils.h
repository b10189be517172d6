/* SPDX-License-Identifier: Apache-2.0 */
/* The coils of the satellite and their limits, as torquer_scenario.h has them, in ticks and single precision. */
#ifndef COILS_H
#define COILS_H

#include <stdint.h>

#include "torquer_scenario.h"
#include "vector.h"

#define COILS 3U
#define LEVELS 3U

#if TORQUER_COILS_PULSED != 1
#error "this flight software drives pulsed coils; the scenario has a continuous driver"
#endif
#if (TORQUER_PULSE_MS * TORQUER_TICK_HZ) < 1000
#error "the longest pulse of the scenario is shorter than a tick"
#endif

#define TICK_HZ ((uint32_t)TORQUER_TICK_HZ)

/* The pulse rounded down, the back-off rounded up: never longer, never shorter. */
#define PULSE_TICKS ((TORQUER_PULSE_MS * TICK_HZ) / 1000U)
#define BACKOFF_TICKS (((TORQUER_BACKOFF_MS * TICK_HZ) + 999U) / 1000U)
#define DURATION_MS ((PULSE_TICKS * 1000U) / TICK_HZ)
#define CYCLE_TICKS (PULSE_TICKS + BACKOFF_TICKS)

typedef struct {
    vec3 axis[COILS];         /* dipole for 1 A m^2 of that coil, body axes */
    float level_am2[LEVELS];  /* of levels 1, 2, 3 */
    float mean_am2;           /* of the strongest pulses, one after the other */
    float pulse_s;
    float tick_s;
    mat3 metric; /* J^-2: what an impulse that is left costs is the square of the rate it leaves */
} coil_set;

/* A pulse: coil 0 to 2, level -3 to 3. Level 0 is none. */
typedef struct {
    uint8_t coil;
    int8_t level;
} coil_pulse;

coil_set coils_of_scenario(void);

/* The angular impulse of a pulse, T_p m x b, body axes [N m s]. */
vec3 coils_impulse(const coil_set *coils, coil_pulse pulse, vec3 b_t);

#endif
