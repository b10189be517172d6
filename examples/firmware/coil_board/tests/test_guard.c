/* SPDX-License-Identifier: Apache-2.0 */
/* The guard: full lockout at boot, length of a pulse, back-off, both clocks, and no level beyond 3. */
#include "guard.h"

#include "check.h"
#include "coil_limits.h"

static guard coils;
static uint32_t now_ms;

static fire_request proper(uint8_t seq)
{
    const fire_request request = {-2, 1U, seq, 0U, LIMITS_PULSE_MS};
    return request;
}

/* Time goes on by ticks and clock alike; the board is always in a tick whose low byte is 0. */
static void run_s(uint32_t seconds)
{
    for (uint32_t tick = 0U; tick < (seconds * LIMITS_TICK_HZ); tick++) {
        now_ms += 1000U / LIMITS_TICK_HZ;
        (void)guard_pass_time(&coils, now_ms);
        guard_tick(&coils);
        guard_sync(&coils);
    }
}

static void switched_on(void)
{
    now_ms = UINT32_MAX - 50000U; /* the clock wraps in each of these tests */
    guard_boot(&coils, now_ms);
}

static void boot_costs_a_whole_back_off(void)
{
    const fire_request request = proper(1U);
    switched_on();
    CHECK(!guard_drives(&coils) && guard_is_locked_out(&coils));
    CHECK(guard_ask(&coils, &request, 0U) == LOCKOUT);
    run_s((LIMITS_BACKOFF_MS / 1000U) - 1U);
    CHECK(guard_ask(&coils, &request, 0U) == LOCKOUT);
    run_s(1U);
    CHECK(!guard_is_locked_out(&coils));
    CHECK(guard_ask(&coils, &request, 0U) == NOT_REFUSED);
    CHECK(guard_drives(&coils) && (guard_ends_ms(&coils) == (now_ms + LIMITS_PULSE_MS)));
}

static void a_pulse_ends_by_itself_and_locks_out(void)
{
    const fire_request first = proper(1U);
    const fire_request second = proper(2U);
    switched_on();
    run_s(LIMITS_BACKOFF_MS / 1000U);
    (void)guard_ask(&coils, &first, 0U);
    CHECK(guard_ask(&coils, &first, 0U) == REPEATED_SEQ);
    CHECK(guard_ask(&coils, &second, 0U) == COIL_ON);
    (void)guard_pass_time(&coils, now_ms + LIMITS_PULSE_MS - 1U);
    CHECK(guard_drives(&coils));
    (void)guard_pass_time(&coils, now_ms + LIMITS_PULSE_MS); /* though no tick has come */
    CHECK(!guard_drives(&coils));
    run_s((LIMITS_PULSE_MS + LIMITS_BACKOFF_MS) / 1000U - 1U);
    CHECK(guard_ask(&coils, &second, 0U) == LOCKOUT);
    run_s(1U);
    CHECK(guard_ask(&coils, &second, 0U) == NOT_REFUSED);
}

static void ticks_in_a_rush_shorten_nothing(void)
{
    const fire_request request = proper(1U);
    switched_on();
    for (uint32_t tick = 0U; tick < 100000U; tick++) {
        guard_tick(&coils);
    }
    CHECK(guard_ask(&coils, &request, 0U) == LOCKOUT);
}

static void time_without_ticks_shortens_nothing(void)
{
    const fire_request request = proper(1U);
    switched_on();
    (void)guard_pass_time(&coils, now_ms + 1000000U);
    CHECK(guard_ask(&coils, &request, 0U) == LOCKOUT);
}

static void a_clock_that_runs_back_is_ignored(void)
{
    switched_on();
    CHECK(guard_pass_time(&coils, now_ms - 1U) == 0U);
    CHECK(guard_pass_time(&coils, now_ms + 10U) == 10U);
}

static void an_improper_request_changes_nothing(void)
{
    fire_request request = proper(9U);
    switched_on();
    run_s(LIMITS_BACKOFF_MS / 1000U);
    CHECK(guard_ask(&coils, &request, 1U) == WRONG_TICK);
    request.coil = 3U;
    CHECK(guard_ask(&coils, &request, 0U) == BAD_COIL);
    request.coil = 0U;
    for (int level = -8; level < 8; level++) {
        request.level = (int8_t)level;
        if ((level == 0) || (level < -3) || (level > 3)) {
            CHECK(guard_ask(&coils, &request, 0U) == BAD_LEVEL);
        }
    }
    request.level = 3;
    request.duration_ms = 0U;
    CHECK(guard_ask(&coils, &request, 0U) == BAD_DURATION);
    request.duration_ms = (uint16_t)(LIMITS_PULSE_MS + 1U);
    CHECK(guard_ask(&coils, &request, 0U) == BAD_DURATION);
    CHECK(!guard_drives(&coils) && !guard_is_locked_out(&coils));
    request.duration_ms = 1U;
    CHECK(guard_ask(&coils, &request, 0U) == NOT_REFUSED);
}

static void silence_switches_off_until_sync_is_back(void)
{
    const fire_request first = proper(1U);
    const fire_request second = proper(2U);
    switched_on();
    run_s(LIMITS_BACKOFF_MS / 1000U);
    (void)guard_ask(&coils, &first, 0U);
    guard_silence(&coils);
    CHECK(!guard_drives(&coils));
    CHECK(guard_ask(&coils, &first, 0U) == REPEATED_SEQ);
    (void)guard_pass_time(&coils, now_ms + LIMITS_BACKOFF_MS);
    for (uint32_t tick = 0U; tick < ((LIMITS_BACKOFF_MS / 1000U) * LIMITS_TICK_HZ); tick++) {
        guard_tick(&coils);
    }
    CHECK(guard_ask(&coils, &second, 0U) == LOCKOUT);
    guard_sync(&coils);
    CHECK(guard_ask(&coils, &second, 0U) == NOT_REFUSED);
}

int main(void)
{
    boot_costs_a_whole_back_off();
    a_pulse_ends_by_itself_and_locks_out();
    ticks_in_a_rush_shorten_nothing();
    time_without_ticks_shortens_nothing();
    a_clock_that_runs_back_is_ignored();
    an_improper_request_changes_nothing();
    silence_switches_off_until_sync_is_back();
    return failed_checks;
}
