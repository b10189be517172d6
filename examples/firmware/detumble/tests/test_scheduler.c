/* SPDX-License-Identifier: Apache-2.0 */
/* The scheduler: full back-off at boot and after each pulse, one coil at a time, no level beyond 3, what is owed. */
#include "scheduler.h"

#include "check.h"

static const vec3 B_T = {0.0F, 0.0F, 3.0e-5F};
static const vec3 STRONG_NM = {0.0F, 1.0F, 0.0F}; /* coil x gives it, by a negative level: m x b = -y */

static coil_set coils;
static scheduler state;

static void booted(void)
{
    coils = coils_of_scenario();
    scheduler_boot(&state);
}

static void run_ticks(uint32_t ticks)
{
    for (uint32_t tick = 0U; tick < ticks; tick++) {
        scheduler_tick(&state);
    }
}

static coil_pulse chosen(vec3 torque_nm)
{
    return scheduler_choose(&state, &coils, torque_nm, B_T);
}

static void boot_costs_a_whole_back_off(void)
{
    booted();
    CHECK(chosen(STRONG_NM).level == 0);
    run_ticks(BACKOFF_TICKS - 1U);
    CHECK(chosen(STRONG_NM).level == 0);
    run_ticks(1U);
    CHECK(chosen(STRONG_NM).level != 0);
}

static void after_a_pulse_nothing_is_fired_until_the_back_off_is_over(void)
{
    booted();
    run_ticks(BACKOFF_TICKS);
    const coil_pulse pulse = chosen(STRONG_NM);
    scheduler_fire(&state, pulse, VEC3_ZERO);
    for (uint32_t tick = 0U; tick < (PULSE_TICKS + BACKOFF_TICKS); tick++) {
        const coil_pulse other = chosen(STRONG_NM);
        CHECK((other.level == 0) || ((TORQUER_BACKOFF_SHARED == 0) && (tick >= PULSE_TICKS) && (other.coil != pulse.coil)));
        run_ticks(1U);
    }
    CHECK(chosen(STRONG_NM).level != 0);
}

static void its_pulse_gives_the_torque(void)
{
    booted();
    run_ticks(BACKOFF_TICKS);
    const coil_pulse pulse = chosen(STRONG_NM);
    CHECK((pulse.level >= -3) && (pulse.level <= 3));
    CHECK(vec3_dot(coils_impulse(&coils, pulse, B_T), STRONG_NM) > 0.0F);
    const coil_pulse opposite = chosen(vec3_scale(-1.0F, STRONG_NM));
    CHECK((opposite.coil == pulse.coil) && (opposite.level == -pulse.level));
}

static void nothing_is_fired_for_nothing(void)
{
    const vec3 along_nm = {0.0F, 0.0F, 1.0F}; /* along the field no coil gives any */
    booted();
    run_ticks(BACKOFF_TICKS);
    CHECK(chosen(VEC3_ZERO).level == 0);
    CHECK(chosen(along_nm).level == 0);
    CHECK(scheduler_choose(&state, &coils, VEC3_ZERO, VEC3_ZERO).level == 0);
}

static void what_is_owed_is_at_most_what_a_pulse_pays(void)
{
    const coil_pulse strongest = {0U, 3};
    booted();
    scheduler_owe(&state, &coils, STRONG_NM, B_T);
    CHECK(vec3_norm(state.owed_nms) <= (1.000001F * vec3_norm(coils_impulse(&coils, strongest, B_T))));
    CHECK(state.owed_nms.y > 0.0F);
    scheduler_forget(&state);
    CHECK(vec3_norm(state.owed_nms) == 0.0F);
}

static void a_weak_demand_is_paid_in_the_end(void)
{
    const vec3 weak_nm = {0.0F, 1.0e-7F, 0.0F};
    uint32_t pulses = 0U;
    booted();
    for (uint32_t tick = 0U; tick < (20U * BACKOFF_TICKS); tick++) {
        scheduler_owe(&state, &coils, weak_nm, B_T);
        const coil_pulse pulse = chosen(weak_nm);
        if (pulse.level != 0) {
            CHECK(vec3_dot(coils_impulse(&coils, pulse, B_T), weak_nm) > 0.0F);
            scheduler_fire(&state, pulse, coils_impulse(&coils, pulse, B_T));
            pulses++;
        }
        run_ticks(1U);
    }
    CHECK(pulses > 0U);
}

int main(void)
{
    boot_costs_a_whole_back_off();
    after_a_pulse_nothing_is_fired_until_the_back_off_is_over();
    its_pulse_gives_the_torque();
    nothing_is_fired_for_nothing();
    what_is_owed_is_at_most_what_a_pulse_pays();
    a_weak_demand_is_paid_in_the_end();
    return failed_checks;
}
