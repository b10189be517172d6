"""Three axes, simple feedback (section 3.1 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="PD law, projected (`pd`)",
        source="[O19] 3.1 eq. 9 [68, 69]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd.py",
        claim=(
            "With small enough gains the nominal attitude is asymptotically stable, though the "
            "projection is not the Lyapunov law."
        ),
        claims=(
            "exponents",
            "review.feedback.pd.final",
        ),
    ),
    Method(
        name="filtered attitude in place of the rate (`output_feedback`)",
        source="[O19] 3.1 [68]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/output_feedback.py",
        claim="The attitude converges without a measured rate.",
        claims=("review.feedback.output.final",),
    ),
    Method(
        name="bound on the control",
        source="[O19] 3.1 [70]",
        kind=Kind.GROUND,
        where="sim/design/feedback/bifurcation.py",
        claim=(
            "Too large an attitude gain leads away from the nominal attitude, so that the control needs "
            "a bound; damping alone does not."
        ),
        claims=(
            "review.feedback.pd.bound",
            "review.feedback.limit.factor",
            "review.feedback.limit.under",
            "review.feedback.limit.over",
        ),
        remark="A multiplier leaves the unit circle at +1: a fold.",
    ),
    Method(
        name="inertial PD law, gains by averaging and Floquet theory (`pd_inertial`)",
        source="[O19] 3.1 [71]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_inertial.py, sim/design/feedback/inertial.py",
        claim="A simple scheme by analytical results and Floquet theory gives gains for inertial pointing.",
        claims=(
            "review.feedback.inertial.pointing",
            "review.feedback.inertial.gravity",
            "review.feedback.scheme",
        ),
        remark="The review prints no formula: the critical line of the averaged motion is derived.",
    ),
    Method(
        name="best gains by Floquet theory, orbital frame",
        source="[O19] 3.1 [72]",
        kind=Kind.GROUND,
        where="sim/design/theory/floquet.py",
        claim=(
            "The multipliers of the linear periodic motion give the gains with the least degree of stability."
        ),
        claims=(
            "linearisation",
            "exponents",
            "best_gains.50_kg",
            "reference.floquet.degree",
        ),
    ),
    Method(
        name="inertia that differs from the table",
        source="[O19] 3.1 [73]",
        kind=Kind.GROUND,
        where="sim/design/theory/robustness.py",
        claim="The law is sensitive above all to errors of the inertia; a small one may make it unstable.",
        claims=("review.feedback.inertia.margin",),
        remark="`torquer design` gives the margin of every body, and maps.",
    ),
    Method(
        name="gains for bounds on the inertia",
        source="[O19] 3.1 [74]",
        kind=Kind.GROUND,
        where="sim/design/feedback/robust.py",
        claim="With bounds on the moments of inertia gains can be chosen.",
        claims=(
            "review.feedback.robust.broken",
            "review.feedback.robust.share",
        ),
    ),
    Method(
        name="minimax gains with limited coils",
        source="[O19] 3.1 [75]",
        kind=Kind.GROUND,
        where="sim/design/feedback/minimax.py",
        claim="Gains for the least settling time from the worst start, the dipole being limited.",
        claims=("review.feedback.minimax",),
        remark="A local search over given starts, not a global one.",
    ),
    Method(
        name="gains by the regulator, as flown by TANGO",
        source="[O19] 3.1 [76, 77]",
        kind=Kind.GROUND,
        where="sim/design/feedback/lqr_gains.py",
        claim="The PD law with gains by LQR did its work aboard TANGO, with an accuracy of 10 to 20 deg.",
        claims=(
            "review.feedback.tango.none",
            "review.feedback.tango.dipole",
        ),
        remark=(
            "A residual dipole of 0.02 A m^2 along each axis, unknown to the law, gives as much; the "
            "dipole is fitted."
        ),
    ),
    Method(
        name="dipole held over several steps (`pd_held`)",
        source="[O19] 3.1 [78]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_held.py, sim/design/feedback/held.py",
        claim=(
            "A dipole that is constant over a control interval stabilises with gains chosen for the interval."
        ),
        claims=(
            "review.feedback.held.long",
            "review.feedback.held.too_long",
            "review.feedback.hold",
        ),
    ),
    Method(
        name="gains for the pulses of the flight software",
        source="[O19] 3.1 [78, 79]",
        kind=Kind.GROUND,
        where="sim/design/theory/pulsed.py",
        claim=(
            "The law works when its dipole is held over an interval, and when measuring and acting "
            "alternate; long intervals need gains of their own."
        ),
        claims=("review.feedback.pulses.degree",),
        remark=(
            "The pulses of the flight software, magnetometer and coils apart in time; their degree of "
            "stability is `torquer design`'s."
        ),
    ),
    Method(
        name="measuring and acting apart (`pd_apart`)",
        source="[O19] 3.1 [79]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_held.py",
        claim="The same holds where intervals of measuring are as long as those of acting.",
        claims=("review.feedback.held.apart",),
    ),
    Method(
        name="delayed output feedback (`pd_delayed`)",
        source="[O19] 3.1 [80]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_delayed.py",
        claim="The attitude and the delayed attitude hold three axes.",
        claims=("review.feedback.delayed", "review.feedback.delayed.pd"),
        remark=(
            "Equation not found (searched: pages, documentation); the mean rate over the delay is derived."
        ),
    ),
    Method(
        name="projection weighted by axes (`pd_weighted`)",
        source="[O19] 3.1 [81]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/projection.py",
        claim="A weight on the axis of small moment points it far better at some cost of the others.",
        claims=(
            "review.feedback.weighted.gain",
            "review.feedback.weighted.cost",
        ),
    ),
    Method(
        name="regularised inverse (`pd_regularised`)",
        source="[O19] 3.1 [82, 83]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/projection.py",
        claim=(
            "A small addition makes the matrix of the cross product regular; the law stays that of the "
            "projection."
        ),
        claims=("review.feedback.regularised.final",),
    ),
    Method(
        name="error of the field's direction (`field_direction`)",
        source="[O19] 3.1 [84]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/field_direction.py",
        claim="PD on e = t - n, t the direction in body axes that is to lie along the field.",
        claims=("review.feedback.direction.attitude",),
        remark="The scan loses the torque; derived. Three axes need a wheel or a firm gravity gradient.",
    ),
    Method(
        name="sphere without a measured rate (`sphere_output`)",
        source="[O19] 3.1 [85, 86]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sphere.py",
        claim="A sphere is held by feedback without a measured rate.",
        claims=("review.feedback.sphere.output", "review.feedback.sphere.pd"),
        remark=(
            "Equation not found (searched: pages, documentation); an observer of a sphere's motion is "
            "derived."
        ),
    ),
    Method(
        name="sphere to the local vertical (`sphere_vertical`)",
        source="[O19] 3.1 [87]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sphere.py",
        claim="An intuitive law turns an axis of a sphere to the local vertical.",
        claims=("review.feedback.sphere.vertical",),
        remark="Equation not found; derived from a Lyapunov function.",
    ),
    Method(
        name="sphere to the field (`field_direction`)",
        source="[O19] 3.1 [88]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/field_direction.py",
        claim="An intuitive law turns an axis of a sphere to the geomagnetic field.",
        claims=("review.feedback.direction.axis",),
        remark="The axis lags by some degrees, as the field turns.",
    ),
    Method(
        name="two turns across the field (`two_step`)",
        source="[O19] 3.1 [89]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/two_step.py",
        claim="Near the magnetic equator two simple turns bring a sphere to any attitude.",
        claims=(
            "review.feedback.two_step.equator",
            "review.feedback.two_step.pd",
            "review.feedback.two_step.inclined",
        ),
        remark="Split derived. At 5 deg inclination the field turns too far between the turns, and it fails.",
    ),
    Method(
        name="shortest dipole for an energy law (`rate_damping`)",
        source="[T] eq. 5, Wisniewski 1997",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping.py",
        claim="The dipole m = h Omega x b damps libration as the predictive law does.",
        claims=(
            "posat1.energy_law",
            "posat1.dissipation",
        ),
    ),
)
"""In the order of the review."""
