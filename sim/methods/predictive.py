"""Prediction, adaptation and the papers of PoSAT-1 (sections 3.3, 3.4)."""

from sim.methods.method import Kind, Method

LAWS = "fsw/core/laws/predictive"

METHODS: tuple[Method, ...] = (
    Method(
        "Prediction within the coils' limits as a quadratic programme",
        "[O19] 3.3 [108, 110]",
        Kind.FLOWN,
        f"{LAWS}/mpc_box.py",
        "The limits are part of the problem, not a cut of its solution.",
        ("review.predictive.box",),
    ),
    Method(
        "Explicit form of that programme",
        "[O19] 3.3 [110]",
        Kind.GROUND,
        "sim/design/predictive/explicit.py",
        "A table of linear pieces in place of a solver.",
        ("review.predictive.explicit",),
        "not for flight: its pieces grow with the horizon, and each field needs a table of its own",
    ),
    Method(
        "Nonlinear prediction for damping, with a rule that stops the search",
        "[O19] 3.3 [111]",
        Kind.FLOWN,
        f"{LAWS}/nmpc.py",
        "The rule saves most of the search.",
        ("review.predictive.stopping",),
        "damps no sooner than the damping law with its coils at their limits",
    ),
)
