"""Files that a command writes: none replaces what is read or written beside it, and each is whole."""

import os

import pytest

from sim.errors import HarnessError
from sim.result_files import check_results, whole_file, write_result, write_text


@pytest.fixture
def telemetry(tmp_path):
    path = tmp_path / "p.csv"
    path.write_text("kept")
    return path


@pytest.mark.parametrize(
    "name",
    ["p.csv", "below/../p.csv", "symbolic", "hard"],
    ids=["itself", "another path", "symbolic", "hard"],
)
def test_a_result_that_is_the_telemetry_is_refused_whatever_its_name(telemetry, tmp_path, name):
    (tmp_path / "symbolic").symlink_to(telemetry)
    os.link(telemetry, tmp_path / "hard")
    out = tmp_path / name
    with pytest.raises(HarnessError) as error:
        check_results({"--out": out, "--page": None}, {"the telemetry": telemetry, "the calibration": None})
    assert str(error.value) == (
        f"--out {out} and the telemetry {telemetry} are the same file: name another by --out"
    )
    assert telemetry.read_text() == "kept"


def test_two_results_are_two_files_and_nothing_is_made_before_that_is_known(telemetry, tmp_path):
    both = tmp_path / "new" / "x"
    with pytest.raises(HarnessError, match=r"^--page .*x and --out .*x are the same file"):
        check_results({"--out": both, "--page": both}, {"the telemetry": telemetry})
    assert not both.parent.exists()


def test_what_cannot_be_written_is_refused(telemetry):
    with pytest.raises(HarnessError, match="cannot be written"):
        check_results({"--out": telemetry / "x"}, {})


def test_a_result_is_whole_and_alone_in_its_folder(telemetry, tmp_path):
    check_results({"--out": tmp_path / "c.toml"}, {"the telemetry": telemetry})
    write_result(tmp_path / "c.toml", "# of \udcff µT\n")
    assert (tmp_path / "c.toml").read_text(encoding="utf-8") == "# of \\udcff µT\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.toml", "p.csv"]


def test_a_result_takes_the_place_of_a_symbolic_link_and_what_it_leads_to_stays(telemetry, tmp_path):
    (tmp_path / "link").symlink_to(telemetry)
    check_results({"--out": tmp_path / "link"}, {})
    write_result(tmp_path / "link", "new")
    assert telemetry.read_text() == "kept"
    assert not (tmp_path / "link").is_symlink()
    assert (tmp_path / "link").read_text() == "new"


def test_a_result_that_cannot_be_written_is_one_sentence(tmp_path):
    (tmp_path / "no").mkdir()
    with pytest.raises(HarnessError, match=r"no: cannot be written \(Is a directory\)"):
        write_result(tmp_path / "no", "x")


# --- An export leaves a whole file or none


def test_a_block_that_fails_leaves_nothing(tmp_path):
    with pytest.raises(TypeError), whole_file(tmp_path / "run.csv", False) as path:
        path.write_text(None)  # it opens the file first
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_there_is_kept_without_force(tmp_path):
    write_text(tmp_path / "run.csv", "old", force=False)
    with pytest.raises(HarnessError, match="already exists: name another file"):
        write_text(tmp_path / "run.csv", "new", force=False)
    assert (tmp_path / "run.csv").read_text() == "old"
    write_text(tmp_path / "run.csv", "new", force=True)
    assert (tmp_path / "run.csv").read_text() == "new"
