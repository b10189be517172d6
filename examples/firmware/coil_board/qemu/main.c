/* SPDX-License-Identifier: Apache-2.0 */
/* The coil board on a Cortex-M3: slcan on UART 0, each change of the coil outputs as a line on UART 1.
 *
 * A timer that runs freely is the board's own clock. An interrupt every millisecond ends a pulse by it: that needs
 * no tick, no frame, no bus and no turn of the loop below. The coils draw their nominal current at once.
 */
#include "coil_board.h"
#include "coil_limits.h"
#include "mps2.h"
#include "slcan.h"
#include "startup.h"

#define INBOX_BYTES 4096U /* a power of 2 */
#define LOG_ENTRIES 64U   /* a power of 2 */
#define CLOCKS_PER_MS (CLOCK_HZ / 1000U)

/* A change of the outputs. */
typedef struct {
    uint32_t at_ms;
    coil_drive drive;
} output_change;

static coil_board board;
static outbox sent;

static volatile uint32_t clock_ms;
static uint32_t clock_count;
static uint32_t clock_rest;

static volatile uint8_t inbox[INBOX_BYTES];
static volatile uint32_t inbox_written;
static uint32_t inbox_read;

static coil_drive output;
static output_change changes[LOG_ENTRIES];
static uint32_t changes_written;
static uint32_t changes_read;

/* The timer has counted down: how many whole milliseconds. With interrupts off. */
static void run_clock(void)
{
    const uint32_t count = TIMER0->value;
    const uint32_t clocks = (clock_count - count) + clock_rest;
    clock_count = count;
    clock_ms += clocks / CLOCKS_PER_MS;
    clock_rest = clocks % CLOCKS_PER_MS;
}

/* Put a drive on the outputs, four bits a coil, the level. With interrupts off.
 *
 * One whose time is over is off: the interrupt may have ended it since the board was asked.
 */
static void switch_output(coil_drive asked)
{
    static const coil_drive OFF = {0U, 0, 0U};
    const bool over = (asked.level == 0) || ((clock_ms - asked.until_ms) < 0x80000000U);
    const coil_drive drive = over ? OFF : asked;
    COIL_OUTPUTS = over ? 0U : ((uint32_t)(drive.level & 0x0F) << (4U * drive.coil));
    if ((drive.level != output.level) || (drive.coil != output.coil) || (drive.until_ms != output.until_ms)) {
        changes[changes_written % LOG_ENTRIES].at_ms = clock_ms;
        changes[changes_written % LOG_ENTRIES].drive = drive;
        changes_written++;
    }
    output = drive;
}

void on_systick(void)
{
    run_clock();
    switch_output(output);
}

void on_uart0_rx(void)
{
    UART0->interrupts = UART_RX_CLEAR;
    while ((UART0->state & UART_RX_FULL) != 0U) {
        inbox[inbox_written % INBOX_BYTES] = (uint8_t)(UART0->data & 0xFFU);
        inbox_written++;
    }
}

static uint32_t now_ms(void)
{
    interrupts_off();
    run_clock();
    const uint32_t now = clock_ms;
    interrupts_on();
    return now;
}

/* What the coils draw: the nominal current of what is on. */
static int32_t current_ma(void)
{
    static const int32_t NOMINAL_MA[] = {0, LIMITS_LEVEL_1_MA, LIMITS_LEVEL_2_MA, LIMITS_LEVEL_3_MA};
    const int32_t level = output.level;
    return (level < 0) ? -NOMINAL_MA[-level] : NOMINAL_MA[level];
}

static void write_number(uint32_t number)
{
    uint8_t digits[10];
    uint32_t count = 0U;
    uint32_t left = number;
    do {
        digits[count] = (uint8_t)('0' + (left % 10U));
        left /= 10U;
        count++;
    } while (left != 0U);
    while (count > 0U) {
        count--;
        uart_write(UART1, digits[count]);
    }
}

static void write_text(const char *text)
{
    for (const char *letter = text; *letter != '\0'; letter++) {
        uart_write(UART1, (uint8_t)*letter);
    }
}

/* A line of the log, in the form of torquer board coil --pins. */
static void write_change(const output_change *change)
{
    write_number(change->at_ms);
    if (change->drive.level == 0) {
        write_text(" off");
    } else {
        write_text(" on ");
        write_number(change->drive.coil);
        write_text((change->drive.level < 0) ? " -" : " ");
        write_number((uint32_t)((change->drive.level < 0) ? -change->drive.level : change->drive.level));
        write_text(" until ");
        write_number(change->drive.until_ms);
    }
    write_text("\n");
}

static void show_changes(void)
{
    while (changes_read != changes_written) {
        write_change(&changes[changes_read % LOG_ENTRIES]);
        changes_read++;
    }
}

static void send_outbox(void)
{
    for (uint32_t place = 0U; place < sent.count; place++) {
        uint8_t bytes[SLCAN_LINE_MOST];
        const uint32_t length = slcan_write(&sent.frames[place], bytes);
        for (uint32_t byte = 0U; byte < length; byte++) {
            uart_write(UART0, bytes[byte]);
        }
    }
    sent.count = 0U;
}

static void drive_coils(void)
{
    const coil_drive drive = coil_board_drive(&board);
    interrupts_off();
    run_clock();
    switch_output(drive);
    interrupts_on();
}

static void take_byte(uint8_t byte)
{
    static slcan_line line;
    bus_frame frame = {0U, 0U, {0U}};
    if (slcan_take(&line, byte, &frame)) {
        coil_board_receive(&board, &frame, now_ms(), current_ma(), &sent);
        drive_coils();
        send_outbox();
    }
}

/* Sleep until something happens, unless it has already. */
static void rest(void)
{
    interrupts_off();
    if (inbox_read == inbox_written) {
        wait_for_interrupt();
    }
    interrupts_on();
}

int main(void)
{
    TIMER0->reload = UINT32_MAX;
    TIMER0->value = UINT32_MAX;
    TIMER0->control = TIMER_ENABLE;
    clock_count = UINT32_MAX;
    UART0->divider = 16U;
    UART0->control = UART_ENABLE | UART_RX_INTERRUPT;
    UART1->divider = 16U;
    UART1->control = UART_ENABLE;
    SYSTICK->reload = CLOCKS_PER_MS - 1U;
    SYSTICK->value = 0U;
    SYSTICK->control = SYSTICK_ENABLE;
    INTERRUPT_ENABLE = 1U; /* number 0: UART 0 has received */
    coil_board_switch_on(&board, 0U, now_ms(), 0, &sent);
    send_outbox();
    write_text("0 off\n");
    for (;;) {
        while (inbox_read != inbox_written) {
            take_byte(inbox[inbox_read % INBOX_BYTES]);
            inbox_read++;
        }
        coil_board_pass_time(&board, now_ms());
        drive_coils();
        show_changes();
        rest();
    }
}
