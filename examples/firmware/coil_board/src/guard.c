/* SPDX-License-Identifier: Apache-2.0 */
#include "guard.h"

#include "coil_limits.h"

#define UNITS_PER_TICK 1000U
#define UNITS_PER_MS LIMITS_TICK_HZ
#define BACKOFF_UNITS (LIMITS_BACKOFF_MS * UNITS_PER_MS)
#define LEVEL_MOST 3
#define CLOCK_BACKWARDS 0x80000000U
#define LOCKOUT_STEP_MS 10U

#if (LIMITS_TICK_HZ < 1) || (LIMITS_TICK_HZ > 1000)
#error "LIMITS_TICK_HZ must be 1 to 1000"
#endif
#if (LIMITS_PULSE_MS < 1) || (LIMITS_PULSE_MS > 4095)
#error "LIMITS_PULSE_MS must be 1 to 4095, as remaining_ms of COIL_STATUS carries no more"
#endif
#if (LIMITS_PULSE_MS + LIMITS_BACKOFF_MS) > 163830
#error "LIMITS_PULSE_MS and LIMITS_BACKOFF_MS together must be at most 163830, as lockout_ms of COIL_STATUS carries no more"
#endif

static uint32_t larger(uint32_t a, uint32_t b)
{
    return (a > b) ? a : b;
}

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return (a < b) ? a : b;
}

static uint32_t run_down(uint32_t left, uint32_t units)
{
    uint32_t rest = 0U;
    if (left > units) {
        rest = left - units;
    }
    return rest;
}

/* A product that saturates. */
static uint32_t times(uint32_t count, uint32_t units)
{
    return (count > (UINT32_MAX / units)) ? UINT32_MAX : (count * units);
}

static uint32_t divided_up(uint32_t units, uint32_t by)
{
    return (units / by) + (((units % by) != 0U) ? 1U : 0U);
}

/* --- one interlock */

static void lock_out(interlock *timers)
{
    timers->remaining = 0U;
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        timers->lockout[coil] = BACKOFF_UNITS;
    }
}

static void elapse(interlock *timers, uint32_t units)
{
    timers->remaining = run_down(timers->remaining, units);
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        timers->lockout[coil] = run_down(timers->lockout[coil], units);
    }
}

static void accept(interlock *timers, const fire_request *request)
{
    timers->remaining = request->duration_ms * UNITS_PER_MS;
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        if ((LIMITS_SHARED == 1) || (coil == request->coil)) {
            timers->lockout[coil] = timers->remaining + BACKOFF_UNITS;
        }
    }
}

/* The rules of time, in their order. */
static refusal_reason judge_timers(const interlock *timers, uint32_t coil)
{
    refusal_reason reason = NOT_REFUSED;
    if (timers->remaining > 0U) {
        reason = COIL_ON;
    } else if (timers->lockout[coil] > 0U) {
        reason = LOCKOUT;
    } else {
        /* both timers have run out */
    }
    return reason;
}

static bool runs_lockout(const interlock *timers)
{
    return (timers->lockout[0] > 0U) || (timers->lockout[1] > 0U) || (timers->lockout[2] > 0U);
}

/* --- both of them */

void guard_boot(guard *state, uint32_t clock_ms)
{
    lock_out(&state->by_ticks);
    lock_out(&state->by_clock);
    state->clock_ms = clock_ms;
    state->coil = 0U;
    state->level = 0;
    state->pulse_level = 0;
    state->has_seq = false;
    state->seq = 0U;
    state->driven = false;
    state->tick_under_way = false;
    state->silent = false;
}

uint32_t guard_pass_time(guard *state, uint32_t clock_ms)
{
    uint32_t elapsed_ms = clock_ms - state->clock_ms; /* modulo 2^32: the clock may wrap */
    if (elapsed_ms < CLOCK_BACKWARDS) {
        elapse(&state->by_clock, times(elapsed_ms, UNITS_PER_MS));
        state->clock_ms = clock_ms;
    } else {
        elapsed_ms = 0U;
    }
    return elapsed_ms;
}

void guard_tick(guard *state)
{
    state->tick_under_way = guard_is_on(state);
    elapse(&state->by_ticks, UNITS_PER_TICK);
    state->level = state->driven ? state->pulse_level : 0; /* it stays visible for the last tick of the pulse */
    state->driven = guard_is_on(state);
}

void guard_sync(guard *state)
{
    state->tick_under_way = false;
    state->silent = false;
}

void guard_silence(guard *state)
{
    lock_out(&state->by_ticks);
    lock_out(&state->by_clock);
    state->coil = 0U;
    state->level = 0;
    state->pulse_level = 0;
    state->driven = false;
    state->tick_under_way = false;
    state->silent = true; /* seq stays: a request that was carried out before is still a repeated one */
}

/* The rules of a request itself, in their order. */
static refusal_reason judge_request(const guard *state, const fire_request *request, uint32_t tick)
{
    refusal_reason reason = NOT_REFUSED;
    if (request->tick != (tick & 0xFFU)) {
        reason = WRONG_TICK;
    } else if (state->has_seq && (request->seq == state->seq)) {
        reason = REPEATED_SEQ;
    } else if (request->coil >= COILS) {
        reason = BAD_COIL;
    } else if ((request->level == 0) || (request->level < -LEVEL_MOST) || (request->level > LEVEL_MOST)) {
        reason = BAD_LEVEL;
    } else if ((request->duration_ms == 0U) || (request->duration_ms > LIMITS_PULSE_MS)) {
        reason = BAD_DURATION;
    } else {
        /* a proper request */
    }
    return reason;
}

refusal_reason guard_ask(guard *state, const fire_request *request, uint32_t tick)
{
    refusal_reason reason = judge_request(state, request, tick);
    if (reason == NOT_REFUSED) {
        reason = judge_timers(&state->by_ticks, request->coil);
    }
    if (reason == NOT_REFUSED) {
        reason = judge_timers(&state->by_clock, request->coil);
    }
    if ((reason == NOT_REFUSED) && state->silent) {
        reason = LOCKOUT;
    }
    if (reason == NOT_REFUSED) {
        accept(&state->by_ticks, request);
        accept(&state->by_clock, request);
        state->coil = request->coil;
        state->level = request->level;
        state->pulse_level = request->level;
        state->seq = request->seq;
        state->has_seq = true;
        state->driven = true;
    }
    return reason;
}

bool guard_is_on(const guard *state)
{
    return (state->by_ticks.remaining > 0U) && (state->by_clock.remaining > 0U);
}

bool guard_drives(const guard *state)
{
    return ((state->by_ticks.remaining > 0U) || state->tick_under_way) && (state->by_clock.remaining > 0U);
}

uint32_t guard_ends_ms(const guard *state)
{
    return state->clock_ms + (state->by_clock.remaining / UNITS_PER_MS);
}

uint32_t guard_remaining_ms(const guard *state)
{
    return divided_up(smaller(state->by_ticks.remaining, state->by_clock.remaining), UNITS_PER_MS);
}

uint32_t guard_lockout_ms(const guard *state, uint32_t coil)
{
    const uint32_t left = larger(state->by_ticks.lockout[coil], state->by_clock.lockout[coil]);
    return divided_up(left, UNITS_PER_MS * LOCKOUT_STEP_MS) * LOCKOUT_STEP_MS;
}

bool guard_is_locked_out(const guard *state)
{
    return state->silent || runs_lockout(&state->by_ticks) || runs_lockout(&state->by_clock);
}
