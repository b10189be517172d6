"""The claims on populations: which satellites fly, and what decides."""

from math import inf

import pytest

from sim.campaign.claim import ClaimVerdict
from sim.campaign.flight import FlightResult
from sim.scenario.schema import load
from sim.validate.population import claims as population

GOOD = {
    "inside_1": 0.999,
    "inside_2": 0.998,
    "inside_3": 1.0,
    "estimate_deg": 0.3,
    "nees": 6.0,
    "point_inside_1": 0.998,
    "point_inside_2": 1.0,
    "point_inside_3": 0.999,
    "point_nees": 6.1,
    "wrong_5deg_s": 10.0,
    "pointing_deg": 1.5,
    "pointed_orbits": 1.8,
    "in_point": 1.0,
    "dipole_am2": 0.02,
}


def flights(study, change=None, isolated=()):
    """Good flights of a study; the first differs."""
    found = [FlightResult(task.args[0], {"isolated": []}, GOOD) for task in study.tasks]
    found[0] = FlightResult(found[0].order, {"isolated": [*isolated]}, GOOD | (change or {}))
    return found


def failed(study, **how):
    outcomes = study.conclude(flights(study, **how))
    return {o.claim.id.rpartition(".")[2] for o in outcomes if o.verdict is not ClaimVerdict.PASS}


@pytest.fixture(scope="module")
def studies():
    return {study.id.partition(".")[2]: study for study in population.studies()}


@pytest.mark.long
def test_as_many_satellites_as_are_claimed(studies):
    count = {name: len(study.tasks) for name, study in studies.items()}
    assert [count[name] for name in ("50kg", "3u", "6u", "tumbling", "twice")] == [100, 30, 30, 30, 30]
    assert all(study.has_flights for study in studies.values())
    for study in studies.values():
        assert len({task.args[0].seed for task in study.tasks}) == len(study.tasks)
        for task in study.tasks[:2]:
            load(task.args[0].scenario, task.args[0].overrides)


def test_fewer_where_fewer_are_asked_for(studies):
    for few in population.studies(most=2):
        whole = studies[few.id.partition(".")[2]]
        assert len(few.tasks) <= 2
        assert [task.args[0] for task in few.tasks] == [task.args[0] for task in whole.tasks][
            : len(few.tasks)
        ]


def test_of_a_few_satellites_each_is_judged_and_no_median_or_mean(studies):
    """Too few pass or fail no claim on a population, however good or bad they are."""
    for few in population.studies(most=2):
        outcomes = (
            few.conclude(flights(few, change={"pointing_deg": 2.4, "nees": 900.0})) if few.tasks else []
        )
        unjudged = {o.claim.id.rpartition(".")[2] for o in outcomes if o.verdict is ClaimVerdict.TOO_FEW}
        combined = {figure.id for figure in few.figures if figure.of in ("median", "mean")}
        assert unjudged == (combined if few.tasks else set())
        assert {o.verdict for o in outcomes if o.verdict is not ClaimVerdict.TOO_FEW} <= {ClaimVerdict.PASS}
    two = population.studies(most=2)[0]
    bad = {"inside_2": 0.9, "wrong_5deg_s": 121.0, "in_point": 0.0}
    judged = {o.claim.id: o.verdict for o in two.conclude(flights(two, change=bad, isolated=["coil 0"]))}
    for name in ("isolated", "inside_worst", "wrong", "in_point"):
        assert judged[f"population.50kg.{name}"] is ClaimVerdict.FAIL
    assert {study.made_for for study in studies.values() if "50kg_per" not in study.id} == {100, 30}


def test_a_study_without_satellites_is_not_judged(studies):
    empty = population.large_dipoles([])
    assert {outcome.verdict for outcome in empty.conclude([])} == {ClaimVerdict.ABSENT}


def test_the_same_satellites_tumble_from_1_to_2_and_from_5_deg_per_s(studies):
    calm = [task.args[0].overrides for task in studies["50kg"].tasks[:30]]
    for name, least, most, orbits in (("tumbling", 1.0, 2.0, 8.0), ("tumbling_5degps", 5.0, 5.0, 14.0)):
        orders = [task.args[0] for task in studies[name].tasks]
        for order, still in zip(orders, calm, strict=True):
            rate = sum(part * part for part in order.overrides["initial"]["rate_degps"]) ** 0.5
            assert least - 1e-9 <= rate <= most + 1e-9
            assert order.orbits == orbits
            assert order.overrides["sensors"] == still["sensors"]


def test_large_dipoles_fly_with_a_back_off_of_each_coil(studies):
    orders = [task.args[0] for task in studies["50kg_per_coil"].tasks]
    assert 10 < len(orders) < 30
    for order in orders:
        assert order.overrides["coils"]["backoff"] == "per_coil"
        dipole = order.overrides["disturbance"]["residual_dipole_am2"]
        assert sum(part * part for part in dipole) ** 0.5 > 0.04


