/* SPDX-License-Identifier: Apache-2.0 */
#include "vector.h"

#include <math.h>

const vec3 VEC3_ZERO = {0.0F, 0.0F, 0.0F};

vec3 vec3_add(vec3 a, vec3 b)
{
    const vec3 sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}

vec3 vec3_sub(vec3 a, vec3 b)
{
    const vec3 difference = {a.x - b.x, a.y - b.y, a.z - b.z};
    return difference;
}

vec3 vec3_scale(float factor, vec3 a)
{
    const vec3 scaled = {factor * a.x, factor * a.y, factor * a.z};
    return scaled;
}

vec3 vec3_cross(vec3 a, vec3 b)
{
    const vec3 normal = {(a.y * b.z) - (a.z * b.y), (a.z * b.x) - (a.x * b.z), (a.x * b.y) - (a.y * b.x)};
    return normal;
}

float vec3_dot(vec3 a, vec3 b)
{
    return (a.x * b.x) + (a.y * b.y) + (a.z * b.z);
}

float vec3_norm(vec3 a)
{
    return sqrtf(vec3_dot(a, a));
}

vec3 mat3_transform(const mat3 *m, vec3 a)
{
    const vec3 transformed = {vec3_dot(m->row[0], a), vec3_dot(m->row[1], a), vec3_dot(m->row[2], a)};
    return transformed;
}

static vec3 column(const mat3 *m, int place)
{
    vec3 of = {m->row[0].x, m->row[1].x, m->row[2].x};
    if (place == 1) {
        of.x = m->row[0].y;
        of.y = m->row[1].y;
        of.z = m->row[2].y;
    } else if (place == 2) {
        of.x = m->row[0].z;
        of.y = m->row[1].z;
        of.z = m->row[2].z;
    } else {
        /* the first */
    }
    return of;
}

mat3 mat3_product(const mat3 *m, const mat3 *n)
{
    mat3 of;
    for (int place = 0; place < 3; place++) {
        of.row[place].x = vec3_dot(m->row[place], column(n, 0));
        of.row[place].y = vec3_dot(m->row[place], column(n, 1));
        of.row[place].z = vec3_dot(m->row[place], column(n, 2));
    }
    return of;
}

mat3 mat3_symmetric_inverse(const mat3 *m)
{
    mat3 inverse;
    const vec3 first = vec3_cross(m->row[1], m->row[2]);
    const float factor = 1.0F / vec3_dot(m->row[0], first);
    inverse.row[0] = vec3_scale(factor, first);
    inverse.row[1] = vec3_scale(factor, vec3_cross(m->row[2], m->row[0]));
    inverse.row[2] = vec3_scale(factor, vec3_cross(m->row[0], m->row[1]));
    return inverse;
}
