"""Prediction and adaptation (sections 3.3 and 3.4 of the review), and the paper on PoSAT-1 [T]."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="model predictive control (`mpc`)",
        source="[O19] 3.3 [12, 108, 109]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/mpc.py",
        claim=(
            "The plan uses the field of the orbit ahead and is renewed often; a constant disturbance is "
            "a state."
        ),
        claims=(
            "microsat.rms_zero",
            "microsat.rms_3e-8",
            "microsat.rms_1e-7",
        ),
    ),
    Method(
        name="prediction along a field fitted by five functions (`mpc_fitted`)",
        source="[O19] 3.3 [12, 49]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/mpc_simple_field.py",
        claim="A constant and terms at once and twice the orbital rate stand for the field.",
        claims=(
            "review.predictive.fitted.model",
            "review.predictive.fitted.dipole",
        ),
    ),
    Method(
        name="prediction with the field held over a short horizon (`mpc_held`)",
        source="[O19] 3.3 [109]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/mpc_simple_field.py",
        claim="With a short horizon field and disturbance may be taken as constants.",
        claims=(
            "review.predictive.held.short",
            "review.predictive.held.long",
        ),
        remark="An eighth of an orbit is too long.",
    ),
    Method(
        name="sequences of pulses with the cost to go (`pulse_mpc`)",
        source="[T] on the choice, [O19] 3.3 [12]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pulse_mpc.py",
        claim="The choice among pulses looks beyond the next one; the search is this project's.",
        claims=(
            "pulse_mpc.rms_zero",
            "pulse_mpc.rms_3e-8",
            "pulse_mpc.rms_1e-7",
            "pulse_mpc-population.median",
            "pulse_mpc-population.none_worse",
        ),
    ),
    Method(
        name="prediction within the coils' limits as a quadratic programme (`mpc_box`)",
        source="[O19] 3.3 [108, 110]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/mpc_box.py",
        claim="The limits are part of the problem, not a cut of its solution.",
        claims=("review.predictive.box",),
    ),
    Method(
        name="explicit form of that programme",
        source="[O19] 3.3 [110]",
        kind=Kind.GROUND,
        where="sim/design/predictive/explicit.py",
        claim="A table of linear pieces in place of a solver.",
        claims=("review.predictive.explicit",),
        remark="Not for flight: its pieces grow with the horizon, and each field needs a table of its own.",
    ),
    Method(
        name="nonlinear prediction for damping, with a rule that stops the search (`nmpc_damping`)",
        source="[O19] 3.3 [111]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/nmpc.py",
        claim="The rule saves most of the search.",
        claims=(
            "review.predictive.stopping",
            "review.predictive.tumbling.rule",
        ),
        remark="It damps no sooner than the damping law with its coils at their limits.",
    ),
    Method(
        name="nonlinear prediction near the course of the damping law (`nmpc_reference`)",
        source="[O19] 3.3 [112]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/nmpc.py",
        claim=(
            "The cost is the deviation from the course of the rate damping, eq. 1, which is the first "
            "approximation."
        ),
        claims=("review.predictive.tumbling.reference",),
        remark="It damps no sooner than that law with its coils at their limits.",
    ),
    Method(
        name="gains of the PD law (8) by dynamic neural units (`pd_neural`)",
        source="[O19] 3.4 [113]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd_neural.py",
        claim="The gains so found do well, above all against disturbances that are not known.",
        claims=("review.feedback.neural",),
        remark=(
            "The review gives no equation of the network or of its training; none was found by the authors' "
            "names, the title and the method's name. Units and training are derived: "
            "`sim/design/feedback/neural.py`, `tools/train_neural_gains.py`."
        ),
    ),
    Method(
        name="predictive law of pulses (`predictive`)",
        source="[T] eq. 5, 14-18",
        kind=Kind.FLOWN,
        where="fsw/core/laws/predictive.py",
        claim=(
            "Libration of 60 deg falls under 5 deg in 3 orbits, in 4 with spin; each choice takes energy "
            "away."
        ),
        claims=(
            "posat1.median",
            "posat1.all",
            "posat1-spin.all",
            "posat1-spinup.time",
            "prediction.rate",
        ),
    ),
    Method(
        name="unrestricted coils by a genetic search",
        source="[T] on implementation",
        kind=Kind.FLOWN,
        where="fsw/core/laws/plan/genetic.py",
        claim="The results with restricted actuators are similar to those with unrestricted ones.",
        claims=(
            "genetic.median",
            "posat1.restricted",
        ),
        remark=(
            "Not similar here: with levels the boom settles in half the time. What is judged is that it does "
            "so no later."
        ),
    ),
)
"""In the order of the review."""
