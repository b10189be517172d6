/* SPDX-License-Identifier: Apache-2.0 */
/* The flight software: it answers each SYNC, fires when it may and not before, and heeds a stuck coil. */
#include "detumble.h"

#include "boards.h"
#include "check.h"

static detumble fsw;
static outbox out;

static void booted(void)
{
    out.count = 0U;
    detumble_boot(&fsw, &out);
}

/* A tick in which the field has turned on by as much as in each; how many frames are the answer. */
static uint32_t tick(uint32_t number, int16_t current_ma)
{
    const int16_t turned = (int16_t)(50 * (int32_t)(number % 200U));
    const bus_frame in[3] = {
        status_frame((uint8_t)(number % 16U), (uint8_t)(number % 3U), 0, current_ma),
        field_frame((uint8_t)(number % 16U), turned, 10000, -3000),
        sync_frame(number),
    };
    out.count = 0U;
    detumble_step(&fsw, in, 3U, &out);
    return out.count;
}

static uint32_t tick_of_done(uint32_t place)
{
    struct torquer_tick_done_t done = {0U, 0U};
    CHECK(out.frames[place].can_id == TORQUER_TICK_DONE_FRAME_ID);
    (void)torquer_tick_done_unpack(&done, out.frames[place].data, out.frames[place].length);
    return done.tick;
}

static void it_boots_and_boots_again_when_asked(void)
{
    const uint8_t data[FRAME_DATA_MOST] = {0U};
    const bus_frame asked = sealed(TORQUER_PLANT_BOOT_FRAME_ID, TORQUER_PLANT_BOOT_LENGTH, data);
    booted();
    CHECK((out.count == 1U) && (out.frames[0].can_id == TORQUER_FSW_BOOT_FRAME_ID));
    CHECK(frame_is_intact(&out.frames[0], TORQUER_FSW_BOOT_LENGTH));
    detumble_step(&fsw, &asked, 1U, &out);
    CHECK((out.count == 2U) && (out.frames[1].can_id == TORQUER_FSW_BOOT_FRAME_ID));
}

static void in_flight_it_boots_when_asked_twice(void)
{
    const uint8_t data[FRAME_DATA_MOST] = {0U};
    const bus_frame asked = sealed(TORQUER_PLANT_BOOT_FRAME_ID, TORQUER_PLANT_BOOT_LENGTH, data);
    booted();
    for (uint32_t number = 0U; number < 10U; number++) { /* noise, now and then */
        (void)tick(number, 0);
        out.count = 0U;
        detumble_step(&fsw, &asked, 1U, &out);
        CHECK(out.count == 0U);
    }
    detumble_step(&fsw, &asked, 1U, &out);
    CHECK((out.count == 1U) && (out.frames[0].can_id == TORQUER_FSW_BOOT_FRAME_ID));
}

static void a_forged_skip_is_left_at_once(void)
{
    booted();
    (void)tick(0U, 0);
    (void)tick(1U, 0);
    CHECK((tick(41U, 0) == 1U) && (tick_of_done(0U) == 41U));
    CHECK((tick(2U, 0) == 1U) && (tick_of_done(0U) == 2U));
    CHECK(fsw.pulses.wait_ticks[0] == BACKOFF_TICKS);
}

static void it_fires_as_soon_as_it_may(void)
{
    booted();
    for (uint32_t number = 0U; number < BACKOFF_TICKS; number++) {
        CHECK((tick(number, 0) == 1U) && (tick_of_done(0U) == number));
    }
    CHECK(tick(BACKOFF_TICKS, 0) == 2U);
    CHECK(out.frames[0].can_id == TORQUER_COIL_FIRE_FRAME_ID);
    CHECK(frame_is_intact(&out.frames[0], TORQUER_COIL_FIRE_LENGTH));
    CHECK(tick_of_done(1U) == BACKOFF_TICKS);
    struct torquer_coil_fire_t fire = {0U, 0, 0U, 0U, 0U, 0U, 0U};
    (void)torquer_coil_fire_unpack(&fire, out.frames[0].data, out.frames[0].length);
    CHECK((fire.coil == 0U) && (fire.level < 0)); /* against the change of the field, along x */
    CHECK((fire.tick == (uint8_t)(BACKOFF_TICKS & 0xFFU)) && (fire.seq == 1U) && (fire.duration_ms == DURATION_MS));
    CHECK(tick(BACKOFF_TICKS + 1U, 0) == 1U);
}

