/* SPDX-License-Identifier: Apache-2.0 */
#include "harness.h"

#include <string.h>

#include "record.h"

#define BODY_AT 4U
#define FIELD_AT 16U
#define OWED_AT 16U
#define BUSY_AT 28U
#define SCHEDULE_BYTES 32U

static detumble fsw;
static outbox answers;
static scheduler pulses;

static uint32_t write_answers(uint8_t *reply)
{
    const uint32_t count = answers.count;
    reply[0] = (uint8_t)count;
    for (uint32_t place = 0U; place < count; place++) {
        record_of_frame(&answers.frames[place], &reply[BODY_AT + (RECORD_BYTES * place)]);
    }
    answers.count = 0U;
    return BODY_AT + (RECORD_BYTES * count);
}

static void step(const uint8_t *request)
{
    bus_frame frames[HARNESS_FRAMES_MOST];
    const uint32_t count = (request[1] < HARNESS_FRAMES_MOST) ? request[1] : HARNESS_FRAMES_MOST;
    for (uint32_t place = 0U; place < count; place++) {
        frames[place] = record_to_frame(&request[BODY_AT + (RECORD_BYTES * place)]);
    }
    detumble_step(&fsw, frames, count, &answers);
}

static uint32_t write_schedule(coil_pulse pulse, uint8_t *reply)
{
    reply[0] = pulse.coil;
    reply[1] = (uint8_t)pulse.level;
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        word_into(pulses.wait_ticks[coil], &reply[BODY_AT + (4U * coil)]);
    }
    (void)memcpy(&reply[OWED_AT], &pulses.owed_nms, sizeof pulses.owed_nms);
    word_into(pulses.busy_ticks, &reply[BUSY_AT]);
    return SCHEDULE_BYTES;
}

/* A tick of the scheduler: what it fires by this dipole and field. */
static coil_pulse schedule(const uint8_t *request)
{
    const coil_set coils = coils_of_scenario();
    vec3 m_am2;
    vec3 b_t;
    (void)memcpy(&m_am2, &request[BODY_AT], sizeof m_am2);
    (void)memcpy(&b_t, &request[FIELD_AT], sizeof b_t);
    const vec3 torque_nm = vec3_cross(m_am2, b_t);
    scheduler_owe(&pulses, &coils, torque_nm, b_t);
    const coil_pulse pulse = scheduler_choose(&pulses, &coils, torque_nm, b_t);
    if (pulse.level != 0) {
        scheduler_fire(&pulses, pulse, coils_impulse(&coils, pulse, b_t));
    }
    return pulse;
}

uint32_t harness_step(const uint8_t *request, uint8_t *reply)
{
    static const coil_pulse NONE = {0U, 0};
    uint32_t length = 0U;
    if (request[0] == HARNESS_BOOT) {
        detumble_boot(&fsw, &answers);
        length = write_answers(reply);
    } else if (request[0] == HARNESS_STEP) {
        step(request);
        length = write_answers(reply);
    } else if (request[0] == HARNESS_BOOT_SCHEDULER) {
        scheduler_boot(&pulses);
        length = write_schedule(NONE, reply);
    } else {
        const coil_pulse pulse = schedule(request);
        length = write_schedule(pulse, reply);
        scheduler_tick(&pulses);
    }
    return length;
}
