"""Arguments of the tools: a number that is not possible ends with one sentence and exit code 2."""

import importlib

import pytest
from argument_types import count, positive


@pytest.mark.parametrize(("text", "value"), [("1", 1), ("07", 7), ("120", 120)])
def test_a_count_is_a_whole_number_from_1(text, value):
    assert count(text) == value


@pytest.mark.parametrize(("text", "value"), [("0.5", 0.5), ("3", 3.0), ("1e-9", 1e-9)])
def test_a_positive_number_is_finite(text, value):
    assert positive(text) == value


TOOLS = [
    ("bench", "--rounds", "0", "no whole number from 1"),
    ("bench", "--orbits", "-1", "no number above 0"),
    ("mutate", "--workers", "1.5", "no whole number from 1"),
    ("planted", "--runs", "²", "no whole number from 1"),
    ("population", "--workers", "0", "no whole number from 1"),
    ("replay_elsewhere", "--orbits", "inf", "no number above 0"),
    ("replay_elsewhere", "--python", "/no/such/python", "is no program"),
    ("scaling", "--flights", "-3", "no whole number from 1"),
    ("soak", "--hours", "nan", "no number above 0"),
    ("train_neural_gains", "--flights", "0", "no whole number from 1"),
    ("validate_planted", "--timeout", "soon", "no number above 0"),
]


@pytest.mark.parametrize(("tool", "option", "text", "sentence"), TOOLS)
def test_what_is_not_possible_is_one_sentence(tool, option, text, sentence, monkeypatch, capsys):
    module = importlib.import_module(tool)
    monkeypatch.setattr("sys.argv", [f"{tool}.py", option, text])
    with pytest.raises(SystemExit) as ended:
        module.main()
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert option in told
    assert sentence in told.splitlines()[-1]
