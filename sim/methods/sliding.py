"""Three axes, sliding control (section 3.1)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        "surface in the rate of a sphere, relay",
        "[O19] 3.1 [90]",
        Kind.FLOWN,
        "fsw/core/laws/sliding/sphere.py",
        "The surface has the rate alone; asymptotically stable for a sphere, and for it alone.",
        ("review.sliding.sphere",),
        "Equation not found (searched: pages, documentation); surface and relay are derived.",
    ),
    Method(
        name="Surface of momentum and attitude (`sliding`)",
        source="[O19] 3.1 [91], eq. 10",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding/sliding.py",
        claim=(
            "The torque is parallel to the surface, the coils give its projection; the attitude is reached."
        ),
        claims=("review.sliding.plain.final",),
    ),
    Method(
        "surface without the inertia, classical (`sliding_rate`) and modified (`sliding_rate_modified`)",
        "[O19] 3.1 [92]",
        Kind.FLOWN,
        "fsw/core/laws/sliding/rate_surface.py",
        "A surface without a matrix of weights for the rate.",
        ("review.sliding.rate.classical", "review.sliding.rate.modified"),
        "The torques are derived; without the torque that holds the surface it is reached sooner.",
    ),
    Method(
        name="Surface with integrals (`sliding_integral`)",
        source="[O19] 3.1 [93, 94]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/sliding/sliding.py",
        claim=(
            "The integral of the attitude and of the torque that was lost take disturbances into account."
        ),
        claims=(
            "review.sliding.integral.rms",
            "review.sliding.integral.gain",
        ),
    ),
    Method(
        "surface that the coils can realise",
        "[O19] 3.1 [95]",
        Kind.FLOWN,
        "fsw/core/laws/sliding/realisable.py",
        "A surface fully available to the coils, by a matrix that depends on time, built step by step.",
        (
            "review.sliding.realisable.converges",
            "review.sliding.realisable.steep",
            "review.sliding.realisable.constant",
        ),
        "Equation not found (searched: pages, documentation, code); the least symmetric change is derived.",
    ),
    Method(
        "nonlinear surface with super-twisting",
        "[O19] 3.1 [96]",
        Kind.FLOWN,
        "fsw/core/laws/sliding/super_twisting.py",
        "A nonlinear surface with |q|^p sign(q).",
        ("review.sliding.twisting",),
        "With coils the error stays near a degree: where a plane alone is reached, time is not finite.",
    ),
)
