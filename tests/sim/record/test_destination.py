"""The place of results is checked before the work, and the check changes nothing there."""

from pathlib import Path

import pytest

from sim.errors import HarnessError
from sim.record.destination import check_file, check_folder, new_folder


def test_a_folder_is_made_and_left_empty(tmp_path):
    check_folder(tmp_path / "a" / "b", ("x.json",))
    assert list((tmp_path / "a" / "b").iterdir()) == []


def test_what_is_there_stays(tmp_path):
    (tmp_path / "x.json").write_text("kept")
    check_folder(tmp_path, ("x.json", "y.json"))
    check_file(tmp_path / "x.json")
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("x.json", "kept")]


def test_calls_within_one_second_have_a_folder_each(tmp_path):
    folders = {new_folder(tmp_path / "runs", "microsat") for _ in range(3)}
    assert len(folders) == 3
    assert sorted(folders) == sorted((tmp_path / "runs").iterdir())
    assert all(folder.name.startswith("microsat-") and not list(folder.iterdir()) for folder in folders)


@pytest.mark.parametrize("folder", ["/proc/x", "/dev/null", "/dev/null/x", "a\0b", "x" * 5000])
def test_a_folder_that_cannot_be(folder):
    with pytest.raises(HarnessError, match="cannot be written"):
        check_folder(Path(folder))


@pytest.mark.parametrize(
    "page", ["/proc/x", "/proc/version", "/dev/full", "/dev/stdout", "/dev/null/x", "x" * 300, "a\0b"]
)
def test_a_file_that_cannot_be(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(HarnessError, match="cannot be written"):
        check_file(Path(page))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["folder", "link to nothing below a file"])
def test_what_is_in_the_way_of_a_file(kind, tmp_path):
    if kind == "folder":
        (tmp_path / "x.json").mkdir()
    else:
        (tmp_path / "file").touch()
        (tmp_path / "x.json").symlink_to(tmp_path / "file" / "below")
    with pytest.raises(HarnessError, match=r"x\.json: cannot be written"):
        check_folder(tmp_path, ("x.json",))


def test_a_link_is_to_be_replaced_and_what_it_leads_to_may_be_write_protected(tmp_path):
    (tmp_path / "there").touch()
    (tmp_path / "there").chmod(0o400)
    (tmp_path / "x.json").symlink_to(tmp_path / "there")
    (tmp_path / "y.json").symlink_to(tmp_path / "nowhere")
    check_folder(tmp_path, ("x.json", "y.json"))
    assert not (tmp_path / "nowhere").exists()
