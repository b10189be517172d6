"""tools/draw_flight.py: the picture of the README is drawn from a flight."""

from xml.etree import ElementTree

import draw_flight
import pytest

import torquer


@pytest.mark.long
def test_it_draws_errors_and_pulses_of_a_run(tmp_path):
    run = torquer.fly("microsat", orbits=0.05, seed=2, out=tmp_path / "run")
    draw_flight.draw(run, tmp_path / "flight.svg")
    groups = [each.get("id", "") for each in ElementTree.parse(tmp_path / "flight.svg").iter()]
    drawn = sum(group.startswith("LineCollection") for group in groups)
    assert len(run.pulses) > 0
    assert drawn == 3


def test_what_is_no_run_is_one_sentence(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        draw_flight.main([str(tmp_path)])
    assert ended.value.code == 2
    assert f"{tmp_path} is no run directory" in capsys.readouterr().err
