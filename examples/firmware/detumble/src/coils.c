/* SPDX-License-Identifier: Apache-2.0 */
#include "coils.h"

static vec3 single(double x, double y, double z)
{
    const vec3 rounded = {(float)x, (float)y, (float)z};
    return rounded;
}

coil_set coils_of_scenario(void)
{
    static const double AXES[3][3] = TORQUER_COIL_AXES; /* a column for each coil */
    static const double LEVELS_AM2[LEVELS] = TORQUER_LEVELS_AM2;
    static const double INERTIA_KGM2[3][3] = TORQUER_INERTIA_KGM2;
    const uint32_t pulse_ticks = PULSE_TICKS;
    const uint32_t cycle_ticks = CYCLE_TICKS;
    const uint32_t duration_ms = DURATION_MS;
    coil_set coils;
    mat3 inertia;
    mat3 inverse;
    for (uint32_t place = 0U; place < 3U; place++) {
        coils.axis[place] = single(AXES[0][place], AXES[1][place], AXES[2][place]);
        coils.level_am2[place] = (float)LEVELS_AM2[place];
        inertia.row[place] = single(INERTIA_KGM2[place][0], INERTIA_KGM2[place][1], INERTIA_KGM2[place][2]);
    }
    inverse = mat3_symmetric_inverse(&inertia);
    coils.metric = mat3_product(&inverse, &inverse);
    coils.mean_am2 = (coils.level_am2[LEVELS - 1U] * (float)pulse_ticks) / (float)cycle_ticks;
    coils.pulse_s = (float)duration_ms / 1000.0F;
    coils.tick_s = 1.0F / (float)TICK_HZ;
    return coils;
}

static float dipole_am2(const coil_set *coils, int8_t level)
{
    float dipole = 0.0F;
    if (level > 0) {
        dipole = coils->level_am2[level - 1];
    } else if (level < 0) {
        dipole = -coils->level_am2[-level - 1];
    } else {
        /* none */
    }
    return dipole;
}

vec3 coils_impulse(const coil_set *coils, coil_pulse pulse, vec3 b_t)
{
    const vec3 m_am2 = vec3_scale(dipole_am2(coils, pulse.level), coils->axis[pulse.coil]);
    return vec3_scale(coils->pulse_s, vec3_cross(m_am2, b_t));
}