def test_good_flights_hold_every_claim(studies):
    assert all(failed(study) == set() for study in studies.values())


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"inside_2": 0.94}, {"inside_worst"}),
        ({"inside_1": 0.3, "inside_2": 0.3, "inside_3": 0.3}, {"inside_worst"}),
        ({"estimate_deg": 0.71}, {"estimate_worst"}),
        ({"estimate_deg": inf}, {"estimate_worst"}),
        ({"in_point": 0.0}, {"in_point"}),
        ({"pointed_orbits": 2.6}, {"pointed"}),
        ({"pointed_orbits": 2.6, "dipole_am2": 0.05}, set()),
        ({"pointing_deg": 4.1}, {"pointing_small_dipole"}),
        ({"pointing_deg": 7.9, "dipole_am2": 0.05}, set()),
        ({"pointing_deg": 8.1, "dipole_am2": 0.05}, {"pointing_worst"}),
    ],
)
def test_one_bad_satellite_of_a_hundred_fails_its_claim(studies, change, expected):
    assert failed(studies["50kg"], change=change) == expected


def test_a_healthy_unit_that_is_isolated_once_fails(studies):
    for study in studies.values():
        assert failed(study, isolated=["coil 1"]) == {"isolated"}


@pytest.mark.parametrize(
    ("nees", "expected"), [(800.0, {"nees"}), (inf, {"nees"}), (-80.0, {"nees"}), (9.0, set())]
)
def test_nees_is_judged_in_the_mean(studies, nees, expected):
    assert failed(studies["50kg"], change={"nees": nees}) == expected


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"inside_1": 0.5, "nees": 900.0}, set()),
        ({"point_inside_3": 0.94}, {"inside_worst"}),
        ({"point_nees": 900.0}, {"nees"}),
        ({"wrong_5deg_s": 121.0}, {"wrong"}),
        ({"in_point": 0.0}, {"in_point"}),
        (
            {"point_inside_1": 0.0, "point_inside_2": 0.0, "point_inside_3": 0.0, "point_nees": inf},
            {"inside", "inside_worst", "nees"},
        ),
    ],
    ids=["while it tumbles", "in POINT", "by NEES", "wrong at any time", "not there", "never there"],
)
def test_a_satellite_that_tumbled_is_honest_from_point_on(studies, change, expected):
    for name in ("tumbling", "tumbling_5degps"):
        assert failed(studies[name], change=change) == expected


def test_even_at_twice_the_bounds_a_wrong_attitude_is_not_called_valid_for_two_minutes(studies):
    for name in ("twice", "50kg", "3u", "6u"):
        assert failed(studies[name], change={"wrong_5deg_s": 121.0}) == {"wrong"}
    assert failed(studies["twice"], change={"inside_1": 0.5, "pointing_deg": 50.0}) == set()


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"estimate_deg": 0.41}, {"estimate"}),
        ({"pointing_deg": 2.6}, {"pointing"}),
        ({"inside_1": 0.97, "inside_2": 0.99, "inside_3": 0.99}, {"inside"}),
    ],
)
def test_medians_and_means_are_those_of_all_satellites(studies, change, expected):
    study = studies["50kg"]
    bad = [FlightResult(flight.order, flight.summary, GOOD | change) for flight in flights(study)]
    outcomes = study.conclude(bad)
    assert {o.claim.id.rpartition(".")[2] for o in outcomes if o.verdict is ClaimVerdict.FAIL} == expected


@pytest.mark.parametrize("name", ["3u", "6u", "3u_continuous", "6u_continuous"])
def test_pointing_of_cubesats_is_judged_by_the_half_and_by_the_share_of_them(studies, name):
    study = studies[name]

    def failed_with(count):
        """Of whose satellites so many point badly."""
        found = flights(study)
        bad = [FlightResult(one.order, one.summary, GOOD | {"pointing_deg": 10.1}) for one in found[:count]]
        outcomes = study.conclude(bad + found[count:])
        return {o.claim.id.rpartition(".")[2] for o in outcomes if o.verdict is ClaimVerdict.FAIL}

    assert failed_with(3) == set()
    assert failed_with(4) == {"pointing_share"}
    assert failed_with(16) == {"pointing", "pointing_share"}


@pytest.mark.parametrize(("kind", "most_am2"), [("3u", 0.048), ("6u", 0.5)])
def test_the_same_cubesats_fly_without_the_limits_of_pulses(studies, kind, most_am2):
    pairs = zip(studies[kind].orders, studies[f"{kind}_continuous"].orders, strict=True)
    for pulsed, continuous in pairs:
        lifted = dict(continuous.overrides)
        coils = lifted["coils"]
        assert (coils["driver"], coils["max_dipole_am2"], coils["on_fraction"]) == (
            "continuous",
            most_am2,
            0.5,
        )
        assert {**lifted, "coils": None} == {**pulsed.overrides, "coils": None}
        assert continuous.seed == pulsed.seed


def test_every_claim_has_a_limit(studies):
    for study in studies.values():
        assert all(figure.low > -inf or figure.high < inf for figure in study.figures)
