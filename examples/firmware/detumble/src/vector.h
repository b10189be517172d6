/* SPDX-License-Identifier: Apache-2.0 */
/* Algebra of 3-vectors and 3 x 3 matrices in single precision. */
#ifndef VECTOR_H
#define VECTOR_H

typedef struct {
    float x;
    float y;
    float z;
} vec3;

/* By rows. */
typedef struct {
    vec3 row[3];
} mat3;

extern const vec3 VEC3_ZERO;

vec3 vec3_add(vec3 a, vec3 b);
vec3 vec3_sub(vec3 a, vec3 b);
vec3 vec3_scale(float factor, vec3 a);
vec3 vec3_cross(vec3 a, vec3 b);
float vec3_dot(vec3 a, vec3 b);
float vec3_norm(vec3 a);

vec3 mat3_transform(const mat3 *m, vec3 a);
mat3 mat3_product(const mat3 *m, const mat3 *n);

/* The inverse of a regular symmetric matrix. */
mat3 mat3_symmetric_inverse(const mat3 *m);

#endif
