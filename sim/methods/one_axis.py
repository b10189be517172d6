"""Gravity gradient, Sun, drag and other help (sections 2.3, 2.4)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        "gravity gradient with damping",
        "[O19] 2.3 [52]",
        Kind.FLOWN,
        "fsw/core/laws/damping/damping.py",
        "Damping (1) makes the gravity-gradient orientation asymptotically stable.",
        ("review.one_axis.gravity_damping",),
    ),
    Method(
        "field tracking",
        "[O19] 2.3 eq. 7 [43]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/field_tracking.py",
        "For a body that the gravity gradient holds it gives turns about the vertical too.",
        ("review.one_axis.field_tracking_boom", "review.one_axis.field_tracking_microsat"),
        "A body without a boom or wheel is hardly stable with any gains, and unstable with those of PD; "
        "gains: sim/design/one_axis/field_tracking.py.",
    ),
    Method(
        "field tracking handed over to PD",
        "[O19] 2.3 eq. 7, 8 [43, 53]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/field_tracking.py",
        "From raw measurements to a rough attitude, then a more exact law takes over.",
        ("review.one_axis.hand_over",),
    ),
    Method(
        "PD with the gravity torque, damping alone while fast",
        "[O19] 2.3 eq. 8 [54]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/pd_when_slow.py",
        "Stable at a small rate; otherwise only the damping part is applied.",
        ("review.one_axis.pd_when_slow",),
    ),
    Method(
        "two coils along K (e3 x b)",
        "[O19] 2.4 [59]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/slow_spin.py",
        "One axis without the need of a fast spin.",
        ("review.one_axis.slow_spin",),
        "The printed term alone spins up without end; flown with B-dot beside it.",
    ),
    Method(
        "Sun by the currents of panels (UKube-1)",
        "[O19] 2.4 [60]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/sun_panels.py",
        "One term takes the difference of two panels away, the other turns an axis to the brightest.",
        ("review.one_axis.sun_panels",),
        "Nothing turns the axis about the difference's own line once its panel is the brightest: the Sun may "
        "stay up to 45 deg off. The damping is added.",
    ),
    Method(
        "Sun by one sensor",
        "[O19] 2.4 [61, 62]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/sun_pointing.py",
        "The momentum and the axis of most inertia turn to the Sun.",
        ("review.one_axis.sun_pointing",),
    ),
    Method(
        "Sun by critical damping",
        "[O19] 2.4 [63]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/sun_critical.py",
        "An axis is turned to the Sun; one parameter.",
        ("review.one_axis.sun_critical", "review.one_axis.sun_critical_fast"),
        "The parameter must be about an orbital rate; with four of them the projected torque does not damp.",
    ),
    Method(
        "air and field",
        "[O19] 2.4 [64]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/direction_tracking.py",
        "The air holds one axis, the law turns the field onto the expected one: three axes.",
        ("review.one_axis.aerodynamic", "review.one_axis.aerodynamic_without_air"),
        "The scan has lost the equation; taken as eq. 7 of directions.",
    ),
)
"""In the order of the review."""
