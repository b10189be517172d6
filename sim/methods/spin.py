"""Stabilisation by spin (section 2.1 of the review)."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="three stages by relays: nutation, spin, direction (`relay_stages`)",
        source="[O19] 2.1 [29]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/relay_stages.py",
        claim="Relays with a switching function for each stage, one after the other.",
        claims=(
            "review.spin.relay_stages",
            "review.spin.relay_stages_spin",
            "review.spin.relay_stages_nutation",
        ),
        remark="The review names the functions without printing them; they are derived.",
    ),
    Method(
        name="relay on the momentum (`spin_relay`)",
        source="[O19] 2.1 eq. 3 [30]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin_axis.py",
        claim="Each coil fully on with the sign of h . (e_j x b): spin by coils 1 and 2, nutation by coil 3.",
        claims=("review.spin.relay", "review.spin.relay_spin", "review.spin.relay_nutation"),
        remark="The h of the equation must be the error of the momentum.",
    ),
    Method(
        name="nutation damping by one coil (`nutation`)",
        source="[O19] 2.1 [31-33]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin.py",
        claim="The rate across the axis is damped, that along it is not.",
        claims=(
            "review.spin.nutation",
            "review.spin.nutation_spin",
        ),
    ),
    Method(
        name="spin-up by two coils (`spin_up`)",
        source="[O19] 2.1 [31, 32]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin.py",
        claim="The torque about the axis is k times the square of the field across it.",
        claims=("review.spin.spin_up",),
    ),
    Method(
        name="Y-Thomson (`y_thomson`)",
        source="[O19] 2.1 [34]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin.py",
        claim="The satellite spins about the axis normal to the orbit at the rate wanted.",
        claims=("review.spin.y_thomson", "review.spin.y_thomson_spin"),
    ),
    Method(
        name="reorientation of the spin axis by one coil (`reorientation`)",
        source="[O19] 2.1 [31, 32]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin_axis.py",
        claim="The momentum is turned to its direction and keeps its size.",
        claims=("review.spin.reorientation",),
    ),
    Method(
        name="two errors of the momentum (`spin_relay`)",
        source="[O19] 2.1 [35]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin_axis.py",
        claim="One error, in space, gives the direction; the other, in the body, gives the spin.",
        claims=("review.spin.relay", "review.spin.relay_spin", "review.spin.relay_nutation"),
    ),
    Method(
        name="three terms (`three_term`)",
        source="[O19] 2.1 [36]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/spin_axis.py",
        claim="Nutation, spin and direction by the terms of one law.",
        claims=(
            "review.spin.three_term",
            "review.spin.three_term_spin",
            "review.spin.three_term_nutation",
        ),
    ),
    Method(
        name="precession by the roll angle (`roll_precession`)",
        source="[O19] 2.1 eq. 4 [37]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/roll_precession.py",
        claim="Asymptotically stable by the gains; gains from the analysis and Floquet theory.",
        claims=(
            "review.spin.roll_precession",
            "review.spin.roll_floquet",
        ),
        remark="Gains: sim/design/spin/roll_precession.py.",
    ),
    Method(
        name="precession with any function of the errors (`target_precession`)",
        source="[O19] 2.1 eq. 5 [38]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/target_precession.py",
        claim="Any f with x f(x) > 0; f(x) = x is mostly satisfactory.",
        claims=("review.spin.target_precession",),
        remark="For an f that bends the torque is along the target only in the mean over a turn.",
    ),
    Method(
        name="piecewise constant dipole (`stepped_precession`)",
        source="[O19] 2.1 [39]",
        kind=Kind.FLOWN,
        where="fsw/core/laws/spin/stepped_precession.py",
        claim="Piecewise constant control, from simple errors of angles and rates.",
        claims=("review.spin.stepped_precession",),
        remark="The review prints no equation; it is derived from the torque.",
    ),
)
"""In the order of the review."""
