/* SPDX-License-Identifier: Apache-2.0 */
#include "frame.h"

#include "torquer_crc.h"

bus_frame frame_of(uint32_t can_id, uint8_t length)
{
    const bus_frame frame = {can_id, length, {0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U}};
    return frame;
}

bool frame_is_intact(const bus_frame *frame, uint8_t length)
{
    return (frame->length == length) && (torquer_intact((uint16_t)frame->can_id, frame->data, length) != 0);
}

void frame_seal(bus_frame *frame)
{
    torquer_seal((uint16_t)frame->can_id, frame->data, frame->length);
}
