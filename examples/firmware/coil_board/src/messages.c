/* SPDX-License-Identifier: Apache-2.0 */
#include "messages.h"

#define CONTRACT_VERSION 1U /* of the bus */
#define COUNTER_MASK 0x0FU
#define BYTE_MASK 0xFFU
#define REMAINING_MOST_MS 4095U
#define LOCKOUT_MOST_RAW 16383U
#define LOCKOUT_STEP_MS 10U
#define CURRENT_LEAST_MA (-2048)
#define CURRENT_MOST_MA 2047

static bus_frame empty_frame(uint32_t can_id, uint8_t length, uint8_t counter)
{
    bus_frame frame = {can_id, length, {0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U}};
    frame.data[0] = (uint8_t)(counter & COUNTER_MASK);
    return frame;
}

/* Put the low bytes of a value into the frame, least significant first. */
static void put(bus_frame *frame, uint32_t first, uint32_t count, uint32_t value)
{
    for (uint32_t place = 0U; place < count; place++) {
        frame->data[first + place] = (uint8_t)((value >> (8U * place)) & BYTE_MASK);
    }
}

/* Put four bits above the counter. */
static void put_nibble(bus_frame *frame, uint32_t value)
{
    frame->data[0] = (uint8_t)(frame->data[0] | ((value & 0x0FU) << 4U));
}

static uint32_t at_most(uint32_t value, uint32_t most)
{
    return (value < most) ? value : most;
}

fire_request fire_of(const bus_frame *frame)
{
    uint8_t bytes[FRAME_DATA_MOST] = {0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U};
    fire_request fire = {0, 0U, 0U, 0U, 0U};
    for (uint32_t place = 0U; (place < frame->length) && (place < FRAME_DATA_MOST); place++) {
        bytes[place] = frame->data[place];
    }
    const uint8_t nibble = (uint8_t)(bytes[0] >> 4U);
    fire.level = (int8_t)((nibble < 8U) ? (int32_t)nibble : ((int32_t)nibble - 16));
    fire.coil = (uint8_t)(bytes[1] & 0x03U);
    fire.seq = bytes[2];
    fire.tick = bytes[3];
    fire.duration_ms = (uint16_t)((uint32_t)bytes[4] | ((uint32_t)bytes[5] << 8U));
    return fire;
}

uint32_t tick_of(const bus_frame *frame)
{
    return (uint32_t)frame->data[0] | ((uint32_t)frame->data[1] << 8U) | ((uint32_t)frame->data[2] << 16U) |
           ((uint32_t)frame->data[3] << 24U);
}

bus_frame boot_frame(uint32_t table_crc)
{
    bus_frame frame = empty_frame(COIL_BOOT_ID, 7U, 0U);
    put(&frame, 1U, 1U, CONTRACT_VERSION);
    put(&frame, 2U, 4U, table_crc);
    frame_seal(&frame);
    return frame;
}

bus_frame status_frame(const coil_status *status, uint8_t counter)
{
    bus_frame frame = empty_frame(COIL_STATUS_ID, 8U, counter);
    const uint32_t remaining = at_most(status->remaining_ms, REMAINING_MOST_MS);
    const uint32_t lockout = at_most(status->lockout_ms / LOCKOUT_STEP_MS, LOCKOUT_MOST_RAW);
    int32_t current = status->current_ma;
    if (current < CURRENT_LEAST_MA) {
        current = CURRENT_LEAST_MA;
    } else if (current > CURRENT_MOST_MA) {
        current = CURRENT_MOST_MA;
    } else {
        /* within the range of the signal */
    }
    const uint32_t current_bits = (uint32_t)current & 0xFFFU;
    put_nibble(&frame, (uint32_t)(int32_t)status->level);
    /* bytes 1 to 5: coil 2 bits, remaining_ms 12, current_ma 12, lockout_ms 14 */
    put(&frame, 1U, 3U, (uint32_t)status->coil | (remaining << 2U) | (current_bits << 14U));
    put(&frame, 4U, 2U, (current_bits >> 10U) | (lockout << 2U));
    frame.data[6] = status->seq;
    frame_seal(&frame);
    return frame;
}

bus_frame refused_frame(const coil_refusal *refusal, uint8_t counter)
{
    bus_frame frame = empty_frame(COIL_REFUSED_ID, 5U, counter);
    put_nibble(&frame, refusal->coil);
    frame.data[1] = refusal->seq;
    frame.data[2] = (uint8_t)refusal->reason;
    frame.data[3] = refusal->tick;
    frame_seal(&frame);
    return frame;
}

bus_frame event_frame(coil_event event, uint32_t tick, int32_t argument, uint8_t counter)
{
    static const uint8_t SEVERITY[] = {0U, 3U, 2U, 3U, 2U, 2U, 1U}; /* by event: 1 WARNING, 2 ERROR, 3 FATAL */
    bus_frame frame = empty_frame(COIL_EVENT_ID, 8U, counter);
    put_nibble(&frame, SEVERITY[event]);
    frame.data[1] = (uint8_t)event;
    put(&frame, 2U, 1U, tick);
    put(&frame, 3U, 4U, (uint32_t)argument);
    frame_seal(&frame);
    return frame;
}

bus_frame heartbeat_frame(board_state state, uint32_t rejects, uint32_t tick, uint8_t counter)
{
    bus_frame frame = empty_frame(COIL_HEARTBEAT_ID, 8U, counter);
    put_nibble(&frame, (uint32_t)state);
    put(&frame, 1U, 2U, at_most(rejects, 0xFFFFU));
    /* slips stay 0: the board enters every tick, or restarts */
    put(&frame, 5U, 2U, tick);
    frame_seal(&frame);
    return frame;
}
