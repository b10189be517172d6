"""The explicit form: its table gives what the programme gives, and grows with the horizon."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.lqr import LqrGains, orbit_problem, schedule
from fsw.core.laws.mpc_box import programme
from fsw.core.laws.plan.box import box_minimum
from sim.design.explicit_mpc import evaluate, held_of, piece, pieces

INERTIA = ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))
ORBIT = (INERTIA, (0.0, 0.0, 0.0), 1.038e-3, radians(98.6), 2.112e-5)
MOST = 0.02


def linear_programme(steps):
    """H and G of a horizon of some steps, the torque being zero."""
    table = schedule(*ORBIT, LqrGains(effort=0.05))
    field = orbit_problem(*ORBIT, LqrGains())[1][5 : 5 + steps]
    unit = np.vstack([np.eye(6), np.zeros((3, 6))])
    columns = [programme(table, field, np.eye(3), unit[:, k], 5 + steps) for k in range(6)]
    return columns[0][0], np.array([g for _, g in columns]).T


def states(count):
    return np.random.default_rng(8).uniform(-1.0, 1.0, (count, 6)) * np.repeat([3e-4, 0.3], 3)


def test_the_table_gives_the_solution_without_solving():
    h, g = linear_programme(2)
    drawn = states(150)
    table = pieces(h, g, drawn, MOST)
    for x in drawn[:60]:
        assert evaluate(table, h, g, x, MOST) == pytest.approx(box_minimum(h, g @ x, MOST), abs=1e-7 * MOST)


def test_a_state_of_no_piece_is_told():
    h, g = linear_programme(1)
    only = {(0, 0, 0): piece(h, g, (0, 0, 0), MOST)}
    far = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    assert evaluate(only, h, g, far, MOST) is None
    assert evaluate(only, h, g, 1e-6 * far, MOST) is not None


def test_a_state_at_the_edge_of_two_pieces_belongs_to_both():
    h, g = linear_programme(1)
    inside = piece(h, g, (0, 0, 0), MOST)
    x = states(1)[0]
    x *= MOST / np.abs(inside.gain @ x).max()
    assert evaluate({(0, 0, 0): inside}, h, g, x, MOST) == pytest.approx(inside.gain @ x)
    held = held_of(inside.gain @ x, MOST)
    assert sum(map(abs, held)) == 1
    assert evaluate({held: piece(h, g, held, MOST)}, h, g, x, MOST) == pytest.approx(inside.gain @ x)
    assert evaluate({(0, 0, 0): inside}, h, g, 1.001 * x, MOST) is None


def test_the_longer_the_horizon_the_more_pieces():
    counts = [len(pieces(*linear_programme(steps), states(150), MOST)) for steps in (1, 2, 4)]
    assert counts[0] < counts[1] < counts[2]
    assert counts[0] <= 3**3


def test_what_lies_at_a_limit_is_held():
    assert held_of(np.array([0.02, -0.02, 0.0199, 0.0]), MOST) == (1, -1, 0, 0)
