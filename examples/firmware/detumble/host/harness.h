/* SPDX-License-Identifier: Apache-2.0 */
/* The flight software in a test's hands: one request of fixed size in, what it does out.
 *
 * request: [0] what, [1] number of frames, [4] their records; of schedule [4] dipole, [16] field, three floats each.
 * reply: [0] number of frames, [4] their records; of schedule [0] coil, [1] level, [4] wait of each coil,
 * [16] what is owed, three floats, [28] busy.
 */
#ifndef HARNESS_H
#define HARNESS_H

#include "detumble.h"

#define HARNESS_FRAMES_MOST 32U
#define HARNESS_REQUEST_BYTES (4U + (16U * HARNESS_FRAMES_MOST))
#define HARNESS_REPLY_MOST (4U + (16U * OUTBOX_MOST))

#define HARNESS_BOOT 0U
#define HARNESS_STEP 1U
#define HARNESS_BOOT_SCHEDULER 2U
#define HARNESS_SCHEDULE 3U /* a tick of the scheduler alone, with a board that is always ready */

/* Do what is asked of the one flight software there is: how many bytes the reply has. */
uint32_t harness_step(const uint8_t *request, uint8_t *reply);

#endif