static void a_repeated_sync_is_answered_without_a_request(void)
{
    const bus_frame again = sync_frame(BACKOFF_TICKS);
    booted();
    for (uint32_t number = 0U; number <= BACKOFF_TICKS; number++) {
        (void)tick(number, 0);
    }
    CHECK(out.count == 2U);
    out.count = 0U;
    detumble_step(&fsw, &again, 1U, &out);
    CHECK((out.count == 1U) && (tick_of_done(0U) == BACKOFF_TICKS));
}

static void it_does_not_fire_with_a_stuck_coil(void)
{
    booted();
    for (uint32_t number = 0U; number < (2U * BACKOFF_TICKS); number++) {
        CHECK(tick(number, 400) == 1U);
    }
}

static void it_does_not_fire_without_a_status(void)
{
    booted();
    for (uint32_t number = 0U; number < (2U * BACKOFF_TICKS); number++) {
        const bus_frame in[2] = {field_frame((uint8_t)(number % 16U), (int16_t)(number % 100U), 9000, 0), sync_frame(number)};
        out.count = 0U;
        detumble_step(&fsw, in, 2U, &out);
        CHECK(out.count == 1U);
    }
}

static void lost_ticks_shorten_no_back_off(void)
{
    uint32_t number = 0U;
    booted();
    (void)tick(number, 0);
    number += 1U + 40U; /* 40 are lost */
    for (uint32_t answered = 1U; answered < BACKOFF_TICKS; answered++) {
        CHECK(tick(number, 0) == 1U);
        number++;
    }
    CHECK(tick(number, 0) == 2U);
}

static void one_strange_sync_is_ignored_and_two_are_believed(void)
{
    const bus_frame strange = sync_frame(1000000U);
    booted();
    for (uint32_t number = 0U; number < 10U; number++) {
        (void)tick(number, 0);
    }
    out.count = 0U;
    detumble_step(&fsw, &strange, 1U, &out);
    CHECK(out.count == 0U);
    CHECK((tick(10U, 0) == 1U) && (tick_of_done(0U) == 10U));
    out.count = 0U;
    detumble_step(&fsw, &strange, 1U, &out);
    CHECK(out.count == 0U);
    detumble_step(&fsw, &strange, 1U, &out);
    CHECK((out.count == 1U) && (tick_of_done(0U) == 1000000U));
    CHECK(fsw.pulses.wait_ticks[0] == BACKOFF_TICKS);
    CHECK((tick(11U, 0) == 1U) && (tick_of_done(0U) == 11U)); /* the two were forged */
    CHECK(fsw.pulses.wait_ticks[0] == BACKOFF_TICKS);
}

static bus_frame end_frame(uint32_t ticks)
{
    const struct torquer_plant_end_t message = {0U, ticks, 0U};
    uint8_t data[FRAME_DATA_MOST] = {0U};
    (void)torquer_plant_end_pack(data, &message, sizeof data);
    return sealed(TORQUER_PLANT_END_FRAME_ID, TORQUER_PLANT_END_LENGTH, data);
}

static void a_false_end_ends_no_flight(void)
{
    const bus_frame right = end_frame(10U);
    const bus_frame early = end_frame(9U);
    const bus_frame far = end_frame(10U + (61U * TICK_HZ));
    bus_frame broken = end_frame(10U);
    broken.data[4] = (uint8_t)(broken.data[4] ^ 1U);
    booted();
    CHECK(!detumble_is_end(&fsw, &right));
    for (uint32_t number = 0U; number < 10U; number++) {
        (void)tick(number, 0);
    }
    CHECK(detumble_is_end(&fsw, &right));
    CHECK(!(detumble_is_end(&fsw, &early) || detumble_is_end(&fsw, &far) || detumble_is_end(&fsw, &broken)));
}

static void more_than_the_outbox_holds_is_not_sent(void)
{
    booted();
    for (uint32_t number = 0U; number < 100U; number++) {
        const bus_frame sync = sync_frame(number);
        detumble_step(&fsw, &sync, 1U, &out);
        CHECK(out.count <= OUTBOX_MOST);
    }
}

int main(void)
{
    it_boots_and_boots_again_when_asked();
    in_flight_it_boots_when_asked_twice();
    a_forged_skip_is_left_at_once();
    it_fires_as_soon_as_it_may();
    a_repeated_sync_is_answered_without_a_request();
    it_does_not_fire_with_a_stuck_coil();
    it_does_not_fire_without_a_status();
    lost_ticks_shorten_no_back_off();
    one_strange_sync_is_ignored_and_two_are_believed();
    a_false_end_ends_no_flight();
    more_than_the_outbox_holds_is_not_sent();
    return failed_checks;
}
