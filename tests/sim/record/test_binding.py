"""The digests in run.json: every byte of every file counts, none is written for what is not finished."""

import hashlib
import json
import shutil

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.errors import HarnessError
from sim.record import binding, run_dir
from sim.record.binding import FILES, BindingError, bind, compare, require_sources, sign_run
from sim.record.run_dir import BUS_LOG, DIGESTS, RUN, SCENARIO, SUMMARY, TRUTH
from sim.report.conclude import conclude


@pytest.fixture(scope="module")
def whole(recorded_run, tmp_path_factory):
    """A finished run; for reading only."""
    path = shutil.copytree(recorded_run, tmp_path_factory.mktemp("bound") / "run")
    conclude(path)
    return path


@pytest.fixture
def run(whole, tmp_path):
    return shutil.copytree(whole, tmp_path / "run")


def told(run, **changes):
    """Change run.json; a key that is changed to None is taken out."""
    content = json.loads((run / RUN).read_text()) | changes
    gone = {key for key, value in changes.items() if value is None}
    (run / RUN).write_text(json.dumps({key: value for key, value in content.items() if key not in gone}))


class TestWhatIsBound:
    @pytest.mark.long
    def test_a_finished_run_has_the_digest_of_each_file(self, whole):
        kept = binding.digests(run_dir.read_run(whole))
        assert kept == {name: hashlib.sha256((whole / name).read_bytes()).hexdigest() for name in FILES}
        assert compare(whole) == ({}, "")

    @pytest.mark.long
    def test_a_run_that_has_just_begun_has_that_of_its_scenario_alone(self, whole, tmp_path):
        scenario = run_dir.read_scenario(whole)
        run_dir.begin(tmp_path / "new", scenario, 1, 10, "virtual", run_dir.Pace())
        assert set(binding.digests(run_dir.read_run(tmp_path / "new"))) == {SCENARIO}
        assert compare(tmp_path / "new") == ({}, "")

    def test_a_run_that_has_been_flown_but_not_concluded_says_what_is_not_bound(self, recorded_run):
        assert compare(recorded_run) == ({}, "the run was not finished: no digests of truth.h5")

    def test_without_a_run_json_nothing_is(self, tmp_path):
        assert compare(tmp_path) == ({}, "")

    @pytest.mark.long
    def test_what_is_bound_stays_bound_as_it_is(self, run):
        before = (run / RUN).read_bytes()
        for name in FILES:
            (run / name).write_bytes(b"other")
        bind(run, *FILES[1:])
        assert (run / RUN).read_bytes() == before

    @pytest.mark.parametrize(
        "kept", [[], 3, "text", {"bus.log": 3}, {"../x": "00"}, {"": "00"}, {"a\0": "0"}]
    )
    def test_malformed_digests_are_reported(self, run, kept):
        told(run, digests=kept)
        with pytest.raises(HarnessError, match="digests"):
            compare(run)


class TestMismatch:
    @pytest.mark.long
    @pytest.mark.parametrize("name", FILES)
    def test_any_bit_of_any_file_counts(self, whole, tmp_path, name):
        run = shutil.copytree(whole, tmp_path / "run")
        content = (run / name).read_bytes()

        @settings(max_examples=100, deadline=None)
        @given(st.integers(0, len(content) - 1), st.integers(1, 255))
        def flip(place, change):
            altered = bytearray(content)
            altered[place] ^= change
            (run / name).write_bytes(altered)
            found = compare(run)
            assert set(found.mismatches) == {name}
            assert found.mismatches[name].startswith(f"{name} is not the run's own: its SHA-256 begins with ")
            assert found.lines == [f"MISMATCH {found.mismatches[name]}"]

        flip()

    @pytest.mark.parametrize("name", FILES)
    def test_so_do_one_byte_less_or_more_and_a_file_that_is_gone(self, run, name):
        content = (run / name).read_bytes()
        for other in (content[:-1], content + b"\n", b""):
            (run / name).write_bytes(other)
            assert set(compare(run).mismatches) == {name}
        (run / name).unlink()
        assert compare(run).mismatches == {name: f"{name} is missing, and run.json has its digest"}

    def test_each_is_reported(self, run):
        for name in FILES:
            (run / name).write_bytes(b"other")
        assert set(compare(run).mismatches) == set(FILES)

    def test_a_log_of_another_name_is_held_against_the_digest_of_the_runs_log(self, run):
        copied = shutil.copy(run / BUS_LOG, run / "copied.log")
        assert compare(run, run / "copied.log").holds
        with open(copied, "ab") as log:
            log.write(b"\n")
        assert (
            compare(run, run / "copied.log").mismatches[BUS_LOG].startswith("copied.log is not the run's own")
        )
        assert compare(run).holds

    def test_a_log_of_another_name_is_not_bound_where_the_runs_log_is_not(self, run):
        told(run, digests={})
        (run / BUS_LOG).rename(run / "moved.log")
        assert "bus.log" not in compare(run).note
        assert "no digests of bus.log, " in compare(run, run / "moved.log").note

    def test_long_files_are_read_with_a_bar(self, run, monkeypatch):
        shown = []

        class Bar:
            def __init__(self, what, total):
                self.what, self.total = what, total

            def __enter__(self):
                return lambda done: shown.append((self.what, done, self.total))

            def __exit__(self, *error):
                pass

        monkeypatch.setattr(binding, "progress", Bar)
        monkeypatch.setattr(binding, "BAR_FROM", 10_000)
        monkeypatch.setattr(binding, "CHUNK", 10_000)
        assert compare(run).holds
        size = (run / BUS_LOG).stat().st_size
        done = [done for what, done, total in shown if (what, total) == ("reading bus.log", size)]
        assert done == sorted(done)
        assert len(done) > 5
        assert done[-1] == size
        assert not any("summary.json" in what for what, *_ in shown)


