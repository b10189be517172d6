/* SPDX-License-Identifier: Apache-2.0 */
#include "harness.h"

#include "record.h"

#define OP_SWITCH_ON 0U
#define OP_RECEIVE 1U
#define NOW_AT 4U
#define CURRENT_AT 8U
#define RECORD_AT 12U
#define HEAD_BYTES 8U

static coil_board board;
static outbox sent;

static uint32_t write_reply(uint8_t *reply)
{
    const coil_drive drive = coil_board_drive(&board);
    reply[0] = drive.coil;
    reply[1] = (uint8_t)drive.level;
    reply[2] = (uint8_t)sent.count;
    reply[3] = 0U;
    word_into(drive.until_ms, &reply[4]);
    for (uint32_t place = 0U; place < sent.count; place++) {
        record_of_frame(&sent.frames[place], &reply[HEAD_BYTES + (RECORD_BYTES * place)]);
    }
    return HEAD_BYTES + (RECORD_BYTES * sent.count);
}

uint32_t harness_step(const uint8_t *request, uint8_t *reply)
{
    const uint32_t now_ms = word_from(&request[NOW_AT]);
    const int32_t current_ma = (int32_t)word_from(&request[CURRENT_AT]);
    const bus_frame frame = record_to_frame(&request[RECORD_AT]);
    sent.count = 0U;
    if (request[0] == OP_SWITCH_ON) {
        coil_board_switch_on(&board, frame.can_id, now_ms, current_ma, &sent);
    } else if (request[0] == OP_RECEIVE) {
        coil_board_receive(&board, &frame, now_ms, current_ma, &sent);
    } else {
        coil_board_pass_time(&board, now_ms);
    }
    return write_reply(reply);
}
