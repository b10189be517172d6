"""The option ``--pace``."""

import pytest

from sim.errors import HarnessError
from sim.record.pace import LOCKSTEP, Pace, parse_pace


@pytest.mark.parametrize(
    ("text", "pace"),
    [
        ("lockstep", LOCKSTEP),
        ("realtime", Pace(1.0)),
        ("realtime:1", Pace(1.0)),
        ("realtime:100", Pace(100.0)),
        ("realtime:0.5", Pace(0.5)),
    ],
)
def test_pace(text, pace):
    assert parse_pace(text) == pace


@pytest.mark.parametrize(
    "text",
    [
        "",
        "fast",
        "lockstep:2",
        "lockstep:",
        "realtime:",
        "realtime:0",
        "realtime:-1",
        "realtime:1000000",
        "realtime:fast",
        "realtime:nan",
        "realtime:inf",
        "Realtime",
    ],
)
def test_no_pace(text):
    with pytest.raises(
        HarnessError,
        match="write lockstep, realtime or realtime:FACTOR with a factor above 0 and below 1000000",
    ) as caught:
        parse_pace(text)
    assert str(caught.value).startswith(f"--pace {text}: ")
    assert caught.value.exit_code == 2
