/* SPDX-License-Identifier: Apache-2.0 */
#include "detumble.h"

#include "detumble_gains.h"
#include "laws.h"
#include "torquer.h"

#define CONTRACT_VERSION 1U
#define COUNTER_MASK 0x0FU
#define LOW_BYTE 0xFFU
#define LEAP_TICKS (60U * TICK_HZ) /* a SYNC no further ahead is believed: those between were lost */
#define OLD_TICKS (10U * TICK_HZ)  /* a field sample that is older gives neither rate nor torque */

static void post(outbox *out, const bus_frame *frame)
{
    if (out->count < OUTBOX_MOST) {
        out->frames[out->count] = *frame;
        out->count++;
    }
}

/* --- what is sent */

static void send_boot(outbox *out)
{
    bus_frame frame = frame_of(TORQUER_FSW_BOOT_FRAME_ID, TORQUER_FSW_BOOT_LENGTH);
    const struct torquer_fsw_boot_t message = {0U, 0U, CONTRACT_VERSION, 0U, 0U};
    if (torquer_fsw_boot_pack(frame.data, &message, FRAME_DATA_MOST) > 0) {
        frame_seal(&frame);
        post(out, &frame);
    }
}

static void send_fire(detumble *fsw, coil_pulse pulse, outbox *out)
{
    bus_frame frame = frame_of(TORQUER_COIL_FIRE_FRAME_ID, TORQUER_COIL_FIRE_LENGTH);
    struct torquer_coil_fire_t message;
    message.counter = (uint8_t)(fsw->fire_counter & COUNTER_MASK);
    message.level = pulse.level;
    message.coil = pulse.coil;
    message.seq = (uint8_t)((fsw->board.seq + 1U) & LOW_BYTE);
    message.tick = (uint8_t)(fsw->tick & LOW_BYTE);
    message.duration_ms = (uint16_t)DURATION_MS;
    message.crc = 0U;
    if (torquer_coil_fire_pack(frame.data, &message, FRAME_DATA_MOST) > 0) {
        frame_seal(&frame);
        post(out, &frame);
        fsw->fire_counter++;
    }
}

static void send_done(uint32_t tick, outbox *out)
{
    bus_frame frame = frame_of(TORQUER_TICK_DONE_FRAME_ID, TORQUER_TICK_DONE_LENGTH);
    const struct torquer_tick_done_t message = {tick, 0U};
    if (torquer_tick_done_pack(frame.data, &message, FRAME_DATA_MOST) > 0) {
        post(out, &frame);
    }
}

/* --- what is known */

/* The tick count begins: whatever was known is of another time. */
static void begin_count(detumble *fsw)
{
    scheduler_boot(&fsw->pulses);
    board_boot(&fsw->board);
    fsw->mode = MODE_DETUMBLE;
    fsw->integral_s = VEC3_ZERO;
    fsw->sample.is_known = false;
    fsw->before.is_known = false;
    fsw->has_tick = false;
    fsw->has_strange = false;
    fsw->is_asked = false;
}

/* A sample counts only while no coil adds a field of its own. */
static void update_field(detumble *fsw)
{
    const gate_readings *readings = &fsw->gate.readings;
    fsw->before = fsw->sample;
    if (readings->has_field && board_is_off(readings) && (fsw->board.idle_ticks > GAINS_BLANK_TICKS)) {
        fsw->sample.is_known = true;
        fsw->sample.tick = fsw->tick;
        fsw->sample.b_t = readings->b_t;
    }
}

static void update_mode(detumble *fsw)
{
    const gate_readings *readings = &fsw->gate.readings;
    const float most_radps = (fsw->mode == MODE_POINT) ? GAINS_FAST_RADPS : GAINS_SLOW_RADPS;
    if (readings->has_attitude && readings->has_rate && (vec3_norm(readings->omega_radps) < most_radps)) {
        fsw->mode = MODE_POINT;
    } else {
        fsw->mode = MODE_DETUMBLE;
        fsw->integral_s = VEC3_ZERO;
    }
}

/* --- what is to be done */

/* PD, and what its integral holds against a constant torque. Far from the goal it is frozen, and the error limited. */
static vec3 pointing_am2(detumble *fsw, vec3 b_t)
{
    const gate_readings *readings = &fsw->gate.readings;
    const float most_am2 = fsw->coils.mean_am2;
    const vec3 error = attitude_error(readings->q);
    const vec3 limited = within_dipole(b_t, error, GAINS_K_A, most_am2);
    vec3 integral_s = fsw->integral_s;
    if (vec3_norm(error) < (2.0F * GAINS_NEAR_RAD)) {
        integral_s = vec3_add(integral_s, vec3_scale(fsw->coils.tick_s, error));
    }
    fsw->integral_s = within_dipole(b_t, integral_s, GAINS_K_I, most_am2);
    const vec3 held_am2 = holding_dipole(b_t, fsw->integral_s, GAINS_K_I);
    return vec3_add(pd_dipole(b_t, readings->omega_radps, limited, GAINS_K_W, GAINS_K_A), held_am2);
}

static vec3 demand_am2(detumble *fsw)
{
    const field_sample *now = &fsw->sample;
    const field_sample *before = &fsw->before;
    const uint32_t apart_ticks = now->tick - before->tick;
    vec3 m_am2 = VEC3_ZERO;
    if ((!now->is_known) || ((fsw->tick - now->tick) > OLD_TICKS)) {
        /* no field: no torque */
    } else if (fsw->mode == MODE_POINT) {
        m_am2 = pointing_am2(fsw, now->b_t);
    } else if (before->is_known && (apart_ticks > 0U) && (apart_ticks <= OLD_TICKS)) {
        m_am2 = bdot_dipole(now->b_t, before->b_t, (float)apart_ticks * fsw->coils.tick_s, GAINS_K_W);
    } else {
        /* no two samples: no rate */
    }
    return m_am2;
}

