/* SPDX-License-Identifier: Apache-2.0 */
/* The read-back: the measured supply current against the nominal one of the driven level. */
#ifndef READ_BACK_H
#define READ_BACK_H

#include "messages.h"

/* Time that a current takes to follow a change of the drive; until then it is not judged [ms]. */
#define READ_BACK_SETTLE_MS 100U

/* A current that cannot be measured. */
#define CURRENT_UNKNOWN INT32_MIN

/* What is wrong with a settled current at a level (0: all coils are off); NO_EVENT if it is right. */
coil_event read_back_judge(int8_t level, int32_t current_ma);

#endif
