"""Three axes, simple feedback (section 3.1)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="PD law by its projection (`pd`)",
        source="[O19] 3.1 [68, 69], eq. 9",
        kind=Kind.FLOWN,
        where="fsw/core/laws/feedback/pd.py",
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
        name="The law by a filtered attitude, without the rate (`output_feedback`)",
        source="[O19] 3.1 [68]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/feedback/output_feedback.py",
        claim="The attitude converges without a measured rate.",
        claims=("review.feedback.output.final",),
    ),
    Method(
        "bound on the control",
        "[O19] 3.1 [70]",
        Kind.GROUND,
        "sim/design/feedback/bifurcation.py",
        "Gains need care, the control a bound: too large a step leads away; damping bears more.",
        (
            "review.feedback.pd.bound",
            "review.feedback.limit.factor",
            "review.feedback.limit.under",
            "review.feedback.limit.over",
        ),
        "A multiplier leaves at +1: a fold.",
    ),
    Method(
        "PD dipole among the stars (`pd_inertial`), gains by averaging and Floquet theory",
        "[O19] 3.1 [71]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/inertial.py, sim/design/feedback/inertial.py",
        "A simple scheme by analytical results and Floquet theory gives gains for inertial pointing.",
        ("review.feedback.inertial.pointing", "review.feedback.inertial.gravity", "review.feedback.scheme"),
        "Formula not printed in the review: the critical line of the averaged motion is derived.",
    ),
    Method(
        name="Best gains by Floquet theory, orbital frame",
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
        name="Inertia off the table",
        source="[O19] 3.1 [73]",
        kind=Kind.GROUND,
        where="sim/design/theory/robustness.py",
        claim="The law is sensitive to the inertia above all; a small error may break it.",
        claims=("review.feedback.inertia.margin",),
        remark="`torquer design` gives the margin of every body, and maps.",
    ),
    Method(
        "gains for bounds on the inertia",
        "[O19] 3.1 [74]",
        Kind.GROUND,
        "sim/design/feedback/robust.py",
        "With bounds on the moments of inertia gains can be chosen.",
        ("review.feedback.robust.broken", "review.feedback.robust.share"),
    ),
    Method(
        "minimax gains with limited coils",
        "[O19] 3.1 [75]",
        Kind.GROUND,
        "sim/design/feedback/minimax.py",
        "Gains for the least settling time from the worst start, the dipole being limited.",
        ("review.feedback.minimax",),
        "A local search over given starts, not a global one.",
    ),
    Method(
        "gains by the regulator, as flown by TANGO",
        "[O19] 3.1 [76, 77]",
        Kind.GROUND,
        "sim/design/feedback/lqr_gains.py",
        "The PD law with gains by LQR did its work aboard TANGO, with an accuracy of 10 to 20 deg.",
        ("review.feedback.tango.none", "review.feedback.tango.dipole"),
        "A residual dipole of 0.02 A m^2 about each axis, unknown to the law, gives as much; fitted.",
    ),
    Method(
        "dipole held over several steps (`pd_held`)",
        "[O19] 3.1 [78]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/held.py, sim/design/feedback/held.py",
        "A dipole that is constant over a control interval stabilises with gains chosen for the interval.",
        ("review.feedback.held.long", "review.feedback.held.too_long", "review.feedback.hold"),
    ),
    Method(
        name="Gains for the pulses of the flight software",
        source="[O19] 3.1 [78, 79]",
        kind=Kind.GROUND,
        where="sim/design/theory/pulsed.py",
        claim=(
            "The law works held over an interval, and measured before it acts; short intervals, or "
            "pulses of their own gains."
        ),
        claims=("review.feedback.pulses.degree",),
        remark=(
            "The pulses of the flight software, magnetometer and coils apart in time; their degree of "
            "stability is `torquer design`'s."
        ),
    ),
    Method(
        "measuring and acting apart (`pd_apart`)",
        "[O19] 3.1 [79]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/held.py",
        "The same holds where intervals of measuring are as long as those of acting.",
        ("review.feedback.held.apart",),
    ),
    Method(
        "delayed output feedback",
        "[O19] 3.1 [80]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/delayed.py",
        "Three axes by attitude and delayed attitude.",
        ("review.feedback.delayed",),
        "Equation not found (searched: pages, documentation); the mean rate over the delay is derived.",
    ),
    Method(
        name="Projection weighted by axes (`pd_weighted`)",
        source="[O19] 3.1 [81]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/feedback/projection.py",
        claim=("A weight on the axis of small moment points it far better at some cost of the others."),
        claims=(
            "review.feedback.weighted.gain",
            "review.feedback.weighted.cost",
        ),
    ),
    Method(
        name="Regularised inverse (`pd_regularised`)",
        source="[O19] 3.1 [82, 83]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/feedback/projection.py",
        claim=(
            "A small addition makes the matrix of the cross product regular; the law stays that of "
            "the projection."
        ),
        claims=("review.feedback.regularised.final",),
    ),
    Method(
        "error of the field's direction",
        "[O19] 3.1 [84]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/field_direction.py",
        "PD on e = t - n, t the direction in body axes that is to lie along the field.",
        ("review.feedback.direction.attitude",),
        "The scan loses the torque; derived. Three axes need a wheel or a firm gravity gradient.",
    ),
    Method(
        "sphere, no rate (`sphere_output`)",
        "[O19] 3.1 [85, 86]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/sphere.py",
        "For a sphere, feedback without data of the rate.",
        ("review.feedback.sphere.output",),
        "Equation not found (searched: pages, documentation); an observer of a sphere's motion is derived.",
    ),
    Method(
        "sphere to the local vertical (`sphere_vertical`)",
        "[O19] 3.1 [87]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/sphere.py",
        "For a sphere, an intuitive law to the local vertical.",
        ("review.feedback.sphere.vertical",),
        "Equation not found; derived from a Lyapunov function.",
    ),
    Method(
        "sphere to the field",
        "[O19] 3.1 [88]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/field_direction.py",
        "For a sphere, an intuitive law to the geomagnetic field.",
        ("review.feedback.direction.needle",),
        "The axis lags by some degrees, as the field turns.",
    ),
    Method(
        "two turns about the field",
        "[O19] 3.1 [89]",
        Kind.FLOWN,
        "fsw/core/laws/feedback/two_step.py",
        "Near the magnetic equator three axes by two simple turns, for a sphere.",
        (
            "review.feedback.two_step.equator",
            "review.feedback.two_step.plain",
            "review.feedback.two_step.inclined",
        ),
        "Split derived. At 5 deg inclination the field turns too far between the turns, and it fails.",
    ),
    Method(
        name="Shortest dipole for an energy law",
        source="[T] eq. 5, Wisniewski 1997",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping/damping.py",
        claim="m = h Omega x b damps libration as the predictive law does.",
        claims=(
            "posat1.energy_law",
            "posat1.dissipation",
        ),
    ),
)
