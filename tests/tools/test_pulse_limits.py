"""What the tool finds wrong, and what it does without rows."""

import json

import pulse_limits
import pytest
from pulse_limits import WHOLE, faults, main

from sim.design.limits.sweep import BOUND, all_orders

ROWS = {order.key: [0.4 if order.law == BOUND else 0.5] for order in all_orders()} | {
    name: [0.5, 0.52, 0.49] for name, _, _ in WHOLE
}


def written(tmp_path, rows):
    path = tmp_path / "rows.json"
    path.write_text(json.dumps(rows), encoding="utf-8")
    return ["--rows", str(path), "--out", str(tmp_path / "page.md"), "--render"]


def test_a_page_is_written_beside_its_picture(tmp_path):
    assert main(written(tmp_path, ROWS)) == 0
    assert "![Pointing error" in (tmp_path / "page.md").read_text(encoding="utf-8")
    assert (tmp_path / "page.svg").exists()


def test_a_law_better_than_the_bound_fails(tmp_path, capsys):
    better = next(order.key for order in all_orders() if order.law == "mpc")
    assert main(written(tmp_path, ROWS | {better: [0.1]})) == 1
    assert "less error than the bound: mpc, back-off [s] 0" in capsys.readouterr().out


def test_a_whole_flight_that_differs_fails():
    name = WHOLE[2][0]
    assert list(faults(ROWS)) == []
    assert list(faults(ROWS | {name: [0.7, 0.52, 0.49]})) == [
        f"linear and whole flight differ by 0.180 deg: {name}"
    ]


def test_without_rows_nothing_is_rendered(tmp_path, capsys):
    words = ["--rows", str(tmp_path / "none.json"), "--out", str(tmp_path / "page.md"), "--render"]
    assert main(words) == 2
    assert "none.json: no rows can be read" in capsys.readouterr().err
    assert not (tmp_path / "page.md").exists()


@pytest.mark.parametrize("rows", [[1.0], {"mpc": 1.0}, {"mpc": ["none"]}, 3])
def test_what_is_no_rows_is_told(rows, tmp_path, capsys):
    assert main(written(tmp_path, rows)) == 2
    assert "no rows can be read" in capsys.readouterr().err


def test_what_is_kept_is_not_flown_again(tmp_path, monkeypatch):
    monkeypatch.setattr(pulse_limits, "both", None)
    words = written(tmp_path, ROWS)[:-1]
    assert main([*words, "--keep"]) == 0


def test_without_a_file_yet_keeping_begins(tmp_path, monkeypatch):
    monkeypatch.setattr(pulse_limits, "both", lambda *of: [0.5, 0.52, 0.49])
    monkeypatch.setattr(pulse_limits, "all_orders", lambda: ())
    path = tmp_path / "rows.json"
    pulse_limits.fly_missing({}, path)
    assert json.loads(path.read_text()) == {name: [0.5, 0.52, 0.49] for name, _, _ in WHOLE}
    assert [kept.name for kept in tmp_path.iterdir()] == ["rows.json"]


def test_a_whole_flight_without_a_figure_fails():
    name = WHOLE[0][0]
    assert any(name in found for found in faults(ROWS | {name: [float("nan"), 0.52, 0.49]}))
