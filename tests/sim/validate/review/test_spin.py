"""Claims on stabilisation by spin: a law that lacks one of its terms misses one of them."""

import pytest

from fsw.core.algebra.vector import ZERO
from fsw.core.laws import spin as thomson
from fsw.core.laws import spin_axis, target_precession
from sim.campaign.claim import ClaimVerdict
from sim.validate.review import spin

pytestmark = pytest.mark.long


def missed(*names):
    """The claims that are missed, of those with these names."""
    rows = [row.study("spin", spin.REVIEW, spin.flown_figure) for row in spin.ROWS if row.name in names]
    assert len(rows) == len(names)
    outcomes = [outcome for row in rows for outcome in row.conclude([task() for task in row.tasks])]
    return {one.claim.id.rpartition(".")[2] for one in outcomes if one.verdict is not ClaimVerdict.PASS}


@pytest.mark.interpreted
def test_without_the_error_of_the_spin_the_relay_turns_the_momentum_but_does_not_spin(monkeypatch):
    names = ("relay", "relay_spin", "relay_nutation")
    assert missed(*names) == set()
    whole = spin_axis._errors
    monkeypatch.setattr(spin_axis, "_errors", lambda *words: (whole(*words)[0], ZERO))
    assert missed(*names) == {"relay_spin", "relay_nutation"}


@pytest.mark.interpreted
def test_without_its_first_term_the_law_of_three_leaves_the_nutation(monkeypatch):
    names = ("three_term", "three_term_spin", "three_term_nutation")
    assert missed(*names) == set()
    whole = spin_axis.three_term_dipole
    monkeypatch.setattr(
        spin_axis,
        "three_term_dipole",
        lambda b, omega, spin_error, error, axis, k_w, *gains: whole(
            b, omega, spin_error, error, axis, 0.0, *gains
        ),
    )
    assert missed(*names) == {"three_term_nutation"}


@pytest.mark.interpreted
def test_without_the_term_of_the_spin_the_law_of_three_spins_up_by_the_momentum_alone(monkeypatch):
    """It comes to the same end, at half the speed."""
    names = ("three_term", "three_term_spin", "three_term_nutation")
    assert spin.three_term_gain().conclude([spin.three_term_ratio()])[0].verdict is ClaimVerdict.PASS
    whole = spin_axis.three_term_dipole
    monkeypatch.setattr(
        spin_axis,
        "three_term_dipole",
        lambda b, omega, spin_error, *rest: whole(b, omega, 0.0, *rest),
    )
    assert missed(*names) == set()
    assert spin.three_term_gain().conclude([spin.three_term_ratio()])[0].verdict is ClaimVerdict.FAIL


@pytest.mark.interpreted
def test_without_the_coil_that_holds_it_the_spin_stays_as_it_was(monkeypatch):
    names = ("y_thomson", "y_thomson_spin")
    assert missed(*names) == set()
    monkeypatch.setattr(thomson, "y_thomson_dipole", lambda *words: ZERO)
    assert missed(*names) == set(names)


@pytest.mark.interpreted
def test_half_the_gain_misses_its_direction(monkeypatch):
    whole = spin_axis.reorientation_dipole
    monkeypatch.setattr(
        spin_axis, "reorientation_dipole", lambda b, error, axis, k_h: whole(b, error, axis, 0.5 * k_h)
    )
    assert missed("reorientation") == {"reorientation"}


@pytest.mark.interpreted
def test_half_of_one_of_two_terms_misses_the_target(monkeypatch):
    def halved(b, target, axis, k, limit):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        first, second = (target_precession.bent(target[place], limit) for place in (v, u))
        m = [0.0, 0.0, 0.0]
        m[axis] = k * (0.5 * b[u] * first - b[v] * second)
        return tuple(m)

    monkeypatch.setattr(target_precession, "precession_dipole", halved)
    assert missed("target_precession") == {"target_precession"}
