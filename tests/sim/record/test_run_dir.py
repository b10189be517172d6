"""The run directory: begun incomplete, replaced atomically, found again."""

import json
import subprocess
import sys
from threading import Event, Thread

import pytest

from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.pace import Pace
from sim.scenario.schema import flight_table, load, parse_settings


@pytest.fixture
def scenario():
    settings = parse_settings(("time.tick_hz=4", "coils.backoff=per_coil", "flight.modes.near_deg=15.0"))
    return load("microsat", settings)


@pytest.fixture
def begun(tmp_path, scenario):
    path = tmp_path / "some" / "run"
    run_dir.begin(path, scenario, seed=7, ticks=1234, bus="loop:28011", pace=Pace(2.5))
    return path


class TestBegin:
    def test_run_json_says_what_will_be_flown_and_that_it_has_not_been(self, begun, scenario):
        run = run_dir.read_run(begun)
        assert run["complete"] is False
        assert (run["scenario"], run["seed"], run["ticks"], run["bus"]) == ("microsat", 7, 1234, "loop:28011")
        assert (run["pace"], run["pace_factor"]) == ("realtime", 2.5)
        assert run["schema_version"] == run_dir.SCHEMA_VERSION
        assert run["torquer_version"]
        assert run["flight_table_crc"] == f"{flight_table(scenario).crc:08x}"
        assert len(run["scenario_sha256"]) == 64
        assert run["platform"] == run_dir.fingerprint()

    def test_lockstep(self, tmp_path, scenario):
        run_dir.begin(tmp_path / "run", scenario, 1, 10, "virtual", Pace())
        run = run_dir.read_run(tmp_path / "run")
        assert (run["pace"], run["pace_factor"]) == ("lockstep", None)

    def test_the_scenario_reads_back_as_it_was_flown(self, begun, scenario):
        assert run_dir.read_scenario(begun) == scenario
        assert flight_table(run_dir.read_scenario(begun)).crc == flight_table(scenario).crc

    @pytest.mark.parametrize("name", ["microsat", "cubesat3u", "posat1"])
    def test_so_does_every_scenario_that_ships(self, tmp_path, name):
        run_dir.begin(tmp_path / "run", load(name), 1, 10, "virtual", Pace())
        assert run_dir.read_scenario(tmp_path / "run") == load(name)

    @pytest.mark.parametrize("name", [run_dir.RUN, run_dir.BUS_LOG])
    def test_a_run_that_is_there_is_never_overwritten(self, tmp_path, scenario, name):
        (tmp_path / name).write_text("precious")
        with pytest.raises(HarnessError, match="already holds a run: choose another --out"):
            run_dir.begin(tmp_path, scenario, 1, 10, "virtual", Pace())
        assert (tmp_path / name).read_text() == "precious"

    def test_a_folder_that_cannot_be_written_is_reported(self, tmp_path, scenario):
        (tmp_path / "file").write_text("")
        with pytest.raises(HarnessError, match="cannot be written") as caught:
            run_dir.begin(tmp_path / "file" / "run", scenario, 1, 10, "virtual", Pace())
        assert caught.value.exit_code == 2


class TestUpdate:
    def test_changes_what_it_names_and_keeps_the_rest(self, begun):
        before = run_dir.read_run(begun)
        run_dir.update(begun, complete=True, flown={"ticks": 3})
        assert run_dir.read_run(begun) == {**before, "complete": True, "flown": {"ticks": 3}}

    def test_leaves_nothing_else_behind(self, begun):
        names = {file.name for file in begun.iterdir()}
        for number in range(5):
            run_dir.update(begun, number=number)
        assert {file.name for file in begun.iterdir()} == names == {run_dir.RUN, run_dir.SCENARIO}

    @pytest.mark.long
    def test_who_reads_meanwhile_always_finds_a_whole_file(self, begun):
        stop, torn = Event(), []

        def read():
            while not stop.is_set():
                try:
                    assert run_dir.read_run(begun)["seed"] == 7
                except (HarnessError, AssertionError, KeyError) as error:
                    torn.append(error)

        reader = Thread(target=read)
        reader.start()
        for number in range(300):
            run_dir.update(begun, padding="x" * (number * 37 % 5000))
        stop.set()
        reader.join()
        assert torn == []

    @pytest.mark.long
    def test_a_kill_leaves_a_whole_file(self, begun):
        code = (
            "import sys; from pathlib import Path; from sim.record import run_dir\n"
            f"path = Path({str(begun)!r}); print('go', flush=True)\n"
            "n = 0\n"
            "while True:\n    n += 1; run_dir.update(path, padding='y' * (n % 9000))\n"
        )
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
        assert process.stdout.readline() == b"go\n"
        process.stdout.close()
        process.kill()
        process.wait()
        assert run_dir.read_run(begun)["seed"] == 7


class TestReading:
    def test_no_run_directory(self, tmp_path):
        with pytest.raises(HarnessError, match=r"is no run directory: it has no run\.json"):
            run_dir.read_run(tmp_path)

    def test_a_run_json_that_is_none(self, tmp_path):
        (tmp_path / run_dir.RUN).write_text("{")
        with pytest.raises(HarnessError, match=r"run\.json: not JSON"):
            run_dir.read_run(tmp_path)

    def test_a_run_json_that_is_complete_without_an_outcome(self, begun):
        content = run_dir.read_run(begun)
        run_dir.write_json(begun / run_dir.RUN, {**content, "complete": True})
        with pytest.raises(HarnessError, match=r"run\.json: complete is true, but flown") as refusal:
            run_dir.read_run(begun)
        assert refusal.value.exit_code == 2

    def test_a_scenario_that_is_no_longer_valid(self, begun):
        file = begun / run_dir.SCENARIO
        file.write_text(file.read_text().replace("angle_deg", "angel_deg"))
        with pytest.raises(HarnessError, match=r"initial\.angel_deg is not a known key"):
            run_dir.read_scenario(begun)

    def test_locate(self, begun, tmp_path):
        log = begun / run_dir.BUS_LOG
        with pytest.raises(HarnessError, match=r"has no bus\.log"):
            run_dir.locate(begun)
        log.write_text("")
        assert run_dir.locate(begun) == (log, begun)
        assert run_dir.locate(log) == (log, begun)
        with pytest.raises(HarnessError, match="does not exist"):
            run_dir.locate(tmp_path / "nowhere")


def test_the_default_place_is_among_the_runs(tmp_path, monkeypatch, scenario):
    monkeypatch.chdir(tmp_path)
    path = run_dir.new_folder(scenario)
    assert path.parts[0] == "runs"
    assert path.name.startswith("microsat-")


def test_the_fingerprint_tells_what_decides_about_the_last_bit():
    print_of = run_dir.fingerprint()
    assert set(print_of) >= {"machine", "cpu", "python", "numpy", "simd", "blas"}
    assert json.loads(json.dumps(print_of)) == print_of == run_dir.fingerprint()
    assert print_of["python"] == ".".join(map(str, sys.version_info[:3]))
