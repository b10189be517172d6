"""Three axes, sliding control (section 3.1 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="surface in the rate of a sphere, relay (`sliding_sphere`)",
        source="[O19] 3.1 [90]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding_sphere.py",
        claim="The surface has the rate alone; asymptotically stable for a sphere, and for it alone.",
        claims=("review.sliding.sphere",),
        remark="Equation not found (searched: pages, documentation); surface and relay are derived.",
    ),
    Method(
        name="surface of momentum and attitude (`sliding`)",
        source="[O19] 3.1 eq. 10 [91]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding.py",
        claim=(
            "The torque is parallel to the surface, the coils give its projection; the attitude is reached."
        ),
        claims=("review.sliding.plain.final",),
    ),
    Method(
        name="surface without the inertia, classical and modified (`sliding_rate`, `sliding_rate_modified`)",
        source="[O19] 3.1 [92]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding_rate.py",
        claim="A surface without a matrix of weights for the rate.",
        claims=(
            "review.sliding.rate.classical",
            "review.sliding.rate.modified",
        ),
        remark="The torques are derived; without the torque that holds the surface it is reached sooner.",
    ),
    Method(
        name="surface with integrals (`sliding_integral`)",
        source="[O19] 3.1 [93, 94]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding.py",
        claim="The integrals of the attitude and of the lost torque take disturbances into account.",
        claims=(
            "review.sliding.integral.rms",
            "review.sliding.integral.gain",
        ),
    ),
    Method(
        name="surface that the coils can realise (`sliding_realisable`)",
        source="[O19] 3.1 [95]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding_realisable.py",
        claim=(
            "The coils can realise the surface in full, by a matrix that depends on time and is built "
            "step by step."
        ),
        claims=(
            "review.sliding.realisable.converges",
            "review.sliding.realisable.steep",
            "review.sliding.realisable.constant",
        ),
        remark=(
            "Equation not found (searched: pages, documentation, code); the least symmetric change is "
            "derived."
        ),
    ),
    Method(
        name="nonlinear surface with super-twisting (`sliding_twisting`)",
        source="[O19] 3.1 [96]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding_twisting.py",
        claim="A nonlinear surface with |q|^p sign(q).",
        claims=("review.sliding.twisting",),
        remark=(
            "With coils the error stays near a degree: they give torque in a plane only, and the finite "
            "time of the method is lost."
        ),
    ),
)
"""In the order of the review."""
