/* SPDX-License-Identifier: Apache-2.0 */
#include "gate.h"

#include "coils.h"
#include "torquer.h"

#define TESLA_PER_NT 1.0e-9F
#define SQUARE_MOST 1.0001F /* of the vector part: 1, and the rounding of the bus */
#define LEVEL_MOST 3
#define COUNTER_MASK 0x0FU

/* Kinds by their place among the counters; those of the coil board come first. */
typedef enum { KIND_STATUS = 0, KIND_REFUSED = 1, KIND_BOOT = 2, KIND_FIELD = 3, KIND_ATTITUDE = 4, KIND_RATE = 5 } gate_kind;
#define COIL_KINDS 3U

void gate_clear(gate *state)
{
    gate_readings *readings = &state->readings;
    readings->has_field = false;
    readings->has_attitude = false;
    readings->has_rate = false;
    readings->has_status = false;
    readings->coil_booted = false;
    readings->refused_count = 0U;
}

void gate_boot(gate *state)
{
    for (uint32_t kind = 0U; kind < GATE_KINDS; kind++) {
        state->has_counter[kind] = false;
        state->counter[kind] = 0U;
    }
    gate_clear(state);
}

/* --- what each message says; false: its values cannot be */

static bool take_field(gate_readings *readings, const bus_frame *frame)
{
    static const double MATRIX[3][3] = TORQUER_MAG_MATRIX;
    static const double OFFSET_NT[3] = TORQUER_MAG_OFFSET_NT;
    struct torquer_mag_field_t message;
    const bool read = torquer_mag_field_unpack(&message, frame->data, frame->length) == 0;
    if (read) {
        mat3 matrix;
        vec3 reading_nt;
        for (uint32_t place = 0U; place < 3U; place++) {
            matrix.row[place].x = (float)MATRIX[place][0];
            matrix.row[place].y = (float)MATRIX[place][1];
            matrix.row[place].z = (float)MATRIX[place][2];
        }
        reading_nt.x = (float)(torquer_mag_field_b_x_decode(message.b_x) - OFFSET_NT[0]);
        reading_nt.y = (float)(torquer_mag_field_b_y_decode(message.b_y) - OFFSET_NT[1]);
        reading_nt.z = (float)(torquer_mag_field_b_z_decode(message.b_z) - OFFSET_NT[2]);
        readings->has_field = message.valid != 0U;
        readings->b_t = vec3_scale(TESLA_PER_NT, mat3_transform(&matrix, reading_nt));
    }
    return read;
}

static bool take_attitude(gate_readings *readings, const bus_frame *frame)
{
    struct torquer_ref_attitude_t message;
    bool taken = torquer_ref_attitude_unpack(&message, frame->data, frame->length) == 0;
    if (taken) {
        vec3 q;
        q.x = (float)torquer_ref_attitude_q_x_decode(message.q_x);
        q.y = (float)torquer_ref_attitude_q_y_decode(message.q_y);
        q.z = (float)torquer_ref_attitude_q_z_decode(message.q_z);
        const float square = vec3_dot(q, q);
        taken = square < SQUARE_MOST;
        if (taken) {
            readings->has_attitude = message.valid != 0U;
            readings->q = (square > 1.0F) ? vec3_scale(1.0F / vec3_norm(q), q) : q;
        }
    }
    return taken;
}

static bool take_rate(gate_readings *readings, const bus_frame *frame)
{
    struct torquer_ref_rate_t message;
    const bool read = torquer_ref_rate_unpack(&message, frame->data, frame->length) == 0;
    if (read) {
        readings->has_rate = message.valid != 0U;
        readings->omega_radps.x = (float)torquer_ref_rate_w_x_decode(message.w_x);
        readings->omega_radps.y = (float)torquer_ref_rate_w_y_decode(message.w_y);
        readings->omega_radps.z = (float)torquer_ref_rate_w_z_decode(message.w_z);
    }
    return read;
}

