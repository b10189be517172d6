/* SPDX-License-Identifier: Apache-2.0 */
#include "scheduler.h"

#include <math.h>

#include "detumble_gains.h"

static uint32_t one_less(uint32_t ticks)
{
    uint32_t rest = 0U;
    if (ticks > 0U) {
        rest = ticks - 1U;
    }
    return rest;
}

/* The impulse, shortened to the largest that one pulse can pay. */
static vec3 within_a_pulse(const coil_set *coils, vec3 impulse_nms, vec3 b_t)
{
    const float size = vec3_norm(impulse_nms);
    const float most = coils->pulse_s * coils->level_am2[LEVELS - 1U] * vec3_norm(b_t);
    return (size > most) ? vec3_scale(most / size, impulse_nms) : impulse_nms;
}

void scheduler_boot(scheduler *state)
{
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        state->wait_ticks[coil] = BACKOFF_TICKS;
    }
    state->busy_ticks = 0U;
    state->owed_nms = VEC3_ZERO;
}

void scheduler_tick(scheduler *state)
{
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        state->wait_ticks[coil] = one_less(state->wait_ticks[coil]);
    }
    state->busy_ticks = one_less(state->busy_ticks);
}

void scheduler_forget(scheduler *state)
{
    state->owed_nms = VEC3_ZERO;
}

void scheduler_owe(scheduler *state, const coil_set *coils, vec3 torque_nm, vec3 b_t)
{
    /* what is forgotten is subtracted: a factor just below 1 would be rounded, alike in each tick */
    const vec3 forgotten = vec3_scale(coils->tick_s / GAINS_LEAK_S, state->owed_nms);
    const vec3 kept = vec3_sub(state->owed_nms, forgotten);
    const vec3 owed = vec3_add(kept, vec3_scale(coils->tick_s, torque_nm));
    state->owed_nms = within_a_pulse(coils, owed, b_t);
}

/* What a pulse fired now is to pay: the demand is taken to last until the next. */
static vec3 due_nms(const scheduler *state, const coil_set *coils, vec3 torque_nm, vec3 b_t)
{
    const uint32_t cycle_ticks = CYCLE_TICKS;
    const float half_s = 0.5F * coils->tick_s * (float)cycle_ticks;
    return within_a_pulse(coils, vec3_add(state->owed_nms, vec3_scale(half_s, torque_nm)), b_t);
}

coil_pulse scheduler_choose(const scheduler *state, const coil_set *coils, vec3 torque_nm, vec3 b_t)
{
    coil_pulse best = {0U, 0};
    float least = 0.0F; /* (r - u)' W (r - u) - r' W r, for the impulse u of a pulse */
    const vec3 weighted = mat3_transform(&coils->metric, due_nms(state, coils, torque_nm, b_t));
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        if ((state->busy_ticks == 0U) && (state->wait_ticks[coil] == 0U)) {
            const vec3 gain = vec3_scale(coils->pulse_s, vec3_cross(coils->axis[coil], b_t));
            const float along = vec3_dot(weighted, gain);
            const float square = vec3_dot(gain, mat3_transform(&coils->metric, gain));
            int8_t level = (along > 0.0F) ? 1 : -1;
            const int8_t step = level;
            for (uint32_t place = 0U; place < LEVELS; place++) {
                const float level_am2 = coils->level_am2[place];
                const float change = level_am2 * ((level_am2 * square) - (2.0F * fabsf(along)));
                if (change < least) {
                    least = change;
                    best.coil = (uint8_t)coil;
                    best.level = level;
                }
                level = (int8_t)(level + step);
            }
        }
    }
    return best;
}

void scheduler_fire(scheduler *state, coil_pulse pulse, vec3 paid_nms)
{
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        if ((TORQUER_BACKOFF_SHARED == 1) || (coil == pulse.coil)) {
            state->wait_ticks[coil] = CYCLE_TICKS;
        }
    }
    state->busy_ticks = PULSE_TICKS;
    state->owed_nms = vec3_sub(state->owed_nms, paid_nms);
}
