"""A flight as two processes on an interface of python-can, named by its environment alone."""

import json

import pytest

FLIGHT = ("sil", "microsat", "--seed", "7", "--orbits", "0.005")
GROUP = "239.74.163.7"


@pytest.fixture
def multicast(monkeypatch, port):
    """python-can's environment for a multicast group that stays on this machine."""
    monkeypatch.setenv("CAN_INTERFACE", "udp_multicast")
    monkeypatch.setenv("CAN_CHANNEL", GROUP)
    monkeypatch.setenv("CAN_CONFIG", json.dumps({"hop_limit": 0, "port": port}))


@pytest.mark.long
@pytest.mark.slow
def test_it_is_the_flight_of_any_other_bus(torquer, multicast, sil_run, bus, tmp_path):
    run = tmp_path / "run"
    assert torquer(*FLIGHT, "--bus", "can", "--out", run).code == 0
    assert bus(run) == bus(sil_run(*FLIGHT[1:], "--bus", "virtual"))
    assert f" {GROUP} " in (run / "bus.log").read_text()
    assert json.loads((run / "run.json").read_text())["complete"]


def test_a_bus_that_does_not_open_is_one_sentence_and_leaves_no_run(torquer, tmp_path):
    refused = torquer(*FLIGHT, "--bus", "can:serial:/dev/nowhere", "--out", tmp_path / "run")
    assert refused.code == 2
    assert "bus 'can:serial:/dev/nowhere' cannot be opened" in refused.sentence
    assert not (tmp_path / "run").exists()
