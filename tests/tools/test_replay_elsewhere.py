"""The page of replays: every variant a row, in order; what is not command-exact is an error."""

import subprocess
import sys

import pytest
import replay_elsewhere as tool

EXACT = "bit-exact: 9 ticks, 30 frames, every state CRC equal\n"
NEARLY = "command-exact, not bit-exact (another platform than the run's): tick 7: state_crc is 1 and 2\n"


@pytest.fixture
def page(monkeypatch, tmp_path):
    """The page and the exit code, with the answer of each variant's replay given."""

    def made(answers, exit_code=0):
        def torquer(variant, command, *_):
            output = answers.get(variant.name, EXACT) if command == "replay" else ""
            return subprocess.CompletedProcess([], exit_code, output, "trouble\nNoSuchThing: of it")

        monkeypatch.setattr(tool, "_torquer", torquer)
        monkeypatch.setattr(sys, "argv", ["replay_elsewhere", "--out", str(tmp_path / "replay.md")])
        return tool.main(), (tmp_path / "replay.md").read_text()

    return made


def test_each_flight_is_replayed_in_each_way_and_told_in_order(page):
    code, text = page({tool.VARIANTS[1].name: NEARLY})
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| ")][1:]
    names = [variant.name for variant in tool.VARIANTS]
    assert [row[1] for row in rows] == names * 2
    assert [row[0] for row in rows] == ["| microsat"] * len(names) + ["| posat1-ekf"] * len(names)
    assert rows[1][2:] == ["command-exact", "first bit: tick 7: state_crc is 1 and 2 |"]
    assert code == 0


@pytest.mark.parametrize(
    ("answer", "expected"),
    [
        ("differs: tick 3: COIL_FIRE is 1 and 2\n", "differs: tick 3: COIL_FIRE is 1 and 2"),
        ("", "NoSuchThing: of it"),
    ],
)
def test_another_command_and_no_answer_are_errors(page, answer, expected):
    code, text = page({tool.VARIANTS[-1].name: answer})
    assert code == 1
    assert expected in text


def test_a_flight_that_fails_is_not_replayed(page):
    with pytest.raises(SystemExit, match="microsat does not fly: trouble"):
        page({}, exit_code=2)
