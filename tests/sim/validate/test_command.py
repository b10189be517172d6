"""``torquer validate``: which files are checked, what it prints and writes, and how it ends."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from click.testing import CliRunner

from sim.campaign.flight import FlightResult, Order
from sim.campaign.study import Figure, Group, campaign
from sim.design.time_optimal_slew import NoSlewError
from sim.errors import HarnessError
from sim.validate import command
from sim.validate.outcomes import read_record
from sim.validate.reference import reference
from sim.validate.reference.reference_table import DATA
from torquer.cli.main import main


class TestCommand:
    def call(self, *words):
        return CliRunner().invoke(main, ["validate", "--workers", "1", *map(str, words)])

    def test_reference_files_that_agree(self, folder):
        folder.copy("eclipse.csv", rows=4)
        folder.copy("earth_sun.csv", rows=4)
        page = folder.path / "deep" / "page.md"
        result = self.call("--reference", folder.path, "--out", page)
        assert result.exit_code == 0
        assert "17 claims met, 0 failed (reference file 17 of 17), 5 absent" in result.stdout
        assert "| eclipse.csv | 4 | kind, " in page.read_text()
        assert page.read_text().count("| PASS |") == 17

    def test_one_that_does_not_is_exit_code_1(self, folder):
        folder.copy("eclipse.csv", rows=20)
        line_number = folder.add("eclipse.csv", 12, "frac_planar", 1e-5)
        result = self.call("--reference", folder.path)
        assert result.exit_code == 1
        failed = [text for text in result.stdout.splitlines() if text.startswith("FAIL")]
        assert len(failed) == 1
        assert f"eclipse.csv line {line_number} " in failed[0]

    def test_malformed_files_are_one_sentence_and_exit_code_2(self, folder):
        folder.copy("eclipse.csv", rows=4)
        line_number = folder.put("eclipse.csv", 2, "sun_x_km", lambda _: "far")
        result = self.call("--reference", folder.path)
        assert result.exit_code == 2
        expected = f"torquer: {folder.path / 'eclipse.csv'}, line {line_number}, column sun_x_km: 'far'"
        assert result.stderr == f"{expected} is no finite number\n"

    def test_nothing_to_check_by_is_exit_code_2(self, folder, monkeypatch):
        folder.copy("eclipse.csv", rows=4)
        page = folder.path / "page.md"
        one = self.call("--reference", folder.path, "--only", "reference.igrf14", "--out", page)
        assert (one.exit_code, one.stderr.count("\n")) == (2, 1)
        assert f"nothing was checked: {folder.path} does not hold igrf14.csv" in one.stderr
        assert not page.exists()
        monkeypatch.setattr(reference.shipped_studies, "__defaults__", (folder.path,))
        for words in ((), ("--only", "reference")):
            bare = self.call(*words)
            assert (bare.exit_code, bare.stderr.count("\n")) == (2, 1)
            assert "the reference data are not installed: igrf14.csv, earth_sun.csv, att" in bare.stderr

    def test_a_population_of_which_no_satellite_is_left_is_told(self):
        result = self.call("--only", "population.50kg_per_coil", "--satellites", "1")
        assert result.exit_code == 2
        assert result.stderr == (
            "torquer: nothing was checked: --satellites 1 leaves none that there are claims on, of "
            "population.50kg_per_coil.isolated, population.50kg_per_coil.pointing\n"
        )

    @pytest.mark.parametrize("words", [("--reference", "nowhere"), ("--only", "nothing"), ("--workers", "0")])
    def test_what_cannot_be_done_is_exit_code_2(self, words):
        result = self.call(*words)
        assert result.exit_code == 2
        assert result.stderr.startswith("torquer: ")
        assert result.stderr.count("\n") == 1

    @pytest.mark.parametrize(
        ("words", "says"),
        [
            (("--junit", "page.md"), "--junit page.md and --out page.md are the same file"),
            (
                ("--record", "--junit", "page.json"),
                "--junit page.json and the outcomes page.json are the same",
            ),
        ],
    )
    def test_each_result_is_a_file_of_its_own(self, words, says, tmp_path, monkeypatch, study):
        monkeypatch.setattr(command, "all_studies", lambda satellites: [study("a", [1.0])])
        monkeypatch.chdir(tmp_path)
        result = self.call("--out", "page.md", *words)
        assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)
        assert says in result.stderr
        assert list(tmp_path.iterdir()) == []

    def test_no_result_takes_the_place_of_the_data(self, folder):
        folder.copy("eclipse.csv", rows=4)
        data = folder.path / "eclipse.csv"
        before = data.read_bytes()
        result = self.call("--reference", folder.path, "--out", data)
        assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
        assert f"--out {data} and eclipse.csv of the data {data} are the same file" in result.stderr
        assert data.read_bytes() == before

    def test_only_a_whole_validation_writes_the_page_by_itself(self, tmp_path, monkeypatch, study):
        parts = [study("a", [1.0]), study("b", [2.0], has_flights=True)]
        monkeypatch.setattr(command, "all_studies", lambda satellites: parts)
        monkeypatch.setattr(command, "find_repository", lambda start: tmp_path)
        page = tmp_path / "docs" / "validation.md"
        for words in (["--quick"], ["--only", "a"]):
            assert self.call(*words).exit_code == 0
            assert not page.exists()
        result = self.call()
        assert result.exit_code == 0
        assert page.read_text().count("| PASS |") == 2
        assert f"page: {page}" in result.stdout
        monkeypatch.setattr(command, "find_repository", lambda start: None)
        monkeypatch.chdir(tmp_path)
        self.call()
        assert (tmp_path / "validation.md").exists()

    def test_what_too_few_satellites_decide_is_told_and_is_no_failure(self, monkeypatch):
        """A median that a whole population would miss; and a healthy unit that is isolated, which fails."""
        order = Order("microsat")
        figures = [
            Figure("median", "Pointing", "deg", lambda flight: 9.0, "median", high=2.0),
            Figure("isolated", "Isolated", "1", lambda flight: flight.figures["isolated"], high=0.0),
        ]
        for isolated, code in ((0.0, 0), (1.0, 1)):
            few = campaign("population.x", "", [Group("", (order,))], figures, "satellites", 30)
            task = partial(FlightResult, order, {}, {"isolated": isolated})
            few = replace(few, tasks=(task,))
            monkeypatch.setattr(command, "all_studies", lambda satellites, few=few: [few])
            result = self.call("--satellites", "1")
            assert result.exit_code == code
            assert "too few to judge population.x.median: Pointing: 9 deg" in result.stdout
            assert "[1 of the 30 satellites that it is claimed for]" in result.stdout
            assert f"{1 - code} claim{'s' * code} met, {code} failed (" in result.stdout
            assert ", 1 too few to judge" in result.stdout
            assert "1 claim on a median or mean not judged: made for more satellites" in result.stderr

    def test_what_is_recorded_in_parts_is_one_page(self, tmp_path, monkeypatch, study):
        parts = [study("a", [1.0]), study("b", [20.0], has_flights=True)]
        monkeypatch.setattr(command, "all_studies", lambda satellites: parts)
        monkeypatch.setattr(command, "find_repository", lambda start: tmp_path)
        page = tmp_path / "docs" / "validation.md"
        assert self.call("--only", "b", "--record").exit_code == 1
        assert self.call("--only", "a", "--record").exit_code == 0
        assert "1 claim met, 1 failed (own, set afterwards 1 of 2)." in page.read_text()
        parts[0] = study("a", [7.0])
        assert self.call("--only", "a", "--record").exit_code == 0
        rows = [row for row in page.read_text().splitlines() if row.startswith("| sum of ")]
        assert [row.split(" | ")[2:] for row in rows] == [
            ["7", "", "<= 10", "own, set afterwards", "PASS |"],
            ["20 at of (20.0,)", "", "<= 10", "own, set afterwards", "FAIL |"],
        ]

    def test_claims_without_an_outcome_are_named_on_the_page_of_what_is_recorded(
        self, tmp_path, monkeypatch, study
    ):
        order = Order("microsat", {}, orbits=0.01)
        figures = [Figure(name, "", "1", lambda flight: 1.0) for name in ("error", "time")]
        parts = [study("a", [1.0]), campaign("b", "", [Group("", (order,))], figures)]
        monkeypatch.setattr(command, "all_studies", lambda satellites: parts)
        page = tmp_path / "page.md"
        assert self.call("--only", "a", "--record", "--out", page).exit_code == 0
        assert "Claimed, and not computed yet: b.error, b.time.\n" in page.read_text()
        assert self.call("--only", "b", "--record", "--out", page).exit_code == 0
        assert "not computed yet" not in page.read_text()

    def test_a_kill_while_outcomes_are_written_leaves_those_before(self, tmp_path, monkeypatch, study):
        parts = [study("a", [1.0])]
        monkeypatch.setattr(command, "all_studies", lambda satellites: parts)
        monkeypatch.setattr(command, "find_repository", lambda start: tmp_path)
        figures = tmp_path / "docs" / "validation.json"
        assert self.call("--only", "a", "--record").exit_code == 0
        before, parts[0] = figures.read_bytes(), study("a", [7.0])

        def killed(source, target):
            raise KeyboardInterrupt

        monkeypatch.setattr(Path, "replace", killed)
        assert self.call("--only", "a", "--record").exit_code != 0
        assert figures.read_bytes() == before

    @pytest.mark.parametrize(
        ("words", "why"),
        [
            (("--satellites", "2"), "--record is for outcomes of whole populations: leave out --satellites"),
            (("--reference", DATA), "--record is for outcomes by the reference files that ship"),
        ],
    )
    def test_outcomes_of_less_or_of_other_files_are_not_recorded(self, tmp_path, words, why):
        figures = tmp_path / "page.json"
        figures.write_text("{}")
        result = self.call("--record", *words, "--only", "reference.eclipse", "--out", tmp_path / "page.md")
        assert result.exit_code == 2
        assert result.stderr.startswith(f"torquer: {why}")
        assert result.stderr.count("\n") == 1
        assert figures.read_text() == "{}"

    def test_those_of_recorded_passes_are_of_other_claims_and_are_put_beside_them(
        self, tmp_path, monkeypatch, study
    ):
        monkeypatch.setattr(command, "all_studies", lambda satellites: [study("a", [1.0])])
        monkeypatch.setattr(command.claims, "studies", lambda folder: [study("flight-data", [2.0])])
        page = tmp_path / "page.md"
        assert self.call("--record", "--out", page).exit_code == 0
        assert self.call("--record", "--flight-data", tmp_path, "--out", page).exit_code == 0
        assert list(read_record(tmp_path / "page.json")) == ["a", "flight-data"]

    def test_each_study_that_is_done_is_recorded_at_once(self, tmp_path, monkeypatch, study):
        def stopped():
            raise KeyboardInterrupt

        parts = [study("a", [1.0]), study("b", [2.0]), replace(study("c", [3.0]), tasks=(stopped,))]
        monkeypatch.setattr(command, "all_studies", lambda satellites: parts)
        page = tmp_path / "page.md"
        assert self.call("--record", "--out", page).exit_code == 130
        known = read_record(tmp_path / "page.json")
        assert {name: one.ours for name, one in known.items()} == {"a": 1.0, "b": 2.0}
        assert page.read_text().count("| PASS |") == 2

    def test_a_page_that_outcomes_would_overwrite_is_refused(self, tmp_path):
        page = tmp_path / "page.json"
        result = self.call("--only", "jacobi", "--record", "--out", page)
        assert result.exit_code == 2
        assert "page.json: the outcomes beside the page would have its name" in result.stderr
        assert not page.exists()

    @pytest.mark.parametrize(
        "error",
        [HarnessError("the log tells too little"), AssertionError("too little"), NoSlewError("too little")],
    )
    def test_a_computation_that_breaks_off_fails_its_claim_alone(self, tmp_path, monkeypatch, study, error):
        def broken():
            raise error

        parts = [replace(study("a", [1.0]), tasks=(broken,)), study("b", [2.0])]
        monkeypatch.setattr(command, "all_studies", lambda satellites: parts)
        page = tmp_path / "page.md"
        result = self.call("--out", page)
        assert result.exit_code == 1
        failed, passed, *_ = result.stdout.splitlines()
        assert failed.startswith("FAIL   a: ")
        assert "too little" in failed
        assert passed.startswith("PASS   b: ")
        assert "1 claim met, 1 failed" in result.stdout
        assert "too little" in page.read_text()

    def test_a_file_that_ships_and_cannot_be_read_fails_its_claim(self, folder, monkeypatch):
        folder.copy("eclipse.csv", rows=4)
        folder.put("eclipse.csv", 2, "sun_x_km", lambda _: "far")
        monkeypatch.setattr(command, "all_studies", lambda satellites: reference.studies(folder.path))
        result = self.call("--only", "reference.eclipse")
        assert result.exit_code == 1
        assert "FAIL   reference.eclipse: " in result.stdout
        assert "column sun_x_km: 'far' is no finite number" in result.stdout

    @pytest.mark.long
    def test_flights_that_were_flown_are_not_flown_again(self, tmp_path, monkeypatch):
        monkeypatch.setenv("TORQUER_CACHE", str(tmp_path / "cache"))
        order = Order("microsat", seed=3, orbits=0.001)
        figures = [Figure("seconds", "", "s", lambda flight: flight.summary["sim_seconds"], low=1.0)]
        flown = campaign("a", "", [Group("", (order,))], figures)
        monkeypatch.setattr(command, "all_studies", lambda satellites: [flown])
        first, again = (self.call("--only", "a", "--workers", "1") for _ in range(2))
        assert (first.exit_code, again.exit_code) == (0, 0)
        assert "known" not in first.stderr
        assert f"{tmp_path / 'cache'}: 1 of 1 result known" in again.stderr
        assert first.stdout.splitlines()[0] == again.stdout.splitlines()[0]
