"""Gravity gradient, Sun, drag and other help (sections 2.3 and 2.4 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="gravity gradient with damping (`rate_damping`)",
        source="[O19] 2.3 [52]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping.py",
        claim="Rate damping, eq. 1, makes the gravity-gradient orientation asymptotically stable.",
        claims=("review.one_axis.gravity_damping",),
    ),
    Method(
        name="field tracking (`field_tracking`)",
        source="[O19] 2.3 eq. 7 [43]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/field_tracking.py",
        claim="For a body that the gravity gradient holds it gives turns about the vertical too.",
        claims=(
            "review.one_axis.field_tracking_boom",
            "review.one_axis.field_tracking_microsat",
        ),
        remark=(
            "A body without a boom or wheel is hardly stable with any gains, and unstable with those of "
            "PD; gains: sim/design/one_axis/field_tracking.py."
        ),
    ),
    Method(
        name="field tracking handed over to PD (`field_tracking_pd`)",
        source="[O19] 2.3 eq. 7, 8 [43, 53]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/field_tracking.py",
        claim="From raw measurements to a rough attitude, then a more exact law takes over.",
        claims=("review.one_axis.hand_over",),
    ),
    Method(
        name="PD with the gravity torque, damping alone while fast (`pd_when_slow`)",
        source="[O19] 2.3 eq. 8 [54]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_when_slow.py",
        claim="Stable at a small rate; otherwise only the damping part is applied.",
        claims=("review.one_axis.pd_when_slow",),
    ),
    Method(
        name="torque shared between coils and thrusters",
        source="[O19] 2.4 [55]",
        kind=Kind.GROUND,
        where="sim/design/allocation/thrusters.py",
        claim="Even with thrusters the torque along the field may not be had; the sharing is optimisation.",
        claims=(
            "review.one_axis.thrusters",
            "review.one_axis.thrusters_normal",
            "review.one_axis.thrusters_radial",
        ),
        remark=(
            "The review gives no equation; a linear programme for least propellant. Of one pair the place "
            "decides: on a polar orbit the field has hardly a component along the normal."
        ),
    ),
    Method(
        name="two coils along K (e3 x b) (`slow_spin`)",
        source="[O19] 2.4 [59]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/slow_spin.py",
        claim="One axis without the need of a fast spin.",
        claims=("review.one_axis.slow_spin",),
        remark="The printed term alone spins up without end; flown with B-dot beside it.",
    ),
    Method(
        name="Sun by the currents of panels, as on UKube-1 (`sun_panels`)",
        source="[O19] 2.4 [60]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sun_panels.py",
        claim="One term takes the difference of two panels away, the other turns an axis to the brightest.",
        claims=("review.one_axis.sun_panels",),
        remark=(
            "Nothing turns the axis about the difference's own line once its panel is the brightest: the "
            "Sun may stay up to 45 deg off. The damping is added."
        ),
    ),
    Method(
        name="Sun by one sensor (`sun_pointing`)",
        source="[O19] 2.4 [61, 62]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sun_pointing.py",
        claim="The momentum and the axis of most inertia turn to the Sun.",
        claims=("review.one_axis.sun_pointing",),
    ),
    Method(
        name="Sun by critical damping (`sun_critical`)",
        source="[O19] 2.4 [63]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sun_critical.py",
        claim="An axis is turned to the Sun; one parameter.",
        claims=(
            "review.one_axis.sun_critical",
            "review.one_axis.sun_critical_free",
            "review.one_axis.sun_critical_fast",
        ),
        remark=(
            "The parameter must be about an orbital rate; with four of them the projected torque does "
            "not damp."
        ),
    ),
    Method(
        name="air and field (`direction_tracking`)",
        source="[O19] 2.4 [64]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/direction_tracking.py",
        claim="The air holds one axis, the law turns the field onto the expected one: three axes.",
        claims=(
            "review.one_axis.aerodynamic",
            "review.one_axis.aerodynamic_without_air",
        ),
        remark="The scan has lost the equation; taken as eq. 7 of directions.",
    ),
    Method(
        name="Lorentz force on a charged body",
        source="[O19] 2.4 [65]",
        kind=Kind.FLOWN,
        where="sim/effects/lorentz.py",
        claim="Used beside a magnetic system.",
        claims=(
            "review.one_axis.lorentz",
            "review.one_axis.lorentz_polar",
        ),
        remark=(
            "An effect of the plant. It reaches the axis along the field, but where that is along the "
            "velocity."
        ),
    ),
    Method(
        name="solar pressure",
        source="[O19] 2.4 [66]",
        kind=Kind.FLOWN,
        where="sim/effects/solar_flaps.py",
        claim="Flaps beside magnets near the equator.",
        claims=(
            "review.one_axis.coils_pitch",
            "review.one_axis.solar_flaps",
        ),
        remark="An effect of the plant; light on any plates: sim/plant/dynamics/surfaces.py.",
    ),
    Method(
        name="ring of conducting fluid",
        source="[O19] 2.4 [67]",
        kind=Kind.FLOWN,
        where="sim/effects/fluid_ring.py",
        claim="Used beside a magnetic system.",
        claims=("review.one_axis.fluid_ring",),
        remark="An effect of the plant, with a pump of constant pressure.",
    ),
)
"""In the order of the review."""
