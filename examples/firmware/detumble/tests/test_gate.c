/* SPDX-License-Identifier: Apache-2.0 */
/* The gate: a frame is taken whole or not at all, and in SI. */
#include "gate.h"

#include <math.h>

#include "boards.h"
#include "check.h"

static gate state;

static bool is_taken(bus_frame frame)
{
    gate_boot(&state);
    gate_take(&state, &frame);
    return state.readings.has_field || state.readings.has_status;
}

static void a_sample_is_in_tesla(void)
{
    CHECK(is_taken(field_frame(3U, 5000, -10000, 1)));
    CHECK(fabsf(state.readings.b_t.x - 1.0e-5F) < 1.0e-11F);
    CHECK(fabsf(state.readings.b_t.y + 2.0e-5F) < 1.0e-11F);
}

static void a_broken_frame_is_not_taken(void)
{
    for (uint32_t bit = 0U; bit < 64U; bit++) {
        bus_frame broken = field_frame(3U, 5000, -10000, 1);
        broken.data[bit / 8U] = (uint8_t)(broken.data[bit / 8U] ^ (1U << (bit % 8U)));
        CHECK(!is_taken(broken));
    }
    for (uint32_t flag = 29U; flag < 32U; flag++) {
        bus_frame flagged = field_frame(3U, 5000, -10000, 1);
        flagged.can_id |= 1UL << flag;
        CHECK(!is_taken(flagged));
    }
    for (uint8_t length = 0U; length < 8U; length++) {
        bus_frame other = field_frame(3U, 5000, -10000, 1);
        other.length = length;
        CHECK(!is_taken(other));
    }
}

static void a_repeated_frame_is_not_taken(void)
{
    const bus_frame first = field_frame(3U, 5000, 0, 0);
    const bus_frame second = field_frame(4U, 6000, 0, 0);
    gate_boot(&state);
    gate_take(&state, &first);
    gate_clear(&state);
    gate_take(&state, &first);
    CHECK(!state.readings.has_field);
    gate_take(&state, &second);
    CHECK(state.readings.has_field);
}

static void a_status_that_cannot_be_is_not_taken(void)
{
    CHECK(is_taken(status_frame(0U, 2U, -3, -400)));
    CHECK((state.readings.coil == 2U) && (state.readings.level == -3) && (state.readings.current_ma == -400));
    CHECK(!is_taken(status_frame(0U, 3U, 0, 0)));
    CHECK(!is_taken(status_frame(0U, 0U, 4, 0)));
    CHECK(!is_taken(status_frame(0U, 0U, -4, 0)));
}

int main(void)
{
    a_sample_is_in_tesla();
    a_broken_frame_is_not_taken();
    a_repeated_frame_is_not_taken();
    a_status_that_cannot_be_is_not_taken();
    return failed_checks;
}