static bool take_status(gate_readings *readings, const bus_frame *frame)
{
    struct torquer_coil_status_t message;
    bool taken = torquer_coil_status_unpack(&message, frame->data, frame->length) == 0;
    taken = taken && (message.level >= -LEVEL_MOST) && (message.level <= LEVEL_MOST) && (message.coil < COILS);
    if (taken) {
        readings->has_status = true;
        readings->level = message.level;
        readings->coil = message.coil;
        readings->current_ma = message.current_ma;
        readings->lockout_ms = (uint32_t)torquer_coil_status_lockout_ms_decode(message.lockout_ms);
        readings->seq = message.seq;
    }
    return taken;
}

static bool take_refused(gate_readings *readings, const bus_frame *frame)
{
    struct torquer_coil_refused_t message;
    const bool read = torquer_coil_refused_unpack(&message, frame->data, frame->length) == 0;
    if (read && (readings->refused_count < REFUSALS_MOST)) {
        coil_refusal *refused = &readings->refused[readings->refused_count];
        refused->coil = message.coil;
        refused->seq = message.seq;
        refused->reason = message.reason;
        refused->tick = message.tick;
        readings->refused_count++;
    }
    return read;
}

/* --- the gate */

static bool take_kind(gate *state, const bus_frame *frame, gate_kind kind)
{
    gate_readings *readings = &state->readings;
    bool taken = true;
    switch (kind) {
    case KIND_STATUS:
        taken = take_status(readings, frame);
        break;
    case KIND_REFUSED:
        taken = take_refused(readings, frame);
        break;
    case KIND_FIELD:
        taken = take_field(readings, frame);
        break;
    case KIND_ATTITUDE:
        taken = take_attitude(readings, frame);
        break;
    case KIND_RATE:
        taken = take_rate(readings, frame);
        break;
    case KIND_BOOT:
    default:
        readings->coil_booted = true;
        break;
    }
    return taken;
}

static void judge(gate *state, const bus_frame *frame, gate_kind kind)
{
    const uint8_t counter = (uint8_t)(frame->data[0] & COUNTER_MASK);
    if (kind == KIND_BOOT) { /* a board that boots counts anew */
        for (uint32_t place = 0U; place < COIL_KINDS; place++) {
            state->has_counter[place] = false;
        }
    }
    const bool repeated = state->has_counter[kind] && (state->counter[kind] == counter);
    if ((!repeated) && take_kind(state, frame, kind)) {
        state->has_counter[kind] = true;
        state->counter[kind] = counter;
    }
}

void gate_take(gate *state, const bus_frame *frame)
{
    static const struct {
        uint16_t can_id;
        uint8_t length;
        gate_kind kind;
    } KINDS[GATE_KINDS] = {
        {TORQUER_COIL_STATUS_FRAME_ID, TORQUER_COIL_STATUS_LENGTH, KIND_STATUS},
        {TORQUER_COIL_REFUSED_FRAME_ID, TORQUER_COIL_REFUSED_LENGTH, KIND_REFUSED},
        {TORQUER_COIL_BOOT_FRAME_ID, TORQUER_COIL_BOOT_LENGTH, KIND_BOOT},
        {TORQUER_MAG_FIELD_FRAME_ID, TORQUER_MAG_FIELD_LENGTH, KIND_FIELD},
        {TORQUER_REF_ATTITUDE_FRAME_ID, TORQUER_REF_ATTITUDE_LENGTH, KIND_ATTITUDE},
        {TORQUER_REF_RATE_FRAME_ID, TORQUER_REF_RATE_LENGTH, KIND_RATE},
    };
    for (uint32_t place = 0U; place < GATE_KINDS; place++) {
        if ((frame->can_id == KINDS[place].can_id) && frame_is_intact(frame, KINDS[place].length)) {
            judge(state, frame, KINDS[place].kind);
        }
    }
}
