"""What a user may have meant."""

from pathlib import Path

import pytest

from fsw.input.near import did_you_mean, near, toml_files_near

KNOWN = ("control.law", "coils.backoff", "coils.backoff_s", "inertia_kgm2", "per_coil", "shared")


@pytest.mark.parametrize(
    ("word", "first"),
    [
        ("percoil", "per_coil"),
        ("per-coil", "per_coil"),
        ("PER_COIL", "per_coil"),
        ("inertia", "inertia_kgm2"),
        ("sharde", "shared"),
        ("coil.backof", "coils.backoff"),
    ],
)
def test_the_likest_known_word_comes_first(word, first):
    assert near(word, KNOWN)[0] == first


@pytest.mark.parametrize("word", ["", "x", "wheel", "zzzzzz"])
def test_nothing_is_near_a_word_like_none(word):
    assert near(word, KNOWN) == []
    assert did_you_mean(word, KNOWN) == ""


class TestFiles:
    @pytest.fixture
    def folder(self, tmp_path):
        for name in ("my3u.toml", "other.toml", "my3u.csv"):
            (tmp_path / name).touch()
        return tmp_path

    @pytest.mark.parametrize("name", ["my3u.tml", "my3u", "My3U.toml", "m3u.toml", "my3u.toml.txt"])
    def test_the_likest_toml_file_beside_one_that_does_not_exist(self, folder, name):
        assert toml_files_near(folder / name) == [str(folder / "my3u.toml")]

    def test_a_file_in_the_working_folder_is_named_without_it(self, folder, monkeypatch):
        monkeypatch.chdir(folder)
        assert toml_files_near(Path("my3u.tml")) == ["my3u.toml"]

    @pytest.mark.parametrize("name", ["a.tml", "zzz.toml", "none/my3u.toml", "my3u.csv/my3u.toml"])
    def test_nothing_is_near_a_file_like_none_or_in_no_folder(self, folder, name):
        assert toml_files_near(folder / name) == []


def test_at_most_three_are_named():
    assert len(near("abcde", [f"abcd{n}" for n in range(9)])) == 3


def test_the_words_end_a_sentence():
    assert did_you_mean("sharde", KNOWN) == " (did you mean 'shared'?)"
    assert (
        did_you_mean("backoff", ["backoff_s", "backoff_m"]) == " (did you mean 'backoff_s' or 'backoff_m'?)"
    )
