/* SPDX-License-Identifier: Apache-2.0 */
/* The gate: from frames of the bus to what the boards have said in this tick, in body axes and SI.
 *
 * A frame is taken whole or not at all: a known identifier, right length and CRC, a counter that has moved,
 * values that can be. The last one of each kind counts.
 */
#ifndef GATE_H
#define GATE_H

#include "frame.h"
#include "vector.h"

#define REFUSALS_MOST 8U
#define GATE_KINDS 6U

/* A request that the board has refused; tick: the low byte of that in which it came. */
typedef struct {
    uint8_t coil;
    uint8_t seq;
    uint8_t reason;
    uint8_t tick;
} coil_refusal;

/* What has come in this tick; what is not valid has not. */
typedef struct {
    bool has_field;
    vec3 b_t;
    bool has_attitude;
    vec3 q; /* vector part of the quaternion from orbital frame to body, its scalar part not negative */
    bool has_rate;
    vec3 omega_radps; /* of the body against the orbital frame */
    bool has_status;
    int8_t level; /* driven in the tick that has just ended, */
    uint8_t coil; /* by this coil, */
    int32_t current_ma;
    uint32_t lockout_ms; /* that is locked out for so long */
    uint8_t seq;         /* of the last request that the board accepted */
    bool coil_booted;
    coil_refusal refused[REFUSALS_MOST];
    uint32_t refused_count;
} gate_readings;

typedef struct {
    bool has_counter[GATE_KINDS];
    uint8_t counter[GATE_KINDS]; /* of the last frame of each kind */
    gate_readings readings;
} gate;

void gate_boot(gate *state);

/* A tick begins: nothing has been said in it. */
void gate_clear(gate *state);

/* A frame of a board; others change nothing. */
void gate_take(gate *state, const bus_frame *frame);

#endif
