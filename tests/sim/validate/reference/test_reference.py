"""Reference checks: what is right passes, and one spoiled number in any column that counts fails by name."""

from math import cos, sin

import numpy as np
import pytest

from sim.campaign.claim import ClaimVerdict
from sim.errors import HarnessError
from sim.plant.environment.orbit import MU_M3PS2
from sim.validate.reference import reference
from sim.validate.reference.attitude_check import two_body

ROWS = {"attitude_d_offdiag.csv": 6, "attitude_c_dipole.csv": 6, "floquet.csv": 7}


def check(folder, name):
    """The outcomes of one file."""
    pattern = "attitude_*.csv" if name.startswith("attitude") else name
    return reference.check_file(folder.path / name, pattern).outcomes


def failures(folder, name):
    return {
        outcome.claim.id.rpartition(".")[2]: outcome
        for outcome in check(folder, name)
        if outcome.verdict is ClaimVerdict.FAIL
    }


@pytest.mark.long
def test_every_reference_file_passes(whole_folder):
    studies = reference.studies(whole_folder.path)
    outcomes = [outcome for study in studies for outcome in study.conclude([task() for task in study.tasks])]
    assert {outcome.verdict for outcome in outcomes} == {ClaimVerdict.PASS}
    assert len({outcome.claim.id for outcome in outcomes}) == len(outcomes) > 50
    assert len(studies) == 11


SPOILED = [
    ("igrf14.csv", 40, "b_ecef_y_nT", 2e-3, {"plant", "onboard_reference"}),
    ("igrf14.csv", 7, "b_ecef_z_nT", -0.3, {"plant", "onboard_reference"}),
    ("igrf14.csv", 7, "b_decyear_x_nT", 0.8, {"decimal_years"}),
    ("igrf14.csv", 7, "r_ecef_x_km", 1e-5 * 6e3, {"plant", "onboard_reference"}),
    ("earth_sun.csv", 11, "gmst82_rad", 1e-5, {"gmst_plant", "gmst_onboard"}),
    ("earth_sun.csv", 11, "t2p_21", 1e-5, {"turn_plant", "turn_onboard"}),
    ("earth_sun.csv", 11, "t2p_33", 1e-5, {"turn_plant", "turn_onboard"}),
    ("earth_sun.csv", 11, "c2t_32", 1e-5, {"chain_plant", "chain_onboard"}),
    ("earth_sun.csv", 11, "sun_geo_z", 1e-5, {"chain_plant", "chain_onboard"}),
    ("earth_sun.csv", 11, "sun_teme_x", 1e-5, {"chain_plant", "chain_onboard"}),
    ("earth_sun.csv", 11, "sun_mod_y", 1e-3, {"sun_mod_plant", "sun_mod_onboard"}),
    ("earth_sun.csv", 11, "sun_app_y", 1e-3, {"sun_app_plant", "sun_app_onboard"}),
    ("earth_sun.csv", 11, "sun_dist_km", 4e4, {"sun_distance"}),
    ("eclipse.csv", 12, "frac_planar", 1e-5, {"planar"}),
    ("eclipse.csv", 12, "frac_exact", 1e-2, {"exact"}),
    ("eclipse.csv", 12, "lit_cylinder", 1.0, {"cylinder"}),
    ("eclipse.csv", 12, "sat_x_km", 1.0, {"planar"}),
    ("attitude_d_offdiag.csv", 4, "q2", 1e-5, {"attitude"}),
    ("attitude_d_offdiag.csv", 4, "omega_z_rad_s", 1e-5, {"rate"}),
    ("attitude_d_offdiag.csv", 4, "r_eci_y_km", 1e-4, {"position"}),
    ("attitude_c_dipole.csv", 5, "q0", -1e-6, {"attitude"}),
    ("attitude_c_dipole.csv", 5, "omega_x_rad_s", 1e-8, {"rate"}),
    ("floquet.csv", 6, "mult_3_re", 1e-5, {"multipliers"}),
    ("floquet.csv", 6, "mult_1_im", 1e-5, {"multipliers"}),
    ("floquet.csv", 6, "degree_of_stability", 1e-5, {"degree"}),
    ("floquet.csv", 6, "w0_rad_s", 1e-9, {"w0"}),
    ("floquet.csv", 6, "B0_T", 1e-11, {"b0"}),
    ("triad_mekf.csv", 20, "q_triad_2", 1e-5, {"triad"}),
    ("triad_mekf.csv", 20, "q_dav_1", 1e-5, {"filter", "filter_error", "covariance"}),
    ("triad_mekf.csv", 20, "p_dav_xx", 1e-10, {"covariance"}),
    ("triad_mekf.csv", 20, "err_triad_rad", 1e-5, {"triad_error"}),
    ("triad_mekf.csv", 20, "err_dav_rad", 1e-5, {"filter_error"}),
    ("triad_mekf.csv", 20, "b1_y", 1e-5, {"triad"}),
]


