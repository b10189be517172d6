/* SPDX-License-Identifier: Apache-2.0 */
/* What a test needs: CHECK tells what does not hold, and the test goes on; its exit code is the number of these. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>

static int failed_checks;

#define CHECK(holds) \
    do { \
        if (!(holds)) { \
            failed_checks++; \
            (void)printf("%s:%d: %s\n", __FILE__, __LINE__, #holds); \
        } \
    } while (0)

#endif
