/* SPDX-License-Identifier: Apache-2.0 */
#include "laws.h"

vec3 bdot_dipole(vec3 b_t, vec3 before_t, float interval_s, float k_w)
{
    return vec3_scale(-k_w / interval_s, vec3_sub(b_t, before_t));
}

vec3 attitude_error(vec3 q)
{
    return vec3_scale(4.0F, q);
}

vec3 pd_dipole(vec3 b_t, vec3 omega_radps, vec3 error, float k_w, float k_a)
{
    const vec3 wanted = vec3_add(vec3_scale(k_w, omega_radps), vec3_scale(k_a, error));
    return vec3_cross(wanted, b_t);
}

vec3 holding_dipole(vec3 b_t, vec3 integral_s, float k_i)
{
    return vec3_cross(vec3_scale(k_i, integral_s), b_t);
}

vec3 within_dipole(vec3 b_t, vec3 term, float gain, float most_am2)
{
    const float demanded_am2 = gain * vec3_norm(b_t) * vec3_norm(term);
    return (demanded_am2 > most_am2) ? vec3_scale(most_am2 / demanded_am2, term) : term;
}
