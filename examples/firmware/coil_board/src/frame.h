/* SPDX-License-Identifier: Apache-2.0 */
/* A frame of the bus, the CRC that seals it, and the gate: a frame is accepted whole or not at all. */
#ifndef FRAME_H
#define FRAME_H

#include <stdbool.h>
#include <stdint.h>

#define FRAME_DATA_MOST 8U

/* A classic CAN frame. */
typedef struct {
    /* The identifier; above it the flags of SocketCAN's can_id: a frame that carries one is never ours. */
    uint32_t can_id;
    uint8_t length; /* data bytes, 0 to 8 */
    uint8_t data[FRAME_DATA_MOST];
} bus_frame;

/* Whether the frame is a known message of the right length whose CRC, if it has one, is right. */
bool frame_is_intact(const bus_frame *frame);

/* Write the CRC into the last of the frame's bytes. */
void frame_seal(bus_frame *frame);

#endif
