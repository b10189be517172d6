"""Damping of the rate (section 1 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="damping of the rate, m = k omega x b (`rate_damping`)",
        source="[O19] 1 [18, 20-24]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping.py",
        claim="The rate goes to zero exponentially, at a speed that depends on the inclination.",
        claims=(
            "review.damping.rate",
            "review.damping.inclination",
        ),
    ),
    Method(
        name="B-dot (`bdot`)",
        source="[O19] 1 [18, 19]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping.py",
        claim="It stops at just under twice the orbital rate, because the field itself turns.",
        claims=("review.damping.bdot_stop",),
    ),
    Method(
        name="damping of the relative rate, by the Jacobi integral (`rate_damping`)",
        source="[O19] 1 [25]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping.py",
        claim="The Jacobi integral is a Lyapunov function of the motion under gravity gradient.",
        claims=("review.damping.jacobi",),
    ),
    Method(
        name="matrix for a gain (`rate_damping_matrix`)",
        source="[O19] 1 [26]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/rate_damping_matrix.py",
        claim="Any positive definite matrix may stand for the scalar gain.",
        claims=("review.damping.matrix",),
        remark=(
            "True with the matrix outside the product, m = -H (b x omega); inside it, the energy may rise."
        ),
    ),
    Method(
        name="gain that keeps the torque (`bdot_held`)",
        source="[O19] 1",
        kind=Kind.FLOWN,
        where="fsw/core/laws/bdot_held.py",
        claim="A gain that grows as the rate falls keeps the torque, and is faster.",
        claims=("review.damping.bdot_held",),
    ),
    Method(
        name="two values of the gain (`bdot_switched`)",
        source="[O19] 1 [27]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/damping.py",
        claim="The gain is changed once the rate has fallen below a value.",
        claims=("review.damping.bdot_switched",),
    ),
    Method(
        name="optimal law for momentum and energy (`least_momentum`, `least_energy`)",
        source="[O19] 1 [28]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/optimal_damping.py",
        claim="Momentum brought to small given values and held there, considerably faster.",
        claims=(
            "review.damping.least_momentum",
            "review.damping.least_energy",
        ),
        remark="The relay is derived; it is optimal at each instant, not over the whole of the damping.",
    ),
    Method(
        name="rate damped as a reference model (`rate_model`)",
        source="[O19] 1 [28]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/optimal_damping.py",
        claim="The rates follow three independent linear equations.",
        claims=("review.damping.rate_model",),
        remark=(
            "The coils give only the part of the torque across the field: the rates do not follow the "
            "model, and the energy may rise for a while."
        ),
    ),
)
"""In the order of the review."""