class TestOlderRuns:
    def test_are_reported_as_older(self, run):
        told(run, **{DIGESTS: None})
        (run / BUS_LOG).write_bytes(b"other")
        assert compare(run) == (
            {},
            "run.json is of an older version: no digests of bus.log, truth.h5, summary.json",
        )

    @pytest.mark.long
    def test_stay_so_when_their_summary_is_rebuilt(self, run):
        told(run, **{DIGESTS: None})
        before = (run / RUN).read_bytes()
        conclude(run)
        assert json.loads((run / RUN).read_bytes()) == json.loads(before)


class TestRebuilding:
    @pytest.mark.long
    def test_a_sound_run_is_bound_as_before(self, run):
        before = (run / RUN).read_bytes()
        conclude(run)
        assert (run / RUN).read_bytes() == before
        assert compare(run).holds

    @pytest.mark.long
    def test_a_summary_that_comes_out_otherwise_is_bound_anew(self, run):
        flown = run_dir.read_run(run)["flown"]
        told(run, flown=flown | {"wall_s": 1.25})
        conclude(run)
        assert json.loads((run / SUMMARY).read_text())["wall_seconds"] == 1.25
        assert compare(run) == ({}, "")

    @pytest.mark.long
    @pytest.mark.parametrize("name", [SCENARIO, BUS_LOG, TRUTH])
    def test_no_digest_of_a_source_is_ever_replaced(self, run, fly_run, name):
        shutil.copy(fly_run(seed=8, ticks=300, **{"control": {"k_w": 1.0}}) / name, run / name)
        before = binding.digests(run_dir.read_run(run))[name]
        with pytest.raises(BindingError, match=f"{name} is not the run's own") as caught:
            require_sources(run, None)
        assert caught.value.exit_code == 1
        conclude(run)
        assert binding.digests(run_dir.read_run(run))[name] == before
        assert name in compare(run).mismatches

    def test_a_summary_that_was_edited_does_not_hinder_it(self, run):
        (run / SUMMARY).write_text("{}")
        assert set(require_sources(run, None).mismatches) == {SUMMARY}

    @pytest.mark.long
    def test_a_run_that_was_killed_gets_no_digest_of_what_it_has(self, run):
        told(run, flown=None, digests={}, complete=False)
        conclude(run)
        found = compare(run)
        assert found.note == "the run was not finished: no digests of bus.log, truth.h5, summary.json"
        assert found.holds


class TestSigning:
    class Key:
        def sign(self, data):
            return b"signed"

    def test_a_run_that_is_not_whole_is_not_signed(self, run):
        (run / SUMMARY).write_text("{}")
        with pytest.raises(BindingError, match=r"is not signed: summary\.json is not the run's own"):
            sign_run(run, self.Key())
        told(run, **{DIGESTS: None})
        for _ in range(2):
            with pytest.raises(
                BindingError,
                match=r"is not signed: run\.json has no digests of bus\.log, truth\.h5, summary\.json",
            ):
                sign_run(run, self.Key())
            for name in FILES[1:]:
                (run / name).unlink(missing_ok=True)
        assert not (run / "run.json.sig").exists()