/* At most one request, when the coil's own timer and the board's last report of it agree. */
static void actuate(detumble *fsw, vec3 m_am2, outbox *out)
{
    board_view *board = &fsw->board;
    const gate_readings *readings = &fsw->gate.readings;
    const vec3 b_t = fsw->sample.is_known ? fsw->sample.b_t : VEC3_ZERO;
    const vec3 torque_nm = vec3_cross(m_am2, b_t);
    if (board_has_refused(board, readings, fsw->tick)) { /* it has paid nothing */
        fsw->pulses.owed_nms = vec3_add(fsw->pulses.owed_nms, board->paid_nms);
        board->fired.coil = 0U;
        board->fired.level = 0;
        board->paid_nms = VEC3_ZERO;
    }
    scheduler_owe(&fsw->pulses, &fsw->coils, torque_nm, b_t);
    const coil_pulse pulse = scheduler_choose(&fsw->pulses, &fsw->coils, torque_nm, b_t);
    if ((pulse.level != 0) && board_is_ready(board, readings, pulse.coil)) {
        board->has_fired = true;
        board->fired_tick = fsw->tick;
        board->fired = pulse;
        board->paid_nms = coils_impulse(&fsw->coils, pulse, b_t);
        scheduler_fire(&fsw->pulses, pulse, board->paid_nms);
        send_fire(fsw, pulse, out);
    }
}

static void answer(detumble *fsw, outbox *out)
{
    const gate_readings *readings = &fsw->gate.readings;
    board_update(&fsw->board, readings);
    update_field(fsw);
    update_mode(fsw);
    if (board_is_stuck(readings)) { /* whatever is owed, coils that do not obey cannot pay it */
        scheduler_forget(&fsw->pulses);
    } else {
        actuate(fsw, demand_am2(fsw), out);
    }
    send_done(fsw->tick, out);
}

/* --- the count of ticks */

static void enter(detumble *fsw, uint32_t tick, outbox *out)
{
    if (fsw->has_tick) {
        scheduler_tick(&fsw->pulses);
    }
    fsw->has_tick = true;
    fsw->has_strange = false;
    fsw->is_asked = false;
    fsw->tick = tick;
    answer(fsw, out);
}

/* Enter a tick that does not follow: where the SYNC was forged, the true count goes on from the one before. */
static void leap(detumble *fsw, uint32_t tick, outbox *out)
{
    const uint32_t abandoned_tick = fsw->tick;
    enter(fsw, tick, out);
    fsw->has_strange = true;
    fsw->strange_tick = abandoned_tick;
}

static void take_sync(detumble *fsw, uint32_t tick, outbox *out)
{
    const uint32_t ahead = tick - fsw->tick;
    if ((!fsw->has_tick) || (ahead == 1U)) {
        enter(fsw, tick, out);
    } else if (ahead == 0U) { /* the plant has not received the answer */
        send_done(tick, out);
    } else if (ahead <= LEAP_TICKS) { /* those between were lost */
        leap(fsw, tick, out);
    } else if (fsw->has_strange && ((tick - fsw->strange_tick) <= 1U)) { /* it counts anew */
        begin_count(fsw);
        gate_clear(&fsw->gate);
        leap(fsw, tick, out);
    } else {
        fsw->has_strange = true;
        fsw->strange_tick = tick;
    }
    gate_clear(&fsw->gate);
}

/* --- the flight software */

void detumble_boot(detumble *fsw, outbox *out)
{
    fsw->coils = coils_of_scenario();
    fsw->fire_counter = 0U;
    gate_boot(&fsw->gate);
    begin_count(fsw);
    send_boot(out);
}

/* The plant has begun, and asks who is there. In flight one alone is noise: it asks again until it is answered. */
static void take_plant_boot(detumble *fsw, outbox *out)
{
    if (!fsw->has_tick) {
        send_boot(out);
    } else if (fsw->is_asked) {
        detumble_boot(fsw, out);
    } else {
        fsw->is_asked = true;
    }
}

void detumble_step(detumble *fsw, const bus_frame *in, uint32_t count, outbox *out)
{
    for (uint32_t place = 0U; place < count; place++) {
        const bus_frame *frame = &in[place];
        struct torquer_sync_t sync;
        if ((frame->can_id == TORQUER_SYNC_FRAME_ID) && (frame->length == TORQUER_SYNC_LENGTH)) {
            if (torquer_sync_unpack(&sync, frame->data, frame->length) == 0) {
                take_sync(fsw, sync.tick, out);
            }
        } else if ((frame->can_id == TORQUER_PLANT_BOOT_FRAME_ID) &&
                   frame_is_intact(frame, TORQUER_PLANT_BOOT_LENGTH)) {
            take_plant_boot(fsw, out);
        } else {
            gate_take(&fsw->gate, frame);
        }
    }
}

bool detumble_is_end(const detumble *fsw, const bus_frame *frame)
{
    struct torquer_plant_end_t end;
    bool is_end = (frame->can_id == TORQUER_PLANT_END_FRAME_ID) &&
                  frame_is_intact(frame, TORQUER_PLANT_END_LENGTH) && fsw->has_tick;
    is_end = is_end && (torquer_plant_end_unpack(&end, frame->data, frame->length) == 0);
    return is_end && ((end.ticks - (fsw->tick + 1U)) <= LEAP_TICKS);
}
