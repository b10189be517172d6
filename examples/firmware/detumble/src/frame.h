/* SPDX-License-Identifier: Apache-2.0 */
/* A frame of the bus. Its CRC and its signals are packed by what torquer header writes. */
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

/* A frame of this identifier and length, without data. */
bus_frame frame_of(uint32_t can_id, uint8_t length);

/* Whether the frame has this length and its last byte is its CRC. */
bool frame_is_intact(const bus_frame *frame, uint8_t length);

/* Write the CRC into the last of the frame's bytes. */
void frame_seal(bus_frame *frame);

#endif
