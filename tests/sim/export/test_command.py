"""``torquer export``: what it reads, what it says, and that its file is whole or not there."""

import gzip
import shutil
import sys

import pytest
from click.testing import CliRunner

from sim.export import command
from sim.record.candump import read_log
from torquer.cli.main import main


def call(*words):
    return CliRunner().invoke(main, ["export", *map(str, words)])


def one_sentence(result):
    assert result.exit_code == 2
    assert result.stderr.startswith("torquer: ")
    assert result.stderr.count("\n") == 1
    return result.stderr


@pytest.fixture
def csv_text(exported):
    return exported("csv").read_text()


@pytest.mark.long
def test_the_suffix_says_the_format_unless_an_option_does(flight, tmp_path, csv_text):
    said = call(flight.folder, "--out", tmp_path / "deep" / "table.dat", "--format", "csv")
    assert said.exit_code == 0
    assert said.stdout.splitlines()[0] == f"exported: {tmp_path / 'deep' / 'table.dat'}"
    assert (tmp_path / "deep" / "table.dat").read_text() == csv_text
    assert "say by --format which it is: mcap, blf, asc, csv, parquet, netcdf" in one_sentence(
        call(flight.folder, "--out", tmp_path / "table.dat")
    )
    assert "'mat' is not one of" in one_sentence(
        call(flight.folder, "--format", "mat", "--out", tmp_path / "t")
    )


@pytest.mark.long
def test_a_file_is_replaced_by_force_alone(flight, tmp_path, csv_text):
    out = tmp_path / "run.csv"
    out.write_text("mine")
    assert f"{out} already exists" in one_sentence(call(flight.folder, "--out", out))
    assert out.read_text() == "mine"
    assert call(flight.folder, "--out", out, "--force").exit_code == 0
    assert out.read_text() == csv_text


@pytest.mark.parametrize("name", ["bus.log", "truth.h5", "summary.json"])
def test_a_run_is_never_written_over(cut, name):
    before = {path.name: path.read_bytes() for path in cut.iterdir()}
    says = one_sentence(call(cut, "--format", "csv", "--out", cut / "." / name, "--force"))
    assert "is a file of the run itself" in says
    assert {path.name: path.read_bytes() for path in cut.iterdir()} == before


@pytest.mark.parametrize("fault", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_an_export_that_fails_leaves_what_was_there(flight, tmp_path, monkeypatch, fault):
    out = tmp_path / "run.csv"
    out.write_text("mine")

    def fail(source, path, watch):
        path.write_text("half")
        raise fault

    monkeypatch.setitem(command.FORMATS, "csv", command.FORMATS["csv"]._replace(write=fail))
    assert call(flight.folder, "--out", out, "--force").exit_code in (1, 130)
    assert out.read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]


@pytest.mark.parametrize("suffix", sorted({found.suffixes[0] for found in command.FORMATS.values()}))
def test_a_flight_that_was_cut_short_is_exported_as_far_as_it_goes(cut, tmp_path, suffix):
    done = call(cut, "--out", tmp_path / f"run{suffix}")
    assert done.exit_code == 1  # the log is not that of run.json
    assert (tmp_path / f"run{suffix}").stat().st_size > 1000
    assert "cut short" in done.stdout
    assert "MISMATCH" in done.stdout


@pytest.mark.long
def test_a_compressed_run_is_exported_as_any_other(flight, exported, tmp_path):
    folder = shutil.copytree(flight.folder, tmp_path / "run")
    with gzip.open(folder / "bus.log.gz", "wb") as file:
        file.write((folder / "bus.log").read_bytes())
    (folder / "bus.log").unlink()
    done = call(folder, "--out", tmp_path / "run.csv")
    assert done.exit_code == 0
    assert (tmp_path / "run.csv").read_text() == exported("csv").read_text()


def test_of_a_log_alone_there_is_the_log_and_no_histories(flight, tmp_path):
    log = shutil.copy(flight.folder / "bus.log", tmp_path / "any.log")
    assert call(log, "--out", tmp_path / "run.asc").exit_code == 0
    assert "there are no histories: export mcap, blf or asc" in one_sentence(
        call(log, "--out", tmp_path / "run.nc")
    )
    assert not (tmp_path / "run.nc").exists()


@pytest.mark.parametrize(
    ("name", "says"), [("nothing", "nothing does not exist"), ("empty", "empty has no bus.log")]
)
def test_what_is_no_run_is_one_sentence(tmp_path, monkeypatch, name, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    assert says in one_sentence(call(name, "--out", tmp_path / "run.csv"))


def test_a_line_stamped_without_end_is_one_sentence(tmp_path):
    log = tmp_path / "inf.log"
    log.write_text("(0.000000) can0 080#0000000000000000\n(inf) can0 123#00\n")
    assert "inf.log" in one_sentence(call(log, "--out", tmp_path / "out.asc"))


@pytest.mark.parametrize("suffix", ["mcap", "blf", "csv"])
def test_a_log_that_is_none_is_one_sentence(flight, tmp_path, suffix):
    folder = shutil.copytree(flight.folder, tmp_path / "run")
    (folder / "bus.log").write_text("no log\n")
    assert "not a candump log" in one_sentence(call(folder, "--out", tmp_path / f"out.{suffix}"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run"]


@pytest.mark.parametrize(
    ("suffix", "package", "extra"),
    [
        ("mcap", "foxglove", "export"),
        ("mcap", "cantools", "export"),
        ("parquet", "pyarrow", "export"),
        ("nc", "h5netcdf", "export"),
    ],
)
def test_a_package_that_is_missing_is_named_with_its_extra(
    flight, tmp_path, monkeypatch, suffix, package, extra
):
    dictionary = command.mcap.messages
    dictionary.cache_clear()
    monkeypatch.setitem(sys.modules, package, None)
    says = one_sentence(call(flight.folder, "--out", tmp_path / f"run.{suffix}"))
    assert f"pip install 'torquer[{extra}]'" in says
    assert list(tmp_path.iterdir()) == []
    dictionary.cache_clear()


@pytest.mark.long
def test_progress_comes_to_its_end(flight, tmp_path):
    source = command.open_source(flight.folder)
    for write, total in (
        (command.write_asc, command.LogPass(source.log).duration_us()),
        (command.write_csv, source.record["ticks"] - 1),
    ):
        seen = []
        write(source, tmp_path / "out", seen.append)
        assert seen == sorted(seen)
        assert seen[-1] == total > 0
    assert len(list(read_log(source.log))) > 1000
