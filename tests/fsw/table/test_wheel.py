"""The section of the onboard table for a driven wheel."""

import pytest

from fsw.input.schema import TableError
from fsw.table.config import flight_config
from fsw.table.table import flight_table

GIVEN = {
    "axis": [0.0, 3.0, 4.0],
    "inertia_kgm2": 2e-4,
    "max_torque_nm": 2e-3,
    "max_momentum_nms": 0.12,
    "viscous_nms": 2e-7,
    "coulomb_nm": 2e-5,
}


def table(wheel=None, **sections):
    return flight_table({"wheel": GIVEN | (wheel or {}), **sections}, "a table")


def test_the_wheel_goes_to_si_with_a_unit_axis():
    wheel = flight_config(table(time={"tick_hz": 4})).wheel
    assert wheel.axis_body == pytest.approx((0.0, 0.6, 0.8))
    assert (wheel.inertia_kgm2, wheel.max_torque_nm, wheel.max_momentum_nms) == (2e-4, 2e-3, 0.12)
    assert (wheel.viscous_nms, wheel.coulomb_nm) == (2e-7, 2e-5)
    assert (wheel.tick_s, wheel.stale_ticks) == (0.25, 40)


def test_without_it_there_is_none():
    bare = flight_table({}, "a table")
    assert flight_config(bare).wheel is None
    assert bare.crc != table().crc


@pytest.mark.parametrize("axis", [[0.0, 3.0, 4.0], [0.0, 0.0, -1.0]])
def test_a_law_that_turns_the_body_about_axis_3_needs_it_there(axis):
    table({"axis": [0.0, 0.1, 1.0]}, control={"law": "pitch_wheel"})
    with pytest.raises(
        TableError, match=r"'pitch_wheel' is not allowed without a \[wheel\] along the orbit's normal"
    ):
        table({"axis": axis}, control={"law": "pitch_wheel"})


@pytest.mark.parametrize("key", GIVEN)
def test_every_key_counts_in_the_crc(key):
    changed = [0.0, 0.0, 1.0] if key == "axis" else 1.01 * GIVEN[key]
    assert table({key: changed}).crc != table().crc


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"axis": [0.0, 0.0, 0.0]}, "axis must not be zero"),
        ({"inertia_kgm2": 0.0}, "wheel.inertia_kgm2"),
        ({"inertia_kgm2": 3.0, "max_momentum_nms": 5.0}, "must be below 1.9"),
        ({"max_torque_nm": 0.6}, "wheel.max_torque_nm"),
        ({"max_momentum_nms": 0.5}, "2500 rad/s, which must not be above 2000"),
        ({"coulomb_nm": 2e-3}, "not below max_torque_nm"),
        ({"viscous_nms": -1e-9}, "wheel.viscous_nms"),
        ({"momentum_nms": 0.1}, "wheel.momentum_nms is not a known key"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(wrong, said):
    with pytest.raises(TableError, match=said) as error:
        table(wrong)
    assert str(error.value).startswith("a table: ")


def test_cells_beside_it_are_refused():
    with pytest.raises(TableError, match="wheel is not allowed with cells"):
        table(cells={"normals": [[1.0, 0.0, 0.0]]})
