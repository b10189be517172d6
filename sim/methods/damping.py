"""Damping of the rate (section 1 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        "damping by the rate, m = k omega x b (`rate_damping`)",
        "[O19] 1 [18, 20-24]",
        Kind.FLOWN,
        "fsw/core/laws/damping/damping.py",
        "The rate goes to zero exponentially, at a speed that depends on the inclination.",
        ("review.damping.rate", "review.damping.inclination"),
    ),
    Method(
        "B-dot (`bdot`)",
        "[O19] 1 [18, 19]",
        Kind.FLOWN,
        "fsw/core/laws/damping/damping.py",
        "It stops at just under twice the orbital rate, because the field itself turns.",
        ("review.damping.bdot_stop",),
    ),
    Method(
        "damping of the relative rate, by the Jacobi integral",
        "[O19] 1 [25]",
        Kind.FLOWN,
        "fsw/core/laws/damping/damping.py",
        "The Jacobi integral is a Lyapunov function of the motion under gravity gradient.",
        ("review.damping.jacobi",),
    ),
    Method(
        "matrix for a gain",
        "[O19] 1 [26]",
        Kind.FLOWN,
        "fsw/core/laws/damping/matrix_gain.py",
        "Any positive definite matrix may stand for the scalar gain.",
        ("review.damping.matrix",),
        "True with the matrix outside the product, m = -H (b x omega); inside it, the energy may rise.",
    ),
    Method(
        "gain that keeps the torque",
        "[O19] 1",
        Kind.FLOWN,
        "fsw/core/laws/damping/held_torque.py",
        "A gain that grows as the rate falls keeps the torque, and is faster.",
        ("review.damping.bdot_held",),
    ),
    Method(
        "two values of the gain (`bdot_switched`)",
        "[O19] 1 [27]",
        Kind.FLOWN,
        "fsw/core/laws/damping/damping.py",
        "The gain is changed once the rate has fallen below a value.",
        ("review.damping.bdot_switched",),
    ),
    Method(
        "optimal law for momentum and energy (`least_momentum`, `least_energy`)",
        "[O19] 1 [28]",
        Kind.FLOWN,
        "fsw/core/laws/damping/optimal.py",
        "Momentum brought to small given values and held there, considerably faster.",
        ("review.damping.least_momentum", "review.damping.least_energy"),
        "The relay is derived; it is optimal at each instant, not over the whole of the damping.",
    ),
    Method(
        "rate damped as a reference model (`rate_model`)",
        "[O19] 1 [28]",
        Kind.FLOWN,
        "fsw/core/laws/damping/optimal.py",
        "The rates follow three independent linear equations.",
        ("review.damping.rate_model",),
        "The coils give only the part of the torque across the field: the rates do not follow the model, and "
        "the energy may rise for a while.",
    ),
)
"""In the order of the review."""
