/* SPDX-License-Identifier: Apache-2.0 */
/* The board in a test's hands: one request of fixed size in, what the board does out. The clock is the test's.
 *
 * request, 28 bytes: [0] 0 switch on, 1 receive, 2 pass time; [4] now_ms; [8] current_ma; [12] record of the frame,
 * of switch on the tick alone. reply: [0] coil; [1] level; [2] number of frames; [4] until_ms; [8] their records.
 */
#ifndef HARNESS_H
#define HARNESS_H

#include "coil_board.h"

#define HARNESS_REQUEST_BYTES 28U
#define HARNESS_REPLY_MOST (8U + (16U * OUTBOX_MOST))

/* Do what is asked of the one board there is: how many bytes the reply has. */
uint32_t harness_step(const uint8_t *request, uint8_t *reply);

#endif
