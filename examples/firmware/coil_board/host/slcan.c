/* SPDX-License-Identifier: Apache-2.0 */
#include "slcan.h"

#define CARRIAGE_RETURN 0x0DU
#define EXTENDED_FLAG 0x80000000U
#define REMOTE_FLAG 0x40000000U
#define NO_DIGIT 0xFFU
#define STANDARD_DIGITS 3U
#define EXTENDED_DIGITS 8U

static uint8_t digit_of(uint8_t text)
{
    uint8_t digit = NO_DIGIT;
    if ((text >= 0x30U) && (text <= 0x39U)) { /* 0 to 9 */
        digit = (uint8_t)(text - 0x30U);
    } else if ((text >= 0x41U) && (text <= 0x46U)) { /* A to F */
        digit = (uint8_t)((text - 0x41U) + 10U);
    } else if ((text >= 0x61U) && (text <= 0x66U)) { /* a to f */
        digit = (uint8_t)((text - 0x61U) + 10U);
    } else {
        /* no digit */
    }
    return digit;
}

static uint8_t text_of(uint32_t digit)
{
    uint32_t text = 0x30U + digit;
    if (digit > 9U) { /* A stands 7 places after the one that follows 9 */
        text += 7U;
    }
    return (uint8_t)text;
}

/* A number of hexadecimal digits; false if one is none. */
static bool read_number(const slcan_line *line, uint32_t first, uint32_t digits, uint32_t *number)
{
    bool is_number = (first + digits) <= line->length;
    uint32_t read = 0U;
    for (uint32_t place = 0U; is_number && (place < digits); place++) {
        const uint8_t digit = digit_of(line->text[first + place]);
        is_number = digit != NO_DIGIT;
        read = (read << 4U) | digit;
    }
    *number = read;
    return is_number;
}

/* What a line is: its flags and the digits of its identifier, 0 if it is no frame. */
static uint32_t digits_of(uint8_t kind, uint32_t *flags)
{
    uint32_t digits = STANDARD_DIGITS;
    *flags = 0U;
    if (kind == 0x74U) { /* t */
        digits = STANDARD_DIGITS;
    } else if (kind == 0x54U) { /* T */
        digits = EXTENDED_DIGITS;
        *flags = EXTENDED_FLAG;
    } else if (kind == 0x72U) { /* r */
        *flags = REMOTE_FLAG;
    } else if (kind == 0x52U) { /* R */
        digits = EXTENDED_DIGITS;
        *flags = EXTENDED_FLAG | REMOTE_FLAG;
    } else {
        digits = 0U;
    }
    return digits;
}

static bool read_data(const slcan_line *line, uint32_t first, bus_frame *frame)
{
    bool is_data = (first + (2U * (uint32_t)frame->length)) == line->length;
    for (uint32_t place = 0U; is_data && (place < frame->length); place++) {
        uint32_t byte = 0U;
        is_data = read_number(line, first + (2U * place), 2U, &byte);
        frame->data[place] = (uint8_t)(byte & 0xFFU);
    }
    return is_data;
}

static bool read_frame(const slcan_line *line, bus_frame *frame)
{
    uint32_t flags = 0U;
    uint32_t identifier = 0U;
    uint32_t length = 0U;
    const uint32_t digits = (line->length > 0U) ? digits_of(line->text[0], &flags) : 0U;
    bool is_frame = (digits > 0U) && read_number(line, 1U, digits, &identifier);
    is_frame = is_frame && read_number(line, 1U + digits, 1U, &length);
    is_frame = is_frame && (length <= FRAME_DATA_MOST);
    frame->can_id = identifier | flags;
    frame->length = (uint8_t)(length & 0x0FU);
    if (is_frame && ((flags & REMOTE_FLAG) == 0U)) {
        is_frame = read_data(line, 2U + digits, frame);
    }
    return is_frame;
}

bool slcan_take(slcan_line *line, uint8_t byte, bus_frame *frame)
{
    bool complete = false;
    if (byte == CARRIAGE_RETURN) {
        complete = (line->length <= SLCAN_LINE_MOST) && read_frame(line, frame);
        line->length = 0U;
    } else if (line->length < SLCAN_LINE_MOST) {
        line->text[line->length] = byte;
        line->length++;
    } else {
        line->length = SLCAN_LINE_MOST + 1U;
    }
    return complete;
}

uint32_t slcan_write(const bus_frame *frame, uint8_t *bytes)
{
    uint32_t length = 5U;
    bytes[0] = 0x74U; /* t */
    bytes[1] = text_of((frame->can_id >> 8U) & 0x0FU);
    bytes[2] = text_of((frame->can_id >> 4U) & 0x0FU);
    bytes[3] = text_of(frame->can_id & 0x0FU);
    bytes[4] = text_of(frame->length);
    for (uint32_t place = 0U; place < frame->length; place++) {
        bytes[length] = text_of((uint32_t)frame->data[place] >> 4U);
        bytes[length + 1U] = text_of((uint32_t)frame->data[place] & 0x0FU);
        length += 2U;
    }
    bytes[length] = CARRIAGE_RETURN;
    return length + 1U;
}
