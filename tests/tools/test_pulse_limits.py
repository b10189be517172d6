"""What the tool finds wrong, and the page that it writes."""

import pulse_limits
import pytest
from pulse_limits import WHOLE, faults, main

from sim.design.limits.sweep import BOUND, all_orders

ROWS = {order.key: [0.4 if order.law == BOUND else 0.5] for order in all_orders()} | {
    name: [0.5, 0.52, 0.49] for name, _, _ in WHOLE
}


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Runs the command on rows; its exit code."""

    def of(rows):
        monkeypatch.setattr(pulse_limits, "fly_all", lambda workers: rows)
        return main(["--out", str(tmp_path / "page.md")])

    return of


@pytest.mark.long
def test_a_page_is_written_beside_its_picture(run, tmp_path):
    assert run(ROWS) == 0
    assert "![Pointing error" in (tmp_path / "page.md").read_text(encoding="utf-8")
    assert (tmp_path / "page.svg").exists()


@pytest.mark.long
def test_a_law_better_than_the_bound_fails(run, capsys):
    better = next(order.key for order in all_orders() if order.law == "mpc")
    assert run(ROWS | {better: [0.1]}) == 1
    assert "less error than the bound: mpc, back-off [s] 0" in capsys.readouterr().out


def test_a_whole_flight_that_differs_fails():
    name = WHOLE[2][0]
    assert list(faults(ROWS)) == []
    assert list(faults(ROWS | {name: [0.7, 0.52, 0.49]})) == [
        f"linear and whole flight differ by 0.180 deg: {name}"
    ]


def test_a_whole_flight_without_a_figure_fails():
    name = WHOLE[0][0]
    assert any(name in found for found in faults(ROWS | {name: [float("nan"), 0.52, 0.49]}))


def test_ctrl_c_is_one_sentence_and_writes_no_page(tmp_path, monkeypatch, capsys):
    def stopped(workers):
        raise KeyboardInterrupt

    monkeypatch.setattr(pulse_limits, "fly_all", stopped)
    assert main(["--out", str(tmp_path / "page.md")]) == 130
    said = "pulse_limits: interrupted; flights that are done are not flown again\n"
    assert capsys.readouterr().err == said
    assert list(tmp_path.iterdir()) == []
