"""The claims on flight data: a pass beyond a limit fails it, and is named with the cause if it is known."""

from math import isnan, nan

import pytest

from sim.campaign.claim import ClaimVerdict
from sim.errors import HarnessError
from sim.validate.flight_data import claims
from sim.validate.flight_data.claims import conclude, conclude_believed, passes_table
from sim.validate.flight_data.passes import CALIBRATED_BY, Believed, NotToldError, PassFigures


def figures(name, rows=200, span_s=199.0, converged=True, **changes):
    found = {
        "converged": converged,
        "told_by": "cells",
        "reason": None if converged else "two motions",
        "rows": rows,
        "field_norm_nt_rms": 700.0,
        "field_direction_deg_rms": 1.5,
        "rate_y_degps_mean": 30.4,
        "gyro_y_degps_mean": 29.8,
        "coast_deg_rms": {"10": 1.0, "30": 1.5, "60": 2.0, "120": None},
        "sun_azimuth_deg": {"median": -6.0, "rms": 2.0, "rows": 9},
    } | changes
    return PassFigures(name, span_s, 480.0, found)


PASSES = [
    figures(CALIBRATED_BY, 2000, 1999.0),
    figures("s3_20230824T144409Z", 5586, 5599.0),
    figures("s3_20240701T000000Z"),
]


def outcomes(*passes):
    return {one.claim.id.removeprefix("flight-data."): one for one in conclude(passes)}


def test_every_claim_holds_for_passes_within_its_limits():
    found = outcomes(*PASSES)
    assert {one.verdict for one in found.values()} == {ClaimVerdict.PASS}
    assert set(claims.CAUSES) <= set(found) | {"coast-120"}
    assert found["rate"].ours == pytest.approx(0.6 / (0.025 * 29.8 + 0.1))
    assert found["rate-corrected"].ours == pytest.approx(abs(30.4 - 30.0 / 0.985))


@pytest.mark.parametrize(
    ("claim", "changes"),
    [
        ("strength-2024", {"field_norm_nt_rms": 2600.0}),
        ("direction-short", {"field_direction_deg_rms": 3.1}),
        ("rate", {"rate_y_degps_mean": 30.7}),
        ("rate-corrected", {"rate_y_degps_mean": 30.78}),
        ("coast-60", {"coast_deg_rms": {"10": 1.0, "30": 1.5, "60": 3.1, "120": None}}),
        ("coast-120", {"coast_deg_rms": {"10": 1.0, "30": 1.5, "60": 2.0, "120": 5.1}}),
        ("azimuth", {"sun_azimuth_deg": {"median": -15.1, "rms": 2.0, "rows": 9}}),
        ("azimuth-scatter", {"sun_azimuth_deg": {"median": 3.0, "rms": 5.1, "rows": 9}}),
        ("told", {"converged": False}),
    ],
)
def test_a_pass_beyond_a_limit_fails_that_claim_and_is_named(claim, changes):
    found = outcomes(*PASSES[:2], figures("s3_20240701T000000Z", **changes))
    assert found[claim].verdict is ClaimVerdict.FAIL
    assert "s3_20240701T000000Z" in found[claim].where


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_figure_that_is_no_number_fails_its_claim_wherever_it_stands(place):
    passes = [figures(f"s3_2024070{day}T000000Z") for day in (1, 2, 3)]
    passes[place] = figures(f"s3_2024070{place + 1}T000000Z", field_direction_deg_rms=nan)
    outcome = outcomes(*passes)["direction-short"]
    assert outcome.verdict is ClaimVerdict.FAIL
    assert outcome.where.startswith(f"worst s3_2024070{place + 1}T000000Z")


class TestCalibration:
    """The pass by which all others are judged."""

    def studies(self, tmp_path, monkeypatch, error):
        def untold(folder):
            raise error

        (tmp_path / f"{CALIBRATED_BY}.csv").write_text("")
        monkeypatch.setattr(claims, "carried", untold)
        return claims.studies(tmp_path)

    def test_where_it_tells_no_body_every_claim_fails(self, tmp_path, monkeypatch):
        studies = self.studies(tmp_path, monkeypatch, NotToldError("it does not tell sensors and body"))
        found = [one for study in studies for one in study.conclude([task() for task in study.tasks])]
        expected = [*(limit.claim for limit in claims.LIMITS), claims.TOLD, claims.BELIEVED]
        assert [one.claim for one in found] == expected
        assert {(one.verdict, one.where) for one in found} == {
            (ClaimVerdict.FAIL, "it does not tell sensors and body")
        }
        assert all(isnan(one.ours) for one in found)

    def test_where_it_cannot_be_read_nothing_is_judged(self, tmp_path, monkeypatch):
        with pytest.raises(HarnessError, match="line 3"):
            self.studies(tmp_path, monkeypatch, HarnessError("line 3"))


def test_a_known_cause_is_told_and_is_no_excuse(monkeypatch):
    monkeypatch.setattr(claims, "CAUSES", {"direction-short": {"s3_20240702T000000Z": "gaps"}})
    missed = figures("s3_20240702T000000Z", field_direction_deg_rms=3.4)
    outcome = outcomes(*PASSES, missed)["direction-short"]
    assert outcome.verdict is ClaimVerdict.FAIL
    assert "missed by s3_20240702T000000Z 3.4: gaps" in outcome.where
    assert (outcome.spread.flights, outcome.spread.meet) == (2, 1)


def test_what_was_set_apart_before_it_was_judged_does_not_count():
    scattered = figures("s3_20230824T144409Z", 5586, 5599.0, sun_azimuth_deg={"median": 3.0, "rms": 15.0})
    assert outcomes(PASSES[0], scattered)["azimuth-scatter"].verdict is ClaimVerdict.PASS


def test_of_a_pass_that_is_not_believed_no_motion_is_claimed():
    lost = figures("s3_20240702T000000Z", 40, converged=False, field_direction_deg_rms=80.0)
    found = outcomes(*PASSES, lost)
    assert {one.verdict for one in found.values()} == {ClaimVerdict.PASS}
    assert "not converged: two motions" in "\n".join(passes_table([lost]))


def test_a_wrong_motion_that_is_believed_fails():
    right, wrong = Believed("a", 6, ()), Believed("b", 4, ("65.30 deg/s from 200 s",))
    assert conclude_believed([right])[0].verdict is ClaimVerdict.PASS
    (outcome,) = conclude_believed([right, wrong])
    assert outcome.verdict is ClaimVerdict.FAIL
    assert "65.30 deg/s from 200 s" in outcome.where


def test_the_table_says_what_is_not_claimed():
    lines = passes_table(PASSES)
    assert lines[-1].startswith("Not claimed: the absolute attitude")
    assert len(lines) == 2 + len(PASSES) + 2
