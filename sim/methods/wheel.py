"""A wheel beside the coils (sections 2.2 and 2.4 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="wheel to the orbit normal by one coil (`dual_spin`)",
        source="[O19] 2.2 eq. 6 [18]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/dual_spin.py",
        claim="The coil along the wheel makes its place on the orbit normal asymptotically stable.",
        claims=("review.wheel.dual_spin.tilt",),
    ),
    Method(
        name="turn in the orbit plane by the other two coils (`dual_spin`)",
        source="[O19] 2.2 [40]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/dual_spin.py",
        claim="The body is turned about the wheel to any pitch.",
        claims=("review.wheel.dual_spin.pitch",),
    ),
    Method(
        name="closed expressions for how fast a dual-spin satellite comes to rest",
        source="[O19] 2.2 [40]",
        kind=Kind.GROUND,
        where="sim/design/wheel/convergence.py",
        claim="Closed expressions say how fast a satellite with a pitch wheel comes to rest.",
        claims=(
            "review.wheel.convergence",
            "review.wheel.strong_wheel",
        ),
        remark="The expressions are not printed and were not found; derived by averaging.",
    ),
    Method(
        name="roll of a horizon sensor alone (`horizon_roll`)",
        source="[O19] 2.2 [41]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/horizon_roll.py",
        claim="Near the equator an infrared horizon sensor's roll stands for the magnetometer's data.",
        claims=("review.wheel.horizon_roll",),
        remark=(
            "The equation is not printed and was not found; derived from the torque of the two coils in "
            "the orbit plane. Roll destabilises the nutation unless its rate outweighs it (Routh)."
        ),
    ),
    Method(
        name="field tracking with a pitch wheel (`field_tracking`)",
        source="[O19] 2.2 eq. 7 [42]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/field_tracking.py",
        claim="The magnetometer alone brings a satellite with a wheel to its attitude; flown on Gurwin.",
        claims=(
            "review.wheel.tracking.wheel",
            "review.wheel.tracking.bare",
            "review.wheel.gurwin.recovery",
        ),
        remark=(
            "It recovers from a tumble without any other knowledge; the wheel holds what the field "
            "leaves free."
        ),
    ),
    Method(
        name="linear-quadratic regulator with a pitch wheel (`lqr`)",
        source="[O19] 2.2 [44]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/lqr.py",
        claim="Flown on Gurwin: designed on a linear model in the direct dipole, it serves the fuller one.",
        claims=("review.wheel.gurwin.lqr",),
        remark="The wheel is stiff beside the body: the effort must weigh a tenth of the default or less.",
    ),
    Method(
        name="disturbance at once and twice the orbital rate",
        source="[O19] 2.2 [44]",
        kind=Kind.GROUND,
        where="sim/design/wheel/harmonics.py",
        claim=(
            "The disturbing torques are taken as simple periodic functions at once and twice the orbital "
            "rate."
        ),
        claims=(
            "review.wheel.gurwin.constant",
            "review.wheel.gurwin.harmonics",
        ),
        remark=(
            "A residual dipole's torque has no constant part to speak of, and an eighth beyond these rates. "
            "`lqr_disturbed` learns such functions in flight."
        ),
    ),
    Method(
        name="six gains (`six_gain`)",
        source="[O19] 2.2 [45]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/six_gain.py",
        claim="The earlier laws compared and made one, in which six gains are to be chosen.",
        claims=(
            "review.wheel.six_gain.lean",
            "review.wheel.six_gain.yaw",
        ),
        remark=(
            "The scan lost signs and dots; they follow from the laws that it contains. Yaw is worth more "
            "than a factor of two in two orbits."
        ),
    ),
    Method(
        name="comparison of the laws of a pitch wheel",
        source="[O19] 2.2 [45]",
        kind=Kind.GROUND,
        where="sim/design/wheel/comparison.py",
        claim="The laws proposed before are compared.",
        claims=("review.wheel.six_gain.springs",),
        remark="Yaw speeds the slowest mode up; springs add a ninth to it, whatever their sign.",
    ),
    Method(
        name="nutation on an elliptic orbit",
        source="[O19] 2.2 [46]",
        kind=Kind.GROUND,
        where="sim/design/wheel/elliptic.py",
        claim="The nutation of a satellite with a pitch wheel is damped on an elliptic orbit too.",
        claims=(
            "review.wheel.elliptic.slowest",
            "review.wheel.elliptic.nutation",
        ),
        remark=(
            "By the coils, with the law of six gains. The product of inertia of the title needs a driven "
            "wheel."
        ),
    ),
    Method(
        name="integral part (`wheel_integral`)",
        source="[O19] 2.2 [47]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/wheel_integral.py",
        claim="An integral part is added to the feedback.",
        claims=(
            "review.wheel.wheel_integral",
            "review.wheel.wheel_integral_yaw",
            "review.wheel.wheel_integral_pitch",
        ),
        remark=(
            "The equation is not printed and was not found; derived. It takes the mean error away, not "
            "what swings with the field."
        ),
    ),
    Method(
        name="sliding relay over the poles (`wheel_relay`)",
        source="[O19] 2.2 [51]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/wheel_relay.py",
        claim="A relay with a layer around a surface whose four gains go with the field; on a polar orbit.",
        claims=("review.wheel.wheel_relay",),
        remark=(
            "The four gains are not printed and were not found; derived. Without a lead the surface "
            "alone turns the lean with the field, and does not straighten it."
        ),
    ),
    Method(
        name="two coils and one wheel (`two_coils`)",
        source="[O19] 2.4 [56]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/two_coils.py",
        claim="One wheel beside two coils gives any torque wanted in full.",
        claims=(
            "review.wheel.two_coils",
            "review.wheel.two_coils_held",
            "review.wheel.two_coils_growth",
            "review.wheel.two_coils_polar",
        ),
        remark=(
            "Only where the field has a component along the wheel: the dipole grows as one over that "
            "component, so that a pitch wheel serves in inclined orbits and not in polar ones."
        ),
    ),
    Method(
        name="torque shared between coils and wheels (`wheel_allocation`)",
        source="[O19] 2.4 [57]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/wheel_allocation.py",
        claim="The torque is shared for different numbers of wheels.",
        claims=(
            "review.wheel.allocation_effort",
            "review.wheel.allocation_limits",
            "review.wheel.flight.final",
            "review.wheel.flight.honest",
        ),
        remark=(
            "The review gives no equation; weighted least squares for any number of wheels, of which one "
            "is flown. With one wheel and the attitude held its momentum is not free."
        ),
    ),
    Method(
        name="pitch wheel whose speed is controlled (`pitch_wheel`)",
        source="[O19] 2.4 [58]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pitch_wheel.py",
        claim="The wheel is a pitch wheel, and its speed can be controlled.",
        claims=(
            "review.wheel.pitch_speed",
            "review.wheel.pitch_momentum",
        ),
        remark="The review gives no equation; derived from the torques of coils and wheel.",
    ),
)
"""In the order of the review."""
