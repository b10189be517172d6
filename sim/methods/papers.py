"""The paper on the choice of gains [O15], and statements of the review beside its methods."""

from sim.methods.method import Kind, Method

METHODS: tuple[Method, ...] = (
    Method(
        name="PD law in the orbital frame (`pd`)",
        source="[O15] eq. 3",
        kind=Kind.FLOWN,
        where="fsw/core/laws/pd.py",
        claim="The law holds the orbital frame although gravity and gyroscopic torques are left out of it.",
        claims=("linearisation",),
    ),
    Method(
        name="best gains of typical satellites",
        source="[O15] 3 eq. 4",
        kind=Kind.GROUND,
        where="sim/design/theory/search.py",
        claim=(
            "The gains with the least degree of stability, for a CubeSat, a microsatellite and one of a "
            "few tons."
        ),
        claims=(
            "best_gains.1U",
            "best_gains.3U",
            "best_gains.50_kg",
            "best_gains.few_tons",
        ),
    ),
    Method(
        name="bodies that the gravity gradient turns over",
        source="[O15] 3",
        kind=Kind.GROUND,
        where="sim/design/theory/bodies.py",
        claim="Stability depends on the moments; some bodies have no stabilising gains.",
        claims=("unstable_bodies",),
    ),
    Method(
        name="flight with a Kalman filter and disturbances",
        source="[O15] 4",
        kind=Kind.FLOWN,
        where="sim/scenario/shipped/kalman-50kg.toml",
        claim="The gains work with a filter in the loop and an inclined dipole.",
        claims=(
            "scenario-kalman-1u.pointing_shipped",
            "scenario-kalman-50kg.pointing_shipped",
            "scenario-kalman-tons.pointing_shipped",
        ),
    ),
    Method(
        name="models of the field: direct and inclined dipole, IGRF",
        source="[O19] introduction [6-8]",
        kind=Kind.FLOWN,
        where="fsw/core/orbit/field.py",
        claim="The direct dipole suits the synthesis, the inclined one and IGRF the check.",
        claims=(
            "reference.igrf14.onboard",
            "reference.igrf14.plant",
        ),
    ),
    Method(
        name="controllability on the mean",
        source="[O19] introduction [4, 5, 9]",
        kind=Kind.GROUND,
        where="sim/design/theory/controllability.py",
        claim="The satellite is controllable over an orbit, but for two relations between its moments.",
        claims=(
            "review.controllability.orbit",
            "review.controllability.equator",
        ),
        remark=(
            "Over the equator the direct dipole's field does not turn, and coils cannot control the "
            "satellite. The relations are not printed."
        ),
    ),
    Method(
        name="epsilon strategies",
        source="[O19] introduction [10]",
        kind=Kind.PASSED_OVER,
        where="",
        claim="A control strategy for small deviations is proposed with the proof of controllability.",
        remark=(
            "The review gives no equation; none was found by the authors' names, the title and the "
            "method's name."
        ),
    ),
    Method(
        name="passive magnets, hysteresis rods and dampers",
        source="[O19] introduction [1, 15]",
        kind=Kind.PASSED_OVER,
        where="",
        claim="Simple and reliable without computations.",
        remark="The review leaves passive systems out: nothing is commanded.",
    ),
    Method(
        name="first active systems; motion from the magnetometer's record",
        source="[O19] introduction [2, 3]",
        kind=Kind.PASSED_OVER,
        where="",
        claim="Tiros II, a dipole switched from the ground; Sputnik 3, its motion reconstructed.",
        remark="History: no law is given. A recorded motion is what `torquer calibrate` works with.",
    ),
    Method(
        name="surveys and books",
        source="[O19] introduction [11, 13, 14, 16, 17]",
        kind=Kind.PASSED_OVER,
        where="",
        claim="They sum up what others have found.",
        remark="They describe no methods of their own.",
    ),
)
