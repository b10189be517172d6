/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STARTUP_H
#define STARTUP_H

#include <stdint.h>

/* Where the processor begins. */
void reset(void);

/* The interrupts that an image may take: every millisecond, and when UART 0 has received a byte. */
void on_systick(void);
void on_uart0_rx(void);

int main(void);

#endif
