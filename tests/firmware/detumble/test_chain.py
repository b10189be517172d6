"""Its requests in flight against the laws and scheduler of ``fsw.core``, one by one, on golden vectors.

The laws of C are in single precision: a choice may differ where two pulses leave nearly the same.
"""

import pytest
from click.testing import CliRunner
from detumble_bench import Firmware, compile_library, loaded, read_vectors
from detumble_reference import Reference, compare, gains_that_ship

from fsw.table.config import flight_config
from fsw.wire.messages import FswBoot
from sim.scenario.schema import flight_table
from torquer.cli.main import main

pytestmark = pytest.mark.long

NEAR = 1e-4
"""Of what the strongest pulse changes: single precision, through some hundred ticks of owing."""


@pytest.fixture(scope="module")
def vectors(flight, tmp_path_factory):
    _, _, run = flight
    out = tmp_path_factory.mktemp("vectors") / "flight.jsonl"
    done = CliRunner().invoke(main, ["vectors", str(run), "--out", str(out)])
    assert done.exit_code == 0, done.output
    return read_vectors(out)


@pytest.mark.slow
def test_the_core_alone_answers_as_the_program_flew(flight, vectors, tmp_path):
    firmware = Firmware(loaded(compile_library(tmp_path, flight[0])))
    assert [frame.can_id for frame in firmware.boot()] == [FswBoot.ID]
    for vector in vectors[1:]:
        assert _but_boot(firmware.answer(vector.incoming)) == _but_boot(vector.outgoing), vector.tick


def test_it_fires_what_the_laws_in_python_fire(flight, vectors, capsys):
    reference = Reference(flight_config(flight_table(flight[0])).coils.pulses, gains_that_ship())
    compared = compare(reference, vectors[1:])
    with capsys.disabled():
        print(f"\n{compared.requests} requests, {len(vectors) - 1} ticks, least gap {compared.least_gap:.1e}")
        for one in compared.differences:
            print(f"  tick {one.tick}: fired {one.fired}, best {one.best}, by {one.gap:.1e}")
    assert compared.requests > 50
    assert [one for one in compared.differences if one.gap > NEAR] == []
    assert len(compared.differences) <= compared.requests // 20


def test_a_wrong_sign_would_be_found(flight, vectors):
    gains = gains_that_ship()
    wrong = gains._replace(k_w=-gains.k_w, k_a=-gains.k_a)
    compared = compare(Reference(flight_config(flight_table(flight[0])).coils.pulses, wrong), vectors[1:])
    assert len([one for one in compared.differences if one.gap > NEAR]) > compared.requests // 2


def _but_boot(frames):
    """Without the boot, which the plant may ask for once or twice in tick 0."""
    return [frame for frame in frames if frame.can_id != FswBoot.ID]
