/* SPDX-License-Identifier: Apache-2.0 */
/* The peripherals of the board mps2-an385 that the images use: two UARTs, a timer, coil outputs. */
#ifndef MPS2_H
#define MPS2_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    volatile uint32_t data;
    volatile uint32_t state;
    volatile uint32_t control;
    volatile uint32_t interrupts;
    volatile uint32_t divider;
} mps2_uart;

typedef struct {
    volatile uint32_t control;
    volatile uint32_t value;
    volatile uint32_t reload;
} mps2_timer;

typedef struct {
    volatile uint32_t control;
    volatile uint32_t reload;
    volatile uint32_t value;
} cortex_systick;

#define UART0 ((mps2_uart *)0x40004000U)
#define UART1 ((mps2_uart *)0x40005000U)
#define TIMER0 ((mps2_timer *)0x40000000U)
#define SYSTICK ((cortex_systick *)0xE000E010U)
#define INTERRUPT_ENABLE (*(volatile uint32_t *)0xE000E100U)
#define COIL_OUTPUTS (*(volatile uint32_t *)0x40010004U) /* GPIO 0 */

#define CLOCK_HZ 25000000U
#define UART_TX_FULL 1U
#define UART_RX_FULL 2U
#define UART_ENABLE 3U
#define UART_RX_INTERRUPT 8U
#define UART_RX_CLEAR 2U
#define TIMER_ENABLE 1U
#define SYSTICK_ENABLE 7U /* by the processor's clock, with its interrupt */

#define interrupts_off() __asm volatile("cpsid i" ::: "memory")
#define interrupts_on() __asm volatile("cpsie i" ::: "memory")
#define wait_for_interrupt() __asm volatile("wfi")

static inline void uart_write(mps2_uart *uart, uint8_t byte)
{
    while ((uart->state & UART_TX_FULL) != 0U) {
    }
    uart->data = byte;
}

#endif
