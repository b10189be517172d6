/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors and matrices: the axes turn the right way round, an inverse inverts. */
#include "vector.h"

#include <math.h>

#include "check.h"

static const vec3 X = {1.0F, 0.0F, 0.0F};
static const vec3 Y = {0.0F, 1.0F, 0.0F};
static const vec3 Z = {0.0F, 0.0F, 1.0F};

static int are_near(vec3 a, vec3 b)
{
    return vec3_norm(vec3_sub(a, b)) < 1.0e-6F;
}

static void x_by_y_is_z(void)
{
    CHECK(are_near(vec3_cross(X, Y), Z));
    CHECK(are_near(vec3_cross(Y, Z), X));
    CHECK(are_near(vec3_cross(Y, X), vec3_scale(-1.0F, Z)));
    CHECK(are_near(vec3_cross(X, X), VEC3_ZERO));
}

static void the_norm_is_that_of_the_sum_of_squares(void)
{
    const vec3 a = {2.0F, -3.0F, 6.0F};
    CHECK(vec3_norm(a) == 7.0F);
    CHECK(vec3_dot(a, vec3_add(X, Y)) == -1.0F);
}

static void an_inverse_inverts(void)
{
    const mat3 m = {{{2.0F, 0.5F, 0.0F}, {0.5F, 3.0F, -1.0F}, {0.0F, -1.0F, 4.0F}}};
    const mat3 inverse = mat3_symmetric_inverse(&m);
    const mat3 product = mat3_product(&m, &inverse);
    CHECK(are_near(mat3_transform(&product, X), X));
    CHECK(are_near(mat3_transform(&product, Y), Y));
    CHECK(are_near(mat3_transform(&product, Z), Z));
    CHECK(fabsf(inverse.row[0].y - inverse.row[1].x) < 1.0e-6F);
}

int main(void)
{
    x_by_y_is_z();
    the_norm_is_that_of_the_sum_of_squares();
    an_inverse_inverts();
    return failed_checks;
}
