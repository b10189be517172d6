/* SPDX-License-Identifier: Apache-2.0 */
/* The frames of the boards, for tests. */
#ifndef BOARDS_H
#define BOARDS_H

#include "frame.h"
#include "torquer.h"

static inline bus_frame sealed(uint32_t can_id, uint8_t length, const uint8_t *data)
{
    bus_frame frame = frame_of(can_id, length);
    for (uint8_t place = 0U; place < length; place++) {
        frame.data[place] = data[place];
    }
    frame_seal(&frame);
    return frame;
}

static inline bus_frame field_frame(uint8_t counter, int16_t x, int16_t y, int16_t z)
{
    const struct torquer_mag_field_t message = {counter, 1U, x, y, z, 0U};
    uint8_t data[FRAME_DATA_MOST] = {0U};
    (void)torquer_mag_field_pack(data, &message, sizeof data);
    return sealed(TORQUER_MAG_FIELD_FRAME_ID, TORQUER_MAG_FIELD_LENGTH, data);
}

static inline bus_frame status_frame(uint8_t counter, uint8_t coil, int8_t level, int16_t current_ma)
{
    struct torquer_coil_status_t message = {counter, level, coil, 0U, current_ma, 0U, 0U, 0U};
    uint8_t data[FRAME_DATA_MOST] = {0U};
    (void)torquer_coil_status_pack(data, &message, sizeof data);
    return sealed(TORQUER_COIL_STATUS_FRAME_ID, TORQUER_COIL_STATUS_LENGTH, data);
}

static inline bus_frame sync_frame(uint32_t tick)
{
    const struct torquer_sync_t message = {tick, 0U};
    bus_frame frame = frame_of(TORQUER_SYNC_FRAME_ID, TORQUER_SYNC_LENGTH);
    (void)torquer_sync_pack(frame.data, &message, sizeof frame.data);
    return frame;
}

#endif
