/* SPDX-License-Identifier: Apache-2.0 */
#include "record.h"

#define LENGTH_AT 4U
#define DATA_AT 8U

uint32_t word_from(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8U) | ((uint32_t)bytes[2] << 16U) |
           ((uint32_t)bytes[3] << 24U);
}

void word_into(uint32_t word, uint8_t *bytes)
{
    for (uint32_t place = 0U; place < 4U; place++) {
        bytes[place] = (uint8_t)((word >> (8U * place)) & 0xFFU);
    }
}

bus_frame record_to_frame(const uint8_t *record)
{
    bus_frame frame;
    frame.can_id = word_from(record);
    frame.length = (record[LENGTH_AT] < FRAME_DATA_MOST) ? record[LENGTH_AT] : (uint8_t)FRAME_DATA_MOST;
    for (uint32_t place = 0U; place < FRAME_DATA_MOST; place++) {
        frame.data[place] = record[DATA_AT + place];
    }
    return frame;
}

void record_of_frame(const bus_frame *frame, uint8_t *record)
{
    word_into(frame->can_id, record);
    word_into(frame->length, &record[LENGTH_AT]);
    for (uint32_t place = 0U; place < FRAME_DATA_MOST; place++) {
        record[DATA_AT + place] = frame->data[place];
    }
}
