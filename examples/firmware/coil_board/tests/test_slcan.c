/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of slcan: a frame there and back, and lines that are none. */
#include "slcan.h"

#include <string.h>

#include "check.h"

static bool taken(const char *text, bus_frame *frame)
{
    static slcan_line line;
    bool complete = false;
    for (size_t place = 0U; text[place] != '\0'; place++) {
        complete = slcan_take(&line, (uint8_t)text[place], frame);
    }
    return complete;
}

static void a_frame_is_the_same_there_and_back(void)
{
    const bus_frame frame = {0x5A3U, 3U, {0x00U, 0x9FU, 0xE1U, 0U, 0U, 0U, 0U, 0U}};
    bus_frame back = {0U, 0U, {0U}};
    uint8_t text[SLCAN_LINE_MOST + 1U] = {0U};
    const uint32_t length = slcan_write(&frame, text);
    CHECK(length == strlen((const char *)text));
    CHECK(strcmp((const char *)text, "t5A33009FE1\r") == 0);
    CHECK(taken((const char *)text, &back));
    CHECK((back.can_id == 0x5A3U) && (back.length == 3U) && (memcmp(back.data, frame.data, 3U) == 0));
}

static void flags_stand_above_the_identifier(void)
{
    bus_frame frame = {0U, 0U, {0U}};
    CHECK(taken("T000000801aa\r", &frame) && (frame.can_id == 0x80000080U) && (frame.data[0] == 0xAAU));
    CHECK(taken("r0807\r", &frame) && (frame.can_id == 0x40000080U) && (frame.length == 7U));
    CHECK(taken("R000000807\r", &frame) && (frame.can_id == 0xC0000080U));
}

static void other_lines_are_no_frames(void)
{
    static const char *const LINES[] = {"\r",        "S6\r",       "O\r",       "C\r",
                                        "t08\r",     "t0801\r",    "t0801a\r",  "t0801aab\r",
                                        "t0809\r",   "t08g0\r",    "x0800\r",   "t0801g0\r",
                                        "t08018012345678901234567890\r"};
    bus_frame frame = {0U, 0U, {0U}};
    for (size_t place = 0U; place < (sizeof LINES / sizeof LINES[0]); place++) {
        CHECK(!taken(LINES[place], &frame));
    }
    CHECK(taken("t0800\r", &frame)); /* and the next one is read again */
}

int main(void)
{
    a_frame_is_the_same_there_and_back();
    flags_stand_above_the_identifier();
    other_lines_are_no_frames();
    return failed_checks;
}