@pytest.mark.parametrize(
    ("name", "row", "column", "error", "failing"), SPOILED, ids=[f"{s[0]}-{s[2]}" for s in SPOILED]
)
def test_one_spoiled_number_fails_and_its_line_is_reported(folder, name, row, column, error, failing):
    folder.copy(name, rows=ROWS.get(name))
    line = folder.add(name, row, column, error)
    failed = failures(folder, name)
    assert failing <= set(failed)
    assert all(f"{name} line {line} " in outcome.where for outcome in failed.values())


def test_times_that_no_integration_reaches_are_reported(folder):
    folder.copy("attitude_c_dipole.csv", rows=6)
    folder.put("attitude_c_dipole.csv", 5, "t_s", lambda text: "1e15")
    with pytest.raises(HarnessError, match=r"column t_s: the 1e\+15 s before it take more than 10000"):
        failures(folder, "attitude_c_dipole.csv")


def test_a_quote_without_its_end_is_reported(folder):
    folder.copy("eclipse.csv")
    folder.put("eclipse.csv", 3, "class", lambda text: '"umbra')
    with pytest.raises(HarnessError, match="line "):
        failures(folder, "eclipse.csv")


@pytest.mark.long
def test_words_count_too(folder):
    for name in ("eclipse.csv", "floquet.csv"):
        folder.copy(name)
    line = folder.put("eclipse.csv", 3, "class", lambda text: {"umbra": "sunlit"}.get(text, "umbra"))
    assert f"line {line} " in failures(folder, "eclipse.csv")["class"].where
    line = folder.put("floquet.csv", 3, "gg", lambda text: "unstable" if text == "stable" else "stable")
    assert f"line {line} " in failures(folder, "floquet.csv")["gravity"].where
    folder.put("floquet.csv", 0, "stable", lambda text: "-1")
    assert "stable" in failures(folder, "floquet.csv")


class TestOtherCases:
    """Nothing of a case stands in the code: physics come from the header, rows and times from the table."""

    def test_a_header_that_says_something_else_fails_against_the_old_rows(self, folder):
        folder.copy("attitude_c_dipole.csv", rows=6)
        for old, new in (
            ("= 0.06 -0.035 0.09;", "= 0.06 -0.035 0.0901;"),
            ("mu_e = 7812000000000000.0 T", "mu_e = 7822000000000000.0 T"),
            ("row-major) = 2 0 0 0 3 0 0 0 3.2", "row-major) = 2 0 0 0 3.001 0 0 0 3.2"),
            (
                "mhat (constant, inertial) = 0.118771137369734",
                "mhat (constant, inertial) = 0.118781137369734",
            ),
            ("gravity gradient ON", "gravity gradient OFF"),
            ("w0_rad_s (body) = 0.004", "w0_rad_s (body) = 0.00400001"),
        ):
            folder.copy("attitude_c_dipole.csv", rows=6)
            assert not failures(folder, "attitude_c_dipole.csv")
            folder.edit("attitude_c_dipole.csv", old, new)
            assert "attitude" in failures(folder, "attitude_c_dipole.csv"), new
        folder.copy("attitude_c_dipole.csv", rows=6)
        folder.edit("attitude_c_dipole.csv", "mu = 398600441800000", "mu = 398610441800000")
        assert "position" in failures(folder, "attitude_c_dipole.csv")

    def test_another_body_with_other_times_under_another_name(self, folder):
        """A spinning top: J (3, 3, 5), spin 0.1 rad/s, its cone known in closed form, rows 7.5 s apart."""
        folder.copy("attitude_a_torquefree.csv", rows=1, as_name="attitude_top.csv")
        path = folder.path / "attitude_top.csv"
        head = [line for line in path.read_text().splitlines() if line.startswith("#")]
        head = [replaced(line) for line in head]
        path.write_text("\n".join(head + top_rows([0.0, 7.5, 15.0, 31.0])) + "\n")
        outcomes = check(folder, "attitude_top.csv")
        assert {outcome.verdict for outcome in outcomes} == {ClaimVerdict.PASS}
        assert {outcome.claim.id.split(".")[1] for outcome in outcomes} == {"attitude_top"}

    def test_columns_are_found_by_name(self, folder):
        path = folder.copy("triad_mekf.csv", rows=5)
        lines = path.read_text().splitlines()
        turned = [
            line if line.startswith("#") else ",".join(reversed(line.split(","))) + ",0" for line in lines
        ]
        head = next(i for i, line in enumerate(turned) if not line.startswith("#"))
        turned[head] = turned[head].removesuffix(",0") + ",more"
        path.write_text("\r\n".join(turned) + "\r\n")
        assert not failures(folder, "triad_mekf.csv")

    def test_one_row_is_enough(self, folder):
        for name in ("igrf14.csv", "earth_sun.csv", "eclipse.csv", "floquet.csv", "triad_mekf.csv"):
            folder.copy(name, rows=1)
            assert not failures(folder, name)


