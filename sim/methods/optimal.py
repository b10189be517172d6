"""Three axes, optimal control of a linear model (section 3.2)."""

from sim.methods.method import Kind, Method

LAWS = "fsw/core/laws/optimal"
ROBUST = "sim/design/robust"

METHODS: tuple[Method, ...] = (
    Method(
        "Periodic H2 control of a satellite with a wheel",
        "[O19] 2.2 [48]",
        Kind.FLOWN,
        f"{LAWS}/h_infinity.py",
        "Least H2 norm by a periodic gain, the body turning quickly about the wheel's axis.",
        ("review.optimal.norms.wheel.h2",),
        "with the whole state known the H2 gain is that of lqr; the norms are computed for both",
    ),
    Method(
        "Periodic H-infinity control of a satellite with a wheel",
        "[O19] 2.2 [49, 50]",
        Kind.FLOWN,
        f"{LAWS}/h_infinity.py",
        "Least answer to the worst torque by a periodic gain.",
        ("review.optimal.norms.wheel.h_infinity",),
    ),
    Method(
        "Least-squares realisable torque within the coils' limits",
        "[O19] 3.2 [97]",
        Kind.FLOWN,
        f"{LAWS}/boxed.py",
        "Better than the plain projection.",
        ("review.optimal.boxed",),
        "nearer to the torque by some percent where a limit is met; a flight is no quicker (test_boxed.py)",
    ),
    Method(
        name="Periodic linear quadratic regulator (`lqr`)",
        source="[O19] 3.2 [98]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/optimal/lqr.py",
        claim=(
            "It copes with disturbances and with an inertia that is off; it costs less than feedback "
            "with fixed gains."
        ),
        claims=("review.optimal.lqr.cost",),
    ),
    Method(
        "Asymptotic periodic regulator: one cost matrix and the measured field (`lqr_averaged`)",
        "[O19] 3.2 [98]",
        Kind.FLOWN,
        f"{LAWS}/averaged.py",
        "It copes with disturbances and with an inertia that is off.",
        ("review.optimal.averaged.inertia", "review.optimal.averaged.torque"),
        "from 19 deg it is slower than the periodic one, and under a torque it points a half worse",
    ),
    Method(
        "Disturbance as periodic functions that are learned (`lqr_disturbed`)",
        "[O19] 3.2 [99]",
        Kind.FLOWN,
        f"{LAWS}/disturbed.py",
        "External disturbances are approximated by periodic functions.",
        ("review.optimal.disturbed.rms", "review.optimal.disturbed.gain"),
    ),
    Method(
        "Periodic LQR solved by one invariant subspace",
        "[O19] 3.2 [100]",
        Kind.GROUND,
        f"{ROBUST}/invariant.py",
        "The periodic Riccati equation by one inverse of A and one Schur form.",
        ("review.optimal.riccati",),
        "loses its digits where effort is cheap, which is checked and refused",
    ),
    Method(
        "State-dependent Riccati equation (`sdre`)",
        "[O19] 3.2 [101]",
        Kind.FLOWN,
        f"{LAWS}/sdre.py",
        "The regulator is extended to the nonlinear motion.",
        ("review.optimal.sdre.cost",),
        "it pays far from the goal; near it, it is the regulator",
    ),
    Method(
        "H2 control of three axes",
        "[O19] 3.2 [104]",
        Kind.FLOWN,
        f"{LAWS}/field_only.py",
        "Periodic filter and regulator hold the attitude by the magnetometer alone.",
        ("review.optimal.norms.three_axis.h2",),
    ),
    Method(
        "H-infinity gains of the law (9)",
        "[O19] 3.2 [105]",
        Kind.GROUND,
        f"{ROBUST}/pd_gains.py",
        "Gains with the least answer to the worst torque.",
        ("review.optimal.pd_h_infinity",),
    ),
    Method(
        "H-infinity control of a discrete system with models of measurement and disturbance",
        "[O19] 3.2 [106]",
        Kind.GROUND,
        f"{ROBUST}/measured.py",
        "The worst of torque and error of the measured field is borne best.",
        ("review.optimal.measured.h_infinity", "review.optimal.measured.bound"),
        "only the method is named; the equations are those of the game with a delayed measurement",
    ),
    Method(
        "Slew of least time with a penalty on the final error",
        "[O19] 3.2 [107]",
        Kind.GROUND,
        "sim/design/predictive/time_optimal.py",
        "The course of least time is found on the ground and followed by prediction.",
        ("review.predictive.slew.time", "review.predictive.slew.copy"),
        "its dipoles are nearly always at their limits; copied without a look at the attitude, an error of "
        "the moments spoils the end",
    ),
    Method(
        "Error of two directions averaged over orbits, with a rate error like B-dot",
        "[O19] 3.2 [102, 103]",
        Kind.GROUND,
        "sim/design/feedback/averaged_error.py",
        "The field turns, so that a body is controlled on the mean; gains by an evolutionary search.",
        (
            "review.feedback.averaged.orbits",
            "review.feedback.averaged.equator",
            "review.feedback.averaged.cost",
        ),
        "on a polar orbit it holds, over the equator no gains do; the error itself is brought down sooner",
    ),
)
