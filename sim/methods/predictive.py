"""Prediction, adaptation and the papers of PoSAT-1 (sections 3.3, 3.4)."""

from sim.methods.method import Kind, Method

LAWS = "fsw/core/laws/predictive"

METHODS: tuple[Method, ...] = (
    Method(
        name="Model predictive control (`mpc`)",
        source="[O19] 3.3 [12, 108, 109]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/predictive/mpc.py",
        claim=(
            "The field of the orbit ahead is used, and planned anew again and again; a constant "
            "disturbance is a state."
        ),
        claims=(
            "microsat.rms_zero",
            "microsat.rms_3e-8",
            "microsat.rms_1e-7",
        ),
    ),
    Method(
        "Prediction along a field fitted by five functions (`mpc_fitted`)",
        "[O19] 3.3 [12, 49]",
        Kind.FLOWN,
        f"{LAWS}/simple_field.py",
        "A constant and terms at once and twice the orbital rate stand for the field.",
        ("review.predictive.fitted.model", "review.predictive.fitted.dipole"),
    ),
    Method(
        "Prediction with the field held over a short horizon (`mpc_held`)",
        "[O19] 3.3 [109]",
        Kind.FLOWN,
        f"{LAWS}/simple_field.py",
        "With a short horizon field and disturbance may be constants.",
        ("review.predictive.held.short", "review.predictive.held.long"),
        "an eighth of an orbit is too long",
    ),
    Method(
        name="Sequences of pulses with the cost to go (`pulse_mpc`)",
        source="[T] the choice, [O19] 3.3 [12]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/predictive/pulse_mpc.py",
        claim="The choice among pulses looks beyond the next one; the search is this project's.",
        claims=(
            "pulse_mpc.median",
            "pulse_mpc.none_worse",
        ),
    ),
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
        "Nonlinear prediction for damping, with a rule that stops the search (`nmpc_damping`)",
        "[O19] 3.3 [111]",
        Kind.FLOWN,
        f"{LAWS}/nmpc.py",
        "The rule saves most of the search.",
        ("review.predictive.stopping", "review.predictive.tumbling.rule"),
        "damps no sooner than the damping law with its coils at their limits",
    ),
    Method(
        "Nonlinear prediction near the course of the damping law (`nmpc_reference`)",
        "[O19] 3.3 [112]",
        Kind.FLOWN,
        f"{LAWS}/nmpc.py",
        "The cost is the deviation from the course of the law (1), which is the first approximation.",
        ("review.predictive.tumbling.reference",),
        "damps no sooner than that law with its coils at their limits",
    ),
    Method(
        name="Predictive law of pulses (`predictive`)",
        source="[T] eq. 5, 14-18",
        kind=Kind.FLOWN,
        where="fsw/core/laws/predictive/predictive.py",
        claim=("60 deg of libration under 5 deg in 3 orbits, 4 with spin; each choice takes energy away."),
        claims=(
            "posat1.median",
            "posat1.all",
            "posat1-spin.all",
            "posat1-spinup.time",
            "prediction.rate",
        ),
    ),
    Method(
        name="Unrestricted coils by a genetic search",
        source="[T] sec. on implementation",
        kind=Kind.FLOWN,
        where="fsw/core/laws/predictive/genetic.py",
        claim="Restricted actuators do nearly as well as the search over all dipoles.",
        claims=(
            "genetic.median",
            "posat1.restricted",
        ),
    ),
)
