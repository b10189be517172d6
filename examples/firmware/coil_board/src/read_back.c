/* SPDX-License-Identifier: Apache-2.0 */
#include "read_back.h"

#include "coil_limits.h"

#define CURRENT_MOST_MA 1000000 /* beyond it every current is as wrong; what is multiplied below stays in range */

#if (LIMITS_LEVEL_1_MA < 1) || (LIMITS_LEVEL_2_MA <= LIMITS_LEVEL_1_MA) || (LIMITS_LEVEL_3_MA <= LIMITS_LEVEL_2_MA)
#error "LIMITS_LEVEL_1_MA to LIMITS_LEVEL_3_MA must rise from above 0"
#endif
#if LIMITS_LEVEL_3_MA > 2047
#error "LIMITS_LEVEL_3_MA must be at most 2047, as current_ma of COIL_STATUS carries no more"
#endif

static int32_t size_of(int32_t value)
{
    return (value < 0) ? -value : value;
}

static int32_t within_range(int32_t current_ma)
{
    int32_t current = current_ma;
    if (current < -CURRENT_MOST_MA) {
        current = -CURRENT_MOST_MA;
    } else if (current > CURRENT_MOST_MA) {
        current = CURRENT_MOST_MA;
    } else {
        /* as measured */
    }
    return current;
}

/* Of a coil that is on: forward_ma is the current in the direction of its level. */
static coil_event judge_on(int32_t forward_ma, int32_t nominal_ma)
{
    coil_event event = CURRENT_WRONG;
    if ((5 * size_of(forward_ma - nominal_ma)) <= nominal_ma) { /* within 20 % */
        event = NO_EVENT;
    } else if ((10 * forward_ma) < -nominal_ma) {
        event = CURRENT_REVERSED;
    } else if ((10 * forward_ma) <= nominal_ma) {
        event = NO_CURRENT;
    } else {
        /* too much or too little */
    }
    return event;
}

coil_event read_back_judge(int8_t level, int32_t current_ma)
{
    static const int32_t NOMINAL_MA[] = {0, LIMITS_LEVEL_1_MA, LIMITS_LEVEL_2_MA, LIMITS_LEVEL_3_MA};
    const int32_t current = within_range(current_ma);
    coil_event event = NO_EVENT;
    if (level == 0) {
        if ((10 * size_of(current)) > NOMINAL_MA[1]) { /* one that cannot be measured is as large as any */
            event = CURRENT_WHILE_OFF;
        }
    } else if (current_ma == CURRENT_UNKNOWN) {
        event = CURRENT_WRONG;
    } else {
        event = judge_on((level > 0) ? current : -current, NOMINAL_MA[size_of(level)]);
    }
    return event;
}
