/* SPDX-License-Identifier: Apache-2.0 */
/* The guard of the coils: two interlocks, one by the ticks of the bus, one by the board's own clock.
 *
 * Invariant, whatever is requested and however often the board restarts: no pulse lasts longer than
 * LIMITS_PULSE_MS, none starts earlier than LIMITS_BACKOFF_MS after the end of the one before it (of any
 * coil, or of the same), no more than one coil is on, and every level is one of -3 to 3.
 *
 * Ticks come over the bus, which cannot be trusted. So a pulse is over when the first of the two says so, a
 * back-off when the last does, and a request is accepted only if both accept it.
 *
 * Time is counted in units of 1 / (1000 LIMITS_TICK_HZ) s: a tick is 1000 units and a millisecond is
 * LIMITS_TICK_HZ units, so that every duration is exact at every tick rate. All timers run down to 0.
 */
#ifndef GUARD_H
#define GUARD_H

#include "messages.h"

#define COILS 3U

/* The timers of one interlock [units]. */
typedef struct {
    uint32_t remaining; /* rest of the pulse; a coil is on exactly while this is not 0 */
    uint32_t lockout[COILS];
} interlock;

typedef struct {
    interlock by_ticks;
    interlock by_clock;
    uint32_t clock_ms;   /* the last reading of the board's own clock */
    uint8_t coil;        /* that is on, or was on last */
    int8_t level;        /* driven in the tick that has ended, or just accepted; otherwise 0 */
    int8_t pulse_level;  /* of the coil that is on, or was on last */
    bool has_seq;        /* a request has been accepted since boot */
    uint8_t seq;         /* of the last accepted request */
    bool driven;         /* a coil was on at some instant since the last tick */
    bool tick_under_way; /* the last tick was entered, and its SYNC is still to come */
    bool silent;         /* no SYNC has come since the dead-man woke */
} guard;

/* Off with a full lockout: a restart costs a whole back-off, as no timer survives it. */
void guard_boot(guard *state, uint32_t clock_ms);

/* The board's own clock reads clock_ms, modulo 2^32. Returns how much it has advanced; one that runs back is
 * ignored. To be called before every other function, and at least every 2^31 ms. */
uint32_t guard_pass_time(guard *state, uint32_t clock_ms);

/* The next tick is entered; its SYNC is still to come. */
void guard_tick(guard *state);

/* The SYNC of this tick: the one before is over. */
void guard_sync(guard *state);

/* No SYNC for too long: off and locked out in full, and until the next SYNC in any case. */
void guard_silence(guard *state);

/* Judge a request at a tick and carry it out if it is NOT_REFUSED. A refused one changes nothing. */
refusal_reason guard_ask(guard *state, const fire_request *request, uint32_t tick);

/* Whether a coil is on at the instant of this tick, as the status reports it. */
bool guard_is_on(const guard *state);

/* Whether a coil is on now, and when its own timer ends that at the latest, by the board's clock [ms]. */
bool guard_drives(const guard *state);
uint32_t guard_ends_ms(const guard *state);

/* Rest of the pulse; time until a coil may be fired again, in steps of 10 ms. Both are rounded up. */
uint32_t guard_remaining_ms(const guard *state);
uint32_t guard_lockout_ms(const guard *state, uint32_t coil);

/* Whether the back-off of any coil runs, or the dead-man holds all. */
bool guard_is_locked_out(const guard *state);

#endif
