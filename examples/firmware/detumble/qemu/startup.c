/* SPDX-License-Identifier: Apache-2.0 */
/* What a Cortex-M3 needs before main: its vectors, and memory as C expects it. */
#include "startup.h"

#include <stddef.h>

#define EXCEPTIONS 16U

extern uint32_t data_start;
extern uint32_t data_end;
extern const uint32_t data_load;
extern uint32_t bss_start;
extern uint32_t bss_end;
extern uint32_t stack_top;

typedef union {
    void (*handler)(void);
    const uint32_t *stack;
} vector;

extern const vector vectors[EXCEPTIONS];

/* A fault stops the processor: a watchdog would restart it, with a whole back-off ahead. */
static void stop(void)
{
    for (;;) {
    }
}

void reset(void)
{
    const uint32_t *from = &data_load;
    for (uint32_t *to = &data_start; to < &data_end; to++) {
        *to = *from;
        from++;
    }
    for (uint32_t *to = &bss_start; to < &bss_end; to++) {
        *to = 0U;
    }
    (void)main();
    stop();
}

__attribute__((section(".vectors"), used)) const vector vectors[EXCEPTIONS] = {
    {.stack = &stack_top}, {.handler = reset}, {.handler = stop}, {.handler = stop},
    {.handler = stop},     {.handler = stop},  {.handler = stop}, {.handler = NULL},
    {.handler = NULL},     {.handler = NULL},  {.handler = NULL}, {.handler = stop},
    {.handler = stop},     {.handler = NULL},  {.handler = stop}, {.handler = stop},
};
