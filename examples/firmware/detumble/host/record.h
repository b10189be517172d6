/* SPDX-License-Identifier: Apache-2.0 */
/* A frame as 16 bytes, as on the loop bus: identifier 4 bytes, length 1, unused 3, data 8; little-endian. */
#ifndef RECORD_H
#define RECORD_H

#include "frame.h"

#define RECORD_BYTES 16U

/* The frame of a record; a length above 8 counts as 8. */
bus_frame record_to_frame(const uint8_t *record);

void record_of_frame(const bus_frame *frame, uint8_t *record);

/* A number of four bytes, little-endian. */
uint32_t word_from(const uint8_t *bytes);
void word_into(uint32_t word, uint8_t *bytes);

#endif
