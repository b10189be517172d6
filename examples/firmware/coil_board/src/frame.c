/* SPDX-License-Identifier: Apache-2.0 */
#include "frame.h"

#include <stddef.h>

#define CRC_POLYNOMIAL 0x1DU
#define CRC_START 0xFFU
#define CRC_FINAL 0xFFU
#define CRC_TOP_BIT 0x80U

/* The shape of a message: what the gate knows of it. */
typedef struct {
    uint16_t can_id;
    uint8_t length;
    bool sealed; /* it has a CRC */
} message_shape;

static uint8_t crc_step(uint8_t crc, uint8_t byte)
{
    uint32_t left = (uint32_t)crc ^ byte;
    for (uint32_t bit = 0U; bit < 8U; bit++) {
        if ((left & CRC_TOP_BIT) != 0U) {
            left = (left << 1U) ^ CRC_POLYNOMIAL;
        } else {
            left <<= 1U;
        }
    }
    return (uint8_t)(left & 0xFFU);
}

/* CRC-8 over the identifier, two bytes, high byte first, and all data bytes before the last. */
static uint8_t crc_of(const bus_frame *frame)
{
    uint8_t crc = crc_step(CRC_START, (uint8_t)((frame->can_id >> 8U) & 0xFFU));
    crc = crc_step(crc, (uint8_t)(frame->can_id & 0xFFU));
    for (uint32_t place = 0U; (place + 1U) < frame->length; place++) {
        crc = crc_step(crc, frame->data[place]);
    }
    return (uint8_t)(crc ^ CRC_FINAL);
}

static const message_shape *shape_of(uint32_t can_id)
{
    /* Every message of the bus, not only ours: an unknown one is counted as rejected. */
    static const message_shape SHAPES[] = {
        {0x080U, 7U, true}, {0x088U, 8U, true}, {0x090U, 6U, true}, {0x0A0U, 2U, true}, {0x0A1U, 2U, true},
        {0x0A2U, 3U, true}, {0x0A3U, 4U, true}, {0x0A4U, 7U, true}, {0x0A5U, 7U, true}, {0x0A6U, 2U, true},
        {0x0A7U, 8U, true}, {0x0A8U, 2U, true}, {0x100U, 8U, true}, {0x101U, 8U, true}, {0x108U, 5U, true},
        {0x110U, 8U, true}, {0x118U, 8U, true}, {0x119U, 8U, true}, {0x120U, 8U, true}, {0x121U, 8U, true},
        {0x128U, 8U, true}, {0x180U, 8U, false}, {0x200U, 8U, true}, {0x201U, 8U, true}, {0x202U, 8U, true},
        {0x203U, 8U, true}, {0x208U, 8U, true}, {0x280U, 8U, false}, {0x400U, 8U, true}, {0x410U, 8U, true},
        {0x420U, 8U, true}, {0x430U, 8U, true}, {0x440U, 8U, true}, {0x450U, 8U, true}, {0x500U, 7U, true},
        {0x510U, 7U, true}, {0x520U, 7U, true}, {0x530U, 7U, true}, {0x540U, 7U, true}, {0x550U, 7U, true},
        {0x600U, 8U, true}, {0x610U, 8U, true}, {0x620U, 8U, true}, {0x630U, 8U, true}, {0x640U, 8U, true},
        {0x650U, 8U, true}, {0x700U, 5U, true},
    };
    const message_shape *found = NULL;
    for (uint32_t place = 0U; place < (sizeof(SHAPES) / sizeof(SHAPES[0])); place++) {
        if (SHAPES[place].can_id == can_id) {
            found = &SHAPES[place];
        }
    }
    return found;
}

bool frame_is_intact(const bus_frame *frame)
{
    const message_shape *shape = shape_of(frame->can_id);
    bool intact = (shape != NULL) && (frame->length == shape->length);
    if (intact && shape->sealed) {
        intact = (frame->data[frame->length - 1U] == crc_of(frame));
    }
    return intact;
}

void frame_seal(bus_frame *frame)
{
    frame->data[frame->length - 1U] = crc_of(frame);
}
