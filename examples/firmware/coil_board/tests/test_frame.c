/* SPDX-License-Identifier: Apache-2.0 */
/* Frames: the worked example of docs/icd.md, and what the gate keeps out. */
#include "check.h"
#include "messages.h"

static const bus_frame FIRE = {0x080U, 7U, {0xE5U, 0x01U, 0x07U, 0x64U, 0xB8U, 0x0BU, 0x86U, 0U}};

static void the_worked_example_is_intact(void)
{
    const fire_request fire = fire_of(&FIRE);
    bus_frame again = FIRE;
    again.data[6] = 0U;
    frame_seal(&again);
    CHECK(frame_is_intact(&FIRE));
    CHECK(again.data[6] == 0x86U);
    CHECK((fire.level == -2) && (fire.coil == 1U) && (fire.seq == 7U) && (fire.tick == 100U));
    CHECK(fire.duration_ms == 3000U);
}

static void a_frame_is_accepted_whole_or_not_at_all(void)
{
    for (uint32_t bit = 0U; bit < 56U; bit++) {
        bus_frame broken = FIRE;
        broken.data[bit / 8U] = (uint8_t)(broken.data[bit / 8U] ^ (1U << (bit % 8U)));
        CHECK(!frame_is_intact(&broken));
    }
    for (uint8_t length = 0U; length <= 8U; length++) {
        bus_frame other = FIRE;
        other.length = length;
        CHECK(frame_is_intact(&other) == (length == 7U));
    }
    for (uint32_t flag = 29U; flag < 32U; flag++) {
        bus_frame flagged = FIRE;
        flagged.can_id |= 1U << flag;
        CHECK(!frame_is_intact(&flagged));
    }
}

static void sync_and_tick_done_have_no_crc(void)
{
    const bus_frame sync = {SYNC_ID, 8U, {0x78U, 0x56U, 0x34U, 0x12U, 0U, 0U, 0U, 1U}};
    CHECK(frame_is_intact(&sync));
    CHECK(tick_of(&sync) == 0x12345678U);
}

static void what_a_status_cannot_carry_saturates(void)
{
    const coil_status most = {-3, 2U, 70000U, 100000, 1000000U, 255U};
    const bus_frame frame = status_frame(&most, 31U);
    CHECK(frame_is_intact(&frame));
    CHECK(frame.data[0] == 0xDFU);
    CHECK((frame.data[1] == 0xFEU) && (frame.data[2] == 0xFFU) && (frame.data[3] == 0xFFU));
    CHECK((frame.data[4] == 0xFDU) && (frame.data[5] == 0xFFU) && (frame.data[6] == 0xFFU));
}

int main(void)
{
    the_worked_example_is_intact();
    a_frame_is_accepted_whole_or_not_at_all();
    sync_and_tick_done_have_no_crc();
    what_a_status_cannot_carry_saturates();
    return failed_checks;
}