def replaced(line):
    for start, values in (("# J (kg m^2", "3 0 0 0 3 0 0 0 5"), ("# w0_rad_s", "0.04 0 0.1")):
        if line.startswith(start):
            return f"{line.partition(' = ')[0]} = {values}"
    if line.startswith("# q0 (body"):
        return f"{line.partition(' = ')[0]} = 1 0 0 0"
    if line.startswith("# C0"):
        return f"{line.partition(' = ')[0]} = 1 0 0 0 1 0 0 0 1"
    return line


def top_rows(times):
    """The body turns about the fixed momentum L at |L|/3 and about its own axis 3 at w3 (1 - 5/3)."""
    momentum = np.array([3.0 * 0.04, 0.0, 5.0 * 0.1])
    length = np.linalg.norm(momentum)
    own = 0.1 * (1.0 - 5.0 / 3.0)
    r0, v0 = (
        np.array([4929130.003, 3518474.427, 3453538.36]),
        np.array([-2324.199581, -3111.146978, 6492.122503]),
    )
    rows = ["t_s,q0,q1,q2,q3,omega_x_rad_s,omega_y_rad_s,omega_z_rad_s,r_eci_x_km,r_eci_y_km,r_eci_z_km"]
    for t in times:
        a, b = 0.5 * length / 3.0 * t, 0.5 * own * t
        p = (cos(a), *(sin(a) * momentum / length))
        q = (
            p[0] * cos(b) - p[3] * sin(b),
            p[1] * cos(b) + p[2] * sin(b),
            p[2] * cos(b) - p[1] * sin(b),
            p[3] * cos(b) + p[0] * sin(b),
        )
        turn = own * t
        omega = (0.04 * cos(turn), -0.04 * sin(turn), 0.1)
        r_km = 1e-3 * two_body(r0, v0, MU_M3PS2, np.array([t]))[0]
        rows.append(",".join(repr(float(value)) for value in (t, *q, *omega, *r_km)))
    return rows


def test_elements_of_slow_orbits_are_left_out(folder):
    path = folder.copy("tle.txt")
    geostationary = (
        "1 25544U 98067A   15086.11593543  .00000000  00000-0  00000-0 0  9991",
        "2 25544   0.0100  36.4208 0008932 173.8349 186.2944  1.00270000121359",
    )
    path.write_text("\n".join(["FAR", *geostationary, path.read_text()]))
    assert {outcome.verdict for outcome in check(folder, "tle.txt")} == {ClaimVerdict.PASS}
    path.write_text("\n".join(["FAR", *geostationary]))
    with pytest.raises(HarnessError, match="no elements of an orbit under 225 minutes"):
        check(folder, "tle.txt")


