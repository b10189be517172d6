/* SPDX-License-Identifier: Apache-2.0 */
/* Frames as lines of text, by the slcan protocol of serial CAN adapters: t0808... and a carriage return.
 *
 * The board answers as an adapter does whose commands (bit rate, open, close) have nothing to set.
 */
#ifndef SLCAN_H
#define SLCAN_H

#include "frame.h"

/* The longest line, of an extended frame with 8 bytes, and the carriage return. */
#define SLCAN_LINE_MOST 27U

/* What has come of a line. */
typedef struct {
    uint8_t text[SLCAN_LINE_MOST];
    uint32_t length; /* beyond SLCAN_LINE_MOST the line is too long, and no frame */
} slcan_line;

/* Take a byte; true when it completes a frame. */
bool slcan_take(slcan_line *line, uint8_t byte, bus_frame *frame);

/* Write the line of a frame without flags: how many bytes it has. */
uint32_t slcan_write(const bus_frame *frame, uint8_t *bytes);

#endif
