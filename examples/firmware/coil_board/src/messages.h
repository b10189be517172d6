/* SPDX-License-Identifier: Apache-2.0 */
/* The messages that a coil driver board receives and sends, as docs/icd.md lays them out. */
#ifndef MESSAGES_H
#define MESSAGES_H

#include "frame.h"

#define COIL_FIRE_ID 0x080U
#define COIL_STATUS_ID 0x100U
#define COIL_REFUSED_ID 0x108U
#define SYNC_ID 0x180U
#define TICK_DONE_ID 0x280U
#define COIL_EVENT_ID 0x420U
#define PLANT_BOOT_ID 0x500U
#define COIL_BOOT_ID 0x520U
#define COIL_HEARTBEAT_ID 0x620U

/* Bytes that a COIL_FIRE must have for its coil and seq to be read. */
#define COIL_FIRE_NAMED_BYTES 3U

/* Why a request is refused: reason of COIL_REFUSED. NOT_REFUSED is never sent. */
typedef enum {
    NOT_REFUSED = 0,
    MALFORMED = 1,
    WRONG_TICK = 2,
    REPEATED_SEQ = 3,
    BAD_COIL = 4,
    BAD_LEVEL = 5,
    BAD_DURATION = 6,
    COIL_ON = 7,
    LOCKOUT = 8
} refusal_reason;

/* state of COIL_HEARTBEAT. */
typedef enum { STATE_READY = 0, STATE_ON = 1, STATE_LOCKED_OUT = 2, STATE_FAULT = 3 } board_state;

/* event of COIL_EVENT. NO_EVENT is never sent. */
typedef enum {
    NO_EVENT = 0,
    SELF_TEST_FAILED = 1,
    DEAD_MAN = 2,
    CURRENT_WHILE_OFF = 3,
    NO_CURRENT = 4,
    CURRENT_REVERSED = 5,
    CURRENT_WRONG = 6
} coil_event;

/* A COIL_FIRE. */
typedef struct {
    int8_t level;
    uint8_t coil;
    uint8_t seq;
    uint8_t tick;
    uint16_t duration_ms;
} fire_request;

/* A COIL_STATUS. Times and current saturate at the range of their signals. */
typedef struct {
    int8_t level;
    uint8_t coil;
    uint32_t remaining_ms;
    int32_t current_ma;
    uint32_t lockout_ms; /* a multiple of 10 */
    uint8_t seq;
} coil_status;

/* A COIL_REFUSED: coil and seq of the request, low byte of the tick in which it came. */
typedef struct {
    uint8_t coil;
    uint8_t seq;
    uint8_t tick;
    refusal_reason reason;
} coil_refusal;

/* What a COIL_FIRE asks for; bytes that a broken one lacks count as 0. */
fire_request fire_of(const bus_frame *frame);

/* tick of a SYNC or TICK_DONE. */
uint32_t tick_of(const bus_frame *frame);

bus_frame boot_frame(uint32_t table_crc);
bus_frame status_frame(const coil_status *status, uint8_t counter);
bus_frame refused_frame(const coil_refusal *refusal, uint8_t counter);
bus_frame event_frame(coil_event event, uint32_t tick, int32_t argument, uint8_t counter);
bus_frame heartbeat_frame(board_state state, uint32_t rejects, uint32_t tick, uint8_t counter);

#endif
