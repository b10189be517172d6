/* SPDX-License-Identifier: Apache-2.0 */
/* The peripheral of the board mps2-an385 that the image uses: a timer. */
#ifndef MPS2_H
#define MPS2_H

#include <stdint.h>

typedef struct {
    volatile uint32_t control;
    volatile uint32_t value;
    volatile uint32_t reload;
} mps2_timer;

#define TIMER0 ((mps2_timer *)0x40000000U)
#define CLOCK_HZ 25000000U
#define TIMER_ENABLE 1U

#endif
