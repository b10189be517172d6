"""What a user may have meant."""

import pytest

from fsw.input.near import did_you_mean, near

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


def test_at_most_three_are_named():
    assert len(near("abcde", [f"abcd{n}" for n in range(9)])) == 3


def test_the_words_end_a_sentence():
    assert did_you_mean("sharde", KNOWN) == " (did you mean 'shared'?)"
    assert (
        did_you_mean("backoff", ["backoff_s", "backoff_m"]) == " (did you mean 'backoff_s' or 'backoff_m'?)"
    )
