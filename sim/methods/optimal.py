"""Three axes, optimal control of a linear model (sections 2.2 and 3.2 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="periodic H2 control of a satellite with a wheel (`h_infinity`)",
        source="[O19] 2.2 [48]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/h_infinity.py",
        claim="Least H2 norm by a periodic gain, the body turning quickly about the wheel's axis.",
        claims=("review.optimal.norms.wheel.h2",),
        remark="With the whole state known the H2 gain is that of `lqr`; the norms are computed for both.",
    ),
    Method(
        name="periodic H-infinity control of a satellite with a wheel (`h_infinity`)",
        source="[O19] 2.2 [49, 50]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/h_infinity.py",
        claim="Least answer to the worst torque by a periodic gain.",
        claims=("review.optimal.norms.wheel.h_infinity",),
    ),
    Method(
        name="least-squares realisable torque within the coils' limits (`pd_boxed`)",
        source="[O19] 3.2 [97]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_boxed.py",
        claim="Better than the projection cut to the limits.",
        claims=("review.optimal.boxed",),
        remark=(
            "Nearer to the torque by some percent where a limit is met; a flight is no quicker "
            "(`test_boxed.py`)."
        ),
    ),
    Method(
        name="periodic linear-quadratic regulator (`lqr`)",
        source="[O19] 3.2 [98]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/lqr.py",
        claim=(
            "It copes with disturbances and with an inertia that is off; it costs less than feedback "
            "with fixed gains."
        ),
        claims=("review.optimal.lqr.cost",),
    ),
    Method(
        name="asymptotic periodic regulator: one cost matrix and the measured field (`lqr_averaged`)",
        source="[O19] 3.2 [98]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/lqr_averaged.py",
        claim="It copes with disturbances and with an inertia that is off.",
        claims=(
            "review.optimal.averaged.inertia",
            "review.optimal.averaged.torque",
        ),
        remark=(
            "From 19 deg it is slower than the periodic one, and under a torque its error is half as "
            "large again."
        ),
    ),
    Method(
        name="disturbance as periodic functions that are learned (`lqr_disturbed`)",
        source="[O19] 3.2 [99]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/lqr_disturbed.py",
        claim="External disturbances are approximated by periodic functions.",
        claims=(
            "review.optimal.disturbed.rms",
            "review.optimal.disturbed.gain",
            "review.optimal.disturbed.twice",
        ),
    ),
    Method(
        name="periodic LQR solved by one invariant subspace",
        source="[O19] 3.2 [100]",
        kind=Kind.GROUND,
        where="sim/design/robust/invariant.py",
        claim="The periodic Riccati equation by one inverse of A and one Schur form.",
        claims=("review.optimal.riccati",),
        remark="It loses its digits where effort is cheap, which is checked and refused.",
    ),
    Method(
        name="state-dependent Riccati equation (`sdre`)",
        source="[O19] 3.2 [101]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sdre.py",
        claim="The regulator is extended to the nonlinear motion.",
        claims=("review.optimal.sdre.cost",),
        remark="It pays far from the goal; near it, it is the periodic regulator.",
    ),
    Method(
        name="H2 control of three axes (`lqg_field`)",
        source="[O19] 3.2 [104]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/lqg_field.py",
        claim="Periodic filter and regulator hold the attitude by the magnetometer alone.",
        claims=("review.optimal.norms.three_axis.h2",),
    ),
    Method(
        name="H-infinity gains of the PD law",
        source="[O19] 3.2 [105]",
        kind=Kind.GROUND,
        where="sim/design/robust/pd_gains.py",
        claim="Gains with the least answer to the worst torque.",
        claims=("review.optimal.pd_h_infinity",),
    ),
    Method(
        name="H-infinity control of a discrete system with models of measurement and disturbance",
        source="[O19] 3.2 [106]",
        kind=Kind.GROUND,
        where="sim/design/robust/measured.py",
        claim="The worst of torque and error of the measured field is borne best.",
        claims=(
            "review.optimal.measured.h_infinity",
            "review.optimal.measured.bound",
        ),
        remark=(
            "The review names only the method; the equations are those of the game with a delayed "
            "measurement."
        ),
    ),
    Method(
        name="slew of least time with a penalty on the final error",
        source="[O19] 3.2 [107]",
        kind=Kind.GROUND,
        where="sim/design/predictive/time_optimal.py",
        claim="The course of least time is found on the ground and followed by prediction.",
        claims=(
            "review.predictive.slew.time",
            "review.predictive.slew.copy",
        ),
        remark=(
            "Its dipoles are nearly always at their limits; flown open loop it misses the end if the "
            "moments are off."
        ),
    ),
    Method(
        name="error of two directions averaged over orbits, with a rate error like B-dot",
        source="[O19] 3.2 [102, 103]",
        kind=Kind.GROUND,
        where="sim/design/feedback/averaged_error.py",
        claim="The field turns, so that a body is controlled on the mean; gains by an evolutionary search.",
        claims=(
            "review.feedback.averaged.orbits",
            "review.feedback.averaged.equator",
            "review.feedback.averaged.cost",
        ),
        remark=(
            "True in the orbit of the 50 kg satellite; over the equator no gains do. Feedback of the error "
            "itself is faster."
        ),
    ),
)
"""In the order of the review."""
