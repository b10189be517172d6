/* SPDX-License-Identifier: Apache-2.0 */
/* The actuation scheduler of PoSAT-1: short pulses, one coil at a time, three levels, a long back-off.
 *
 * What a law demands is owed: the angular impulse of its torque, added up tick by tick, forgotten with the time
 * constant GAINS_LEAK_S and never more than one pulse can pay. When the timers let a coil fire, the pulse is
 * chosen that leaves the least of what is due: what is owed, and what will be by the middle between this pulse
 * and the next. None is a choice too, and wins a tie.
 *
 * Timers are counts of ticks that run down to 0, by one in each tick that is answered: a tick that was lost
 * does not count, so that no back-off ends early. After boot a whole back-off comes first.
 */
#ifndef SCHEDULER_H
#define SCHEDULER_H

#include <stdbool.h>

#include "coils.h"

typedef struct {
    uint32_t wait_ticks[COILS]; /* until this coil may fire: 0, in answer to this tick */
    uint32_t busy_ticks;        /* until the requested pulse is over */
    vec3 owed_nms;              /* body axes */
} scheduler;

void scheduler_boot(scheduler *state);

/* The next tick has come. */
void scheduler_tick(scheduler *state);

/* Nothing is owed any more. */
void scheduler_forget(scheduler *state);

/* Add a tick of this torque to what is owed. torque_nm, b_t: body axes [N m], [T]. */
void scheduler_owe(scheduler *state, const coil_set *coils, vec3 torque_nm, vec3 b_t);

/* The best pulse of the coils whose timers have run out, of level 0 if none is better. */
coil_pulse scheduler_choose(const scheduler *state, const coil_set *coils, vec3 torque_nm, vec3 b_t);

/* This pulse has been requested in answer to this tick, and pays this impulse [N m s]. */
void scheduler_fire(scheduler *state, coil_pulse pulse, vec3 paid_nms);

#endif
