/* SPDX-License-Identifier: Apache-2.0 */
/* The flight software in a test's hands, on a Cortex-M3: host/harness.h over semihosting, by standard input and
 * output. Each reply has before it four bytes: how many clocks the request took, by a timer that QEMU's -icount
 * drives with the count of instructions.
 */
#include "harness.h"
#include "mps2.h"
#include "record.h"
#include "startup.h"

#define SYS_OPEN 0x01U
#define SYS_WRITE 0x05U
#define SYS_READ 0x06U
#define SYS_EXIT 0x18U
#define APPLICATION_EXIT 0x20026U
#define MODE_READ 0U
#define MODE_WRITE 4U
#define CLOCKS_BYTES 4U

static uint32_t ask_host(uint32_t what, uint32_t argument)
{
    register uint32_t r0 __asm__("r0") = what;
    register uint32_t r1 __asm__("r1") = argument;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static uint32_t open_console(uint32_t mode)
{
    static const char NAME[] = ":tt";
    const uint32_t words[] = {(uint32_t)NAME, mode, 3U};
    return ask_host(SYS_OPEN, (uint32_t)words);
}

/* Bytes that are still missing: 0 when all have been transferred. */
static uint32_t transfer(uint32_t what, uint32_t handle, const uint8_t *bytes, uint32_t length)
{
    const uint32_t words[] = {handle, (uint32_t)bytes, length};
    return ask_host(what, (uint32_t)words);
}

int main(void)
{
    static uint8_t request[HARNESS_REQUEST_BYTES];
    static uint8_t reply[CLOCKS_BYTES + HARNESS_REPLY_MOST];
    const uint32_t in = open_console(MODE_READ);
    const uint32_t out = open_console(MODE_WRITE);
    TIMER0->reload = UINT32_MAX;
    TIMER0->value = UINT32_MAX;
    TIMER0->control = TIMER_ENABLE;
    for (;;) {
        uint32_t missing = HARNESS_REQUEST_BYTES;
        while (missing > 0U) {
            const uint32_t left = transfer(SYS_READ, in, &request[HARNESS_REQUEST_BYTES - missing], missing);
            if (left == missing) { /* the test has ended */
                (void)ask_host(SYS_EXIT, APPLICATION_EXIT);
            }
            missing = left;
        }
        const uint32_t began = TIMER0->value; /* it counts down */
        const uint32_t length = harness_step(request, &reply[CLOCKS_BYTES]);
        word_into(began - TIMER0->value, reply);
        (void)transfer(SYS_WRITE, out, reply, CLOCKS_BYTES + length);
    }
}
