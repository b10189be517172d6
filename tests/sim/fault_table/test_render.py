"""What a row injects, as a reader is told."""

import pytest

from sim.fault_table.render import fault_words
from sim.fault_table.rows.table import choose_rows


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("none", "none, 1 s"),
        ("cells-lost", "loss, part 0.5, 600 s"),
        ("cells-board-dead", "sun board dead, 600 s"),
    ],
)
def test_a_fault_that_only_names_a_unit_is_not_told_beside_one_that_does_something(name, words):
    (row,) = choose_rows([name])
    assert fault_words(row) == words