def test_the_edge_of_the_cylinder_may_be_meant_either_way(folder):
    """A satellite that grazes it within 0.3 km is lit or not; one further in is not."""
    folder.copy("eclipse.csv", rows=1)
    path = folder.path / "eclipse.csv"
    *head, row = path.read_text().splitlines()
    names, fields = head[-1].split(","), row.split(",")
    for behind_km, aside_km, known in (
        (7000.0, 6378.3, (0, 1)),
        (7000.0, 6377.0, (0,)),
        (7000.0, 6379.0, (1,)),
    ):
        place = {"sat_x_km": -behind_km, "sat_y_km": aside_km, "sat_z_km": 0.0}
        place |= {"sun_x_km": 149.6e6, "sun_y_km": 0.0, "sun_z_km": 0.0}
        for lit in (0, 1):
            values = {**dict(zip(names, fields, strict=True)), **place, "lit_cylinder": lit}
            path.write_text("\n".join([*head, ",".join(str(values[name]) for name in names)]))
            assert ("cylinder" not in failures(folder, "eclipse.csv")) == (lit in known)


class TestMalformed:
    """One sentence that names file, line and column."""

    @pytest.mark.parametrize("text", ["", "abc", "nan", "inf", "1,5 "])
    def test_a_field_that_is_no_number(self, folder, text):
        folder.copy("eclipse.csv")
        line = folder.put("eclipse.csv", 2, "sun_z_km", lambda _: text)
        with pytest.raises(HarnessError, match=rf"eclipse.csv, line {line}, column "):
            check(folder, "eclipse.csv")

    def test_a_time_that_is_none(self, folder):
        folder.copy("igrf14.csv")
        for text in ("yesterday", "2025-01-01T00:00:00", "2025-13-01T00:00:00Z"):
            line = folder.put("igrf14.csv", 2, "utc_iso", lambda _, text=text: text)
            with pytest.raises(HarnessError, match=f"igrf14.csv, line {line}, column utc_iso: '{text}'"):
                check(folder, "igrf14.csv")

    def test_a_time_outside_the_model(self, folder):
        folder.copy("igrf14.csv")
        line = folder.put("igrf14.csv", 2, "utc_iso", lambda _: "2031-01-01T00:00:00Z")
        with pytest.raises(HarnessError, match=f"line {line}, column utc_iso: .*1900 to 2030"):
            check(folder, "igrf14.csv")

    def test_a_column_that_is_missing(self, folder):
        folder.copy("floquet.csv")
        folder.edit("floquet.csv", ",k_a,", ",ka,")
        with pytest.raises(HarnessError, match=r"floquet.csv, line 15: there is no column k_a"):
            check(folder, "floquet.csv")

    def test_a_row_that_is_cut(self, folder):
        path = folder.copy("floquet.csv")
        path.write_text(path.read_text().rstrip().rpartition(",")[0])
        with pytest.raises(HarnessError, match=r"floquet.csv, line 27, column gg: 24 fields, but 25 names"):
            check(folder, "floquet.csv")

    @pytest.mark.parametrize("text", ["", "# only comments\n", "a,b\n"])
    def test_a_file_without_rows(self, folder, text):
        (folder.path / "floquet.csv").write_text(text)
        with pytest.raises(HarnessError, match=r"floquet.csv: no rows"):
            check(folder, "floquet.csv")

    def test_bytes_that_are_no_text(self, folder):
        (folder.path / "floquet.csv").write_bytes(b"# fine\n\xff\xfe\n")
        with pytest.raises(HarnessError, match=r"floquet.csv: cannot be read \(line 2 is not UTF-8"):
            check(folder, "floquet.csv")

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("# J (kg", "# I (kg", "no line 'J "),
            ("= 0.021 -0.034 0.012", "= 0.021 -0.034", "does not give 3 numbers"),
            ("= 1.9 0 0 0 2.6 0 0 0 3.1", "= 1.9 0 0 0 -2.6 0 0 0 3.1", "not positive definite"),
            ("mu = 398600441800000 ", "mu = -398600441800000 ", r"mu is -3.986e\+14, and no planet's"),
            ("mu = 398600441800000 ", "mu = 0 ", "mu is 0, and no planet's"),
            ("v0_m_s = -2324.199581 -3111", "v0_m_s = -2324.199581 -13111", "no closed orbit"),
            (
                "= 0.31858282764371 -0.21269536111609 -0.48929929195757 0.78348699298715",
                "= 0 0 0 0",
                "q0 is zero",
            ),
        ],
    )
    def test_a_header_that_lacks_something(self, folder, old, new, says):
        folder.copy("attitude_a_torquefree.csv", rows=2)
        folder.edit("attitude_a_torquefree.csv", old, new)
        with pytest.raises(HarnessError, match=rf"attitude_a_torquefree.csv.*{says}"):
            check(folder, "attitude_a_torquefree.csv")

    def test_times_that_fall(self, folder):
        folder.copy("attitude_a_torquefree.csv", rows=4)
        line = folder.put("attitude_a_torquefree.csv", 2, "t_s", lambda _: "60")
        with pytest.raises(HarnessError, match=f"line {line}, column t_s: times must rise"):
            check(folder, "attitude_a_torquefree.csv")

    def test_elements_with_a_wrong_digit(self, folder):
        folder.copy("tle.txt")
        folder.edit("tle.txt", "98.6946", "98.6947")
        with pytest.raises(HarnessError, match=r"tle.txt, line 4: .*checksum"):
            check(folder, "tle.txt")

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("# nothing\n", "no elements"),
            ("A\nB\n", "line 2, column 1: element line 1 is missing"),
            ("A\n", "no elements follow the name A"),
            ("A\n1 22826U\nB\n", "line 2: element line 2 does not follow"),
        ],
    )
    def test_elements_that_are_incomplete(self, folder, text, says):
        (folder.path / "tle.txt").write_text(text)
        with pytest.raises(HarnessError, match=f"tle.txt.*{says}"):
            check(folder, "tle.txt")


