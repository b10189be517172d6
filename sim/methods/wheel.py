"""A wheel beside the coils (sections 2.2, 2.4)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        "roll of a horizon sensor alone",
        "[O19] 2.2 [41]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/horizon_roll.py",
        "Near the equator an infrared horizon sensor's roll stands for the magnetometer's data.",
        ("review.wheel.horizon_roll",),
        "The equation is not printed and was not found; derived from the torque of the two coils in the "
        "orbit plane. Roll destabilises the nutation unless its rate outweighs it (Routh).",
    ),
    Method(
        "field tracking on a satellite with a pitch wheel",
        "[O19] 2.2 eq. 7 [42]",
        Kind.FLOWN,
        "fsw/core/laws/one_axis/field_tracking.py",
        "Flown on Gurwin: the field is turned onto that of the nominal attitude, by the magnetometer alone.",
        ("review.wheel.gurwin.recovery",),
        "It recovers from a tumble without any other knowledge; the wheel holds what the field leaves free.",
    ),
    Method(
        "linear-quadratic regulator with a pitch wheel",
        "[O19] 2.2 [44]",
        Kind.FLOWN,
        "fsw/core/laws/optimal/lqr.py",
        "Flown on Gurwin: designed on a linear model in the direct dipole, it serves the fuller one.",
        ("review.wheel.gurwin.lqr",),
        "The wheel is stiff beside the body: the effort must weigh a tenth of the default or less.",
    ),
    Method(
        "disturbance at once and twice the orbital rate",
        "[O19] 2.2 [44]",
        Kind.GROUND,
        "sim/design/wheel/harmonics.py",
        "The disturbing torques are taken as simple periodic functions at once and twice the orbital rate.",
        ("review.wheel.gurwin.constant", "review.wheel.gurwin.harmonics"),
        "A residual dipole's torque has no constant part to speak of, and an eighth beyond these rates.",
    ),
    Method(
        "six gains",
        "[O19] 2.2 [45]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/six_gain.py",
        "The earlier laws compared and made one, in which six gains are to be chosen.",
        ("review.wheel.six_gain.lean", "review.wheel.six_gain.yaw"),
        "The scan lost signs and dots; they follow from the laws that it contains. Yaw is worth more than "
        "a factor of two in two orbits.",
    ),
    Method(
        "comparison of the laws of a pitch wheel",
        "[O19] 2.2 [45]",
        Kind.GROUND,
        "sim/design/wheel/comparison.py",
        "The laws proposed before are compared.",
        ("review.wheel.six_gain.springs",),
        "Yaw speeds the slowest mode up; springs add a ninth to it, whatever their sign.",
    ),
    Method(
        "nutation on an elliptic orbit",
        "[O19] 2.2 [46]",
        Kind.GROUND,
        "sim/design/wheel/elliptic.py",
        "The nutation of a satellite with a pitch wheel is damped on an elliptic orbit too.",
        ("review.wheel.elliptic.slowest", "review.wheel.elliptic.nutation"),
        "By the coils, with the law of six gains. The product of inertia of the title needs a driven wheel.",
    ),
    Method(
        "integral part",
        "[O19] 2.2 [47]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/wheel_integral.py",
        "An integral part is added to the feedback.",
        ("review.wheel.wheel_integral",),
        "The equation is not printed and was not found; derived. It takes the mean error away, not what "
        "swings with the field.",
    ),
    Method(
        "sliding relay over the poles",
        "[O19] 2.2 [51]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/wheel_relay.py",
        "A relay with a layer around a surface whose four gains go with the field; on a polar orbit.",
        ("review.wheel.wheel_relay",),
        "The four gains are not printed and were not found; derived. Without a lead the surface alone turns "
        "the lean with the field, and does not straighten it.",
    ),
    Method(
        "closed expressions for the speed of a dual-spin satellite",
        "[O19] 2.2 [40]",
        Kind.GROUND,
        "sim/design/wheel/convergence.py",
        "Closed expressions say how fast a satellite with a pitch wheel comes to rest.",
        ("review.wheel.convergence", "review.wheel.strong_wheel"),
        "The expressions are not printed and were not found; derived by averaging.",
    ),
    Method(
        "two coils and one wheel",
        "[O19] 2.4 [56]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/two_coils.py",
        "With one wheel beside two coils any torque wanted is given in full.",
        (
            "review.wheel.two_coils",
            "review.wheel.two_coils_held",
            "review.wheel.two_coils_growth",
            "review.wheel.two_coils_polar",
        ),
        "Only where the field has a component along the wheel: the dipole grows as one over it, so that a "
        "pitch wheel serves in inclined orbits and not over the poles.",
    ),
    Method(
        "torque shared between coils and wheels",
        "[O19] 2.4 [57]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/allocation.py",
        "The torque is shared for different numbers of wheels.",
        (
            "review.wheel.allocation_effort",
            "review.wheel.allocation_limits",
            "review.wheel.flight.final",
            "review.wheel.flight.honest",
        ),
        "The review gives no equation; weighted least squares of any number of wheels, of which one is "
        "flown. With one wheel and the attitude held nothing is left to choose its momentum by.",
    ),
    Method(
        "pitch wheel whose speed is controlled",
        "[O19] 2.4 [58]",
        Kind.FLOWN,
        "fsw/core/laws/wheel/pitch_wheel.py",
        "The wheel is a pitch wheel, and its speed can be controlled.",
        ("review.wheel.pitch_speed", "review.wheel.pitch_momentum"),
        "The review gives no equation; derived from the torques of coils and wheel.",
    ),
)
