/* SPDX-License-Identifier: Apache-2.0 */
/* The laws: whatever they demand brakes, and turns the body the shorter way. */
#include "laws.h"

#include "check.h"

#define K_W 6.0e6F
#define K_A 1.6e3F

static const vec3 B_T = {1.2e-5F, -2.0e-5F, 0.7e-5F};
static const vec3 OMEGA_RADPS = {0.01F, 0.02F, -0.015F};

static vec3 torque_of(vec3 m_am2)
{
    return vec3_cross(m_am2, B_T);
}

static void bdot_brakes(void)
{
    /* the field turns the other way in a body that turns: db/dt = b x omega */
    const float interval_s = 0.1F;
    const vec3 b_dot = vec3_cross(B_T, OMEGA_RADPS);
    const vec3 before_t = vec3_sub(B_T, vec3_scale(interval_s, b_dot));
    const vec3 m_am2 = bdot_dipole(B_T, before_t, interval_s, K_W);
    CHECK(vec3_dot(torque_of(m_am2), OMEGA_RADPS) < 0.0F);
    CHECK(vec3_norm(bdot_dipole(B_T, B_T, interval_s, K_W)) == 0.0F);
}

static void the_rate_of_pd_brakes(void)
{
    const vec3 m_am2 = pd_dipole(B_T, OMEGA_RADPS, VEC3_ZERO, K_W, K_A);
    CHECK(vec3_dot(torque_of(m_am2), OMEGA_RADPS) < 0.0F);
    CHECK(vec3_norm(pd_dipole(B_T, VEC3_ZERO, VEC3_ZERO, K_W, K_A)) == 0.0F);
}

static void the_error_of_pd_is_turned_back(void)
{
    const vec3 q = {0.1F, -0.2F, 0.05F};
    const vec3 m_am2 = pd_dipole(B_T, VEC3_ZERO, attitude_error(q), K_W, K_A);
    CHECK(vec3_dot(torque_of(m_am2), q) < 0.0F);
}

static void the_integral_holds_against_what_lasts_and_does_not_wind_up(void)
{
    const vec3 integral_s = {2000.0F, -1000.0F, 500.0F};
    const vec3 bounded_s = within_dipole(B_T, integral_s, 0.08F, 1.0e-3F);
    const vec3 held_am2 = holding_dipole(B_T, bounded_s, 0.08F);
    CHECK(vec3_dot(torque_of(held_am2), integral_s) < 0.0F);
    CHECK(vec3_norm(held_am2) <= 1.0e-3F);
    CHECK(vec3_norm(vec3_sub(within_dipole(B_T, integral_s, 0.08F, 1.0F), integral_s)) == 0.0F);
}

static void an_error_far_from_the_goal_asks_for_no_more_than_the_coils_give(void)
{
    const vec3 q = {0.6F, -0.5F, 0.3F};
    const vec3 limited = within_dipole(B_T, attitude_error(q), K_A, 1.0e-3F);
    const vec3 m_am2 = pd_dipole(B_T, VEC3_ZERO, limited, K_W, K_A);
    CHECK(vec3_dot(torque_of(m_am2), q) < 0.0F);
    CHECK(vec3_norm(m_am2) <= 1.0e-3F);
}

static void no_dipole_lies_along_the_field(void)
{
    const vec3 q = {0.1F, -0.2F, 0.05F};
    const vec3 m_am2 = pd_dipole(B_T, OMEGA_RADPS, attitude_error(q), K_W, K_A);
    CHECK(vec3_dot(m_am2, B_T) < (1.0e-6F * vec3_norm(m_am2) * vec3_norm(B_T)));
    CHECK(vec3_dot(m_am2, B_T) > (-1.0e-6F * vec3_norm(m_am2) * vec3_norm(B_T)));
}

int main(void)
{
    bdot_brakes();
    the_rate_of_pd_brakes();
    the_error_of_pd_is_turned_back();
    the_integral_holds_against_what_lasts_and_does_not_wind_up();
    an_error_far_from_the_goal_asks_for_no_more_than_the_coils_give();
    no_dipole_lies_along_the_field();
    return failed_checks;
}