def test_what_is_not_there_is_absent_and_does_not_fail(folder):
    folder.copy("eclipse.csv", rows=3)
    (folder.path / "notes.txt").write_text("of no interest")
    studies = reference.studies(folder.path)
    outcomes = [outcome for study in studies for outcome in study.conclude([task() for task in study.tasks])]
    absent = {outcome.claim.id for outcome in outcomes if outcome.verdict is ClaimVerdict.ABSENT}
    assert absent == {
        f"reference.{stem}" for stem in ("igrf14", "earth_sun", "attitude", "floquet", "triad_mekf", "tle")
    }
    assert {outcome.verdict for outcome in outcomes} == {ClaimVerdict.PASS, ClaimVerdict.ABSENT}


def test_a_folder_without_any_of_them_is_refused(folder):
    with pytest.raises(HarnessError, match=r"holds none of the reference files igrf14\.csv, .*tle\.txt"):
        reference.studies(folder.path)
    with pytest.raises(HarnessError, match="is no folder"):
        reference.studies(folder.path / "nowhere")


class TestYears:
    """The onboard model has fewer years than the plant's: it is compared in its own."""

    ONBOARD = ("onboard", "onboard_reference")

    def verdicts(self, folder):
        outcomes = {one.claim.id.rpartition(".")[2]: one.verdict for one in check(folder, "igrf14.csv")}
        return {outcomes[name] for name in self.ONBOARD}

    def test_without_a_row_in_them_nothing_is_claimed_of_it(self, folder):
        folder.copy("igrf14.csv", rows=3)
        for row in range(3):
            folder.put("igrf14.csv", row, "utc_iso", lambda _: "2010-06-01T00:00:00Z")
        assert self.verdicts(folder) == {ClaimVerdict.ABSENT}
        assert set(failures(folder, "igrf14.csv")) == {"plant", "decimal_years"}

    def test_a_row_beyond_them_counts_for_nothing_and_the_others_keep_their_lines(self, folder):
        folder.copy("igrf14.csv", rows=4)
        folder.put("igrf14.csv", 0, "utc_iso", lambda _: "2010-06-01T00:00:00Z")
        assert self.verdicts(folder) == {ClaimVerdict.PASS}
        line = folder.add("igrf14.csv", 2, "b_ecef_y_nT", 2e-3)
        assert f"igrf14.csv line {line} " in failures(folder, "igrf14.csv")["onboard_reference"].where


def test_columns_that_no_check_reads_are_reported(folder):
    folder.copy("triad_mekf.csv", rows=3)
    unused = reference.check_file(folder.path / "triad_mekf.csv", "triad_mekf.csv").unused
    assert {"lambda", "p_triad_xx", "sep_deg"} <= set(unused)
    assert not {"q_triad_0", "p_dav_xx", "gap"} & set(unused)
