"""A user law in the onboard table: named, loaded with its gains, and guarded in flight."""

from contextlib import suppress
from dataclasses import replace
from time import process_time

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.entry import Aim
from fsw.core.laws.interface import Demand, FieldSample, LawInput
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.laws.table import LAWS
from fsw.input.schema import TableError
from fsw.own_law import Demand as OwnDemand
from fsw.own_law import Pulse as OwnPulse
from fsw.table import own_law
from fsw.table.config import flight_config
from fsw.table.own_law import GuardedLaw, LawError, declared, named, withheld
from fsw.table.table import flight_table, lay_over, load_flight_table

LAW = """
from dataclasses import dataclass
from functools import partial, wraps
from fsw.own_law import Aim, ControlLaw, Demand, quantity

@dataclass(frozen=True)
class Gains:
    push_am2: float = quantity(0.5, "A m^2", least=0.0, most=1.0)

def point(inputs, memory, setpoint, config):
    return Demand((config.gains[setpoint.law].push_am2, 0.0, 0.0))

def acquire(inputs, memory, setpoint, config):
    return Demand((0.0, 1.0, 0.0))

mine = ControlLaw(point, acquire, Gains, Aim.RATE)
plain = point
number = 3
broken = ControlLaw(3)
short = lambda inputs, memory: Demand((0.0, 0.0, 0.0))
lopsided = ControlLaw(point, acquire=lambda *, inputs: None)
any_number = ControlLaw(lambda *arguments, more=1: Demand((0.0, 0.0, 0.0)))
wrapped = wraps(lambda inputs: None)(lambda inputs, memory, setpoint, config: point)
bound = partial(lambda size, inputs, memory, setpoint, config: point, 0.5)
one_too_many = partial(point, 1)
unsound = ControlLaw(point, gains=int)
aimless = ControlLaw(point, aim="three_axis")
pd = point
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "laws.py").write_text(LAW)
    return tmp_path


def table_of(folder, name="mine", **control):
    values = named({"control": {"law": f"laws.py:{name}", **control}}, folder)
    return flight_table(values, "table")


def inputs_at(tick=5):
    return LawInput(UNKNOWN, (1e-5, 2e-5, 3e-5), FieldSample(), FieldSample(), tick=tick)


class TestInATable:
    def test_it_has_its_absolute_path_and_digest(self, folder):
        control = table_of(folder).control
        assert control.law == f"{folder / 'laws.py'}:mine"
        assert len(control.law_sha256) == 64
        assert (control.own, control.law_name) == (True, "mine")

    def test_a_file_names_it_beside_itself(self, folder, monkeypatch):
        (folder / "table.toml").write_text('[control]\nlaw = "laws.py:mine"\n')
        monkeypatch.chdir("/")
        assert load_flight_table(str(folder / "table.toml")) == table_of(folder)

    def test_what_has_a_digest_stays_as_it_is(self):
        values = {"control": {"law": "/nowhere/laws.py:mine", "law_sha256": "0" * 64}}
        assert named(values, folder) == values

    def test_the_section_that_overrides_the_onboard_table_is_named_too(self, folder):
        values = named({"flight": {"control": {"law": "laws.py:mine"}}}, folder)
        assert values["flight"]["control"]["law"] == f"{folder / 'laws.py'}:mine"

    def test_its_crc_depends_on_the_source_and_not_on_the_path(self, folder, tmp_path_factory):
        elsewhere = tmp_path_factory.mktemp("elsewhere")
        (elsewhere / "laws.py").write_text(LAW)
        assert table_of(folder).crc == table_of(elsewhere).crc
        (elsewhere / "laws.py").write_text(LAW + "\n")
        assert table_of(folder).crc != table_of(elsewhere).crc

    def test_tables_without_one_have_the_crc_that_they_always_had(self):
        assert f"{flight_table({}, 'default').crc:08x}" == DEFAULT_CRC

    def test_a_name_of_the_table_of_laws_is_refused(self, folder):
        with pytest.raises(TableError, match=r"control\.law: .*called like a law of the table"):
            table_of(folder, "pd")

    def test_another_law_replaces_it_with_digest_and_gains(self, folder):
        base = named({"control": {"law": "laws.py:mine", "gains": {"mine": {"x": 1.0}, "mpc": {}}}}, folder)
        assert lay_over(base, {"control": {"law": "pd"}})["control"] == {"law": "pd", "gains": {"mpc": {}}}
        moved = lay_over(base, {"control": {"law": "other.py:mine"}})["control"]
        assert moved == {"law": "other.py:mine", "gains": {"mine": {"x": 1.0}, "mpc": {}}}


DEFAULT_CRC = "dff0f9e7"


def test_why_it_is_withheld_ends_with_an_option_to_paste(tmp_path):
    folder = tmp_path / "my laws"
    folder.mkdir()
    (folder / "laws.py").write_text(LAW)
    assert withheld(table_of(folder).control).endswith(f"--law '{folder / 'laws.py'}:mine'")


class TestLoaded:
    def test_with_its_gains_and_forms(self, folder):
        config = flight_config(table_of(folder, gains={"mine": {"push_am2": 0.25}})).control
        assert config.setpoint.law == "mine"
        point = config.own.point(inputs_at(), (), config.setpoint, config)
        assert point == Demand((0.25, 0.0, 0.0))
        assert config.own.acquire(inputs_at(), (), config.setpoint, config).m_body_am2[1] == 1.0
        assert config.gains.keys() - {"mine"} == {n for n, row in LAWS.items() if row.gains is not None}

    def test_a_function_alone_is_a_law_of_three_axes(self, folder):
        assert declared(table_of(folder, "plain").control).aim is Aim.THREE_AXIS
        assert declared(table_of(folder, "mine").control).aim is Aim.RATE

    @pytest.mark.parametrize("name", ["any_number", "wrapped", "bound"])
    def test_whatever_takes_four_arguments_is_a_form(self, folder, name):
        assert callable(declared(table_of(folder, name).control).point)

    @pytest.mark.parametrize(
        ("name", "gains", "what"),
        [
            ("mine", {"push_am2": 2.0}, r"control\.gains\.mine\.push_am2 = 2\.0 .*at most 1 A m\^2"),
            ("mine", {"pull_am2": 2.0}, r"control\.gains\.mine\.pull_am2 is not a known key"),
            ("plain", {"push_am2": 1.0}, r"control\.gains\.plain: the law has no gains of its own"),
            ("number", {}, "is of type int, not a law"),
            ("Gains", {}, "is the class Gains, not a law"),
            ("broken", {}, "point is no function"),
            ("short", {}, "cannot be called as a law, with inputs, memory, setpoint, config: too many"),
            ("one_too_many", {}, "one_too_many cannot be called as a law"),
            ("lopsided", {}, "lopsided: acquire cannot be called as a law, with inputs, memory, setpoint"),
            ("unsound", {}, "int is no frozen dataclass"),
            ("aimless", {}, r"its aim is none of Aim\.THREE_AXIS"),
            ("missing", {}, "there is no missing in it"),
        ],
    )
    def test_what_is_wrong_is_named_with_the_file(self, folder, name, gains, what):
        table = table_of(folder, name, gains={name: gains})
        with pytest.raises(TableError, match=f"laws.py.*{what}") as caught:
            flight_config(table)
        assert not isinstance(caught.value, LawError)

    def test_another_source_than_the_named_is_not_executed(self, folder):
        table = table_of(folder)
        (folder / "laws.py").write_text(f"open({str(folder / 'trace')!r}, 'w')\n")
        with pytest.raises(TableError, match=table.control.law_sha256[:16]):
            flight_config(table)
        assert not (folder / "trace").exists()


def answer_of(function, tick=5, memory=()):
    return GuardedLaw(function, "mine of laws.py", __file__)(inputs_at(tick), memory, None, None)


def returning(answer):
    return lambda inputs, memory, setpoint, config: answer


class TestInFlight:
    def test_numbers_of_numpy_become_floats(self):
        answer = OwnDemand(np.array([1.0, 2.0, 3.0]), np.float32([1, 2, 3]), [np.int64(4)])
        demand = answer_of(returning(answer))
        assert demand == Demand((1.0, 2.0, 3.0), (1.0, 2.0, 3.0), (4.0,))
        assert type(demand.m_body_am2[0]) is float
        assert type(demand.memory) is tuple

    def test_the_torque_of_a_wheel_is_passed_on(self):
        demand = answer_of(returning(OwnDemand((1.0, 0.0, 0.0), wheel_torque_nm=np.float32(0.25))))
        assert demand == Demand((1.0, 0.0, 0.0), wheel_torque_nm=0.25)
        assert type(demand.wheel_torque_nm) is float
        assert answer_of(returning(OwnDemand(wheel_torque_nm=0.0))).wheel_torque_nm == 0.0

    def test_a_pulse_stays_one(self):
        demand = answer_of(returning(OwnDemand(pulse=(np.int64(2), True))))
        assert demand == Demand(pulse=Pulse(2, 1))
        assert (type(demand.pulse.coil), type(demand.pulse.level)) == (int, int)
        assert answer_of(returning(OwnDemand(pulse=Pulse(2, 1)))) == demand

    def test_a_demand_of_the_law_s_own_is_one_of_the_flight_software(self):
        """Its numbers and sequences may be of any kind."""
        own = OwnDemand([1, 2, 3], memory=range(2), pulse=OwnPulse(2, -1))
        assert answer_of(returning(own)) == Demand((1.0, 2.0, 3.0), None, (0.0, 1.0), Pulse(2, -1))

    @pytest.mark.parametrize(
        ("answer", "what"),
        [
            (None, "it returns nothing, not a Demand"),
            ((0.0, 0.0, 0.0), "it returns a tuple, not a Demand"),
            (OwnDemand((0.0, float("nan"), 0.0)), "m_body_am2 is not finite: 0, nan, 0"),
            (OwnDemand((0.0, 0.0)), "m_body_am2 has 2 numbers, not 3"),
            (OwnDemand("abc"), "m_body_am2[0] is a str, not a number"),
            (OwnDemand(None), "m_body_am2 is nothing"),
            (OwnDemand(np.zeros((3, 3))), "m_body_am2[0] is a ndarray, not a number"),
            (OwnDemand(impulse_body_nms=(1.0, float("inf"), 0.0)), "impulse_body_nms is not finite"),
            (OwnDemand(wheel_torque_nm=float("nan")), "wheel_torque_nm is not finite: nan"),
            (OwnDemand(wheel_torque_nm=10**400), "wheel_torque_nm is a int, not a number"),
            (OwnDemand(wheel_torque_nm=(1.0,)), "wheel_torque_nm is a tuple, not a number"),
            (OwnDemand(pulse=(3, 1)), "pulse is not a coil 0 to 2 and a level -3 to 3"),
            (OwnDemand(pulse=(0, 4)), "pulse is not a coil 0 to 2 and a level -3 to 3"),
            (OwnDemand(pulse=(0.0, 1)), "pulse is not a coil 0 to 2 and a level -3 to 3"),
            (OwnDemand(pulse="01"), "pulse is not a coil 0 to 2 and a level -3 to 3"),
            (OwnDemand(memory=range(2000)), "memory has more than 1000 numbers"),
            (OwnDemand(memory=(1, 0.5, "x")), "memory[2] is a str, not a number"),
            (OwnDemand(memory=(10**400,)), "memory[0] is a int, not a number"),
            (OwnDemand(memory=3.5), "memory is a float, not a sequence of numbers"),
        ],
    )
    def test_only_a_whole_demand_gets_further(self, answer, what):
        with pytest.raises(LawError) as caught:
            answer_of(returning(answer))
        assert str(caught.value).startswith("the law mine of laws.py, tick 5: ")
        assert what in str(caught.value)

    def test_a_law_that_fails_is_named_with_tick_and_line(self):
        def law(inputs, memory, setpoint, config):
            raise KeyError("k")

        with pytest.raises(LawError, match=r"tick 5: it fails: line \d+: KeyError: 'k'"):
            answer_of(law)

    def test_a_law_that_ends_the_process_does_not(self):
        def law(inputs, memory, setpoint, config):
            raise SystemExit

        with pytest.raises(LawError, match="SystemExit"):
            answer_of(law)

    def test_ctrl_c_is_no_fault_of_the_law(self):
        def law(inputs, memory, setpoint, config):
            raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            answer_of(law)

    def test_a_law_that_takes_too_long_is_given_up(self, monkeypatch):
        monkeypatch.setattr(own_law, "LONGEST_S", 0.05)

        def law(inputs, memory, setpoint, config):
            while True:
                with suppress(Exception):  # what it catches does not save it
                    sum(range(100))

        began_s = process_time()
        with pytest.raises(LawError, match=r"tick 5: it takes more than 0.05 s"):
            answer_of(law)
        assert process_time() - began_s < 1.0

    def test_a_law_that_keeps_state_is_found(self):
        calls = []

        def law(inputs, memory, setpoint, config):
            calls.append(1)
            return Demand((float(len(calls)), 0.0, 0.0))

        for tick in range(1, 16):
            answer_of(law, tick)
        with pytest.raises(LawError, match=r"tick 16: it gives two answers .* outside Demand\.memory"):
            answer_of(law, 16)

    def test_memory_is_given_back(self):
        law = lambda inputs, memory, setpoint, config: Demand(memory=(sum(memory) + 1.0,))  # noqa: E731  as a user may write one
        assert answer_of(law, 16, (2.0,)).memory == (3.0,)


def test_exit_codes():
    assert LawError.exit_code == 1
    assert not hasattr(TableError, "exit_code")


def test_the_config_of_others_is_untouched(folder):
    own, shipped = flight_config(table_of(folder)), flight_config(flight_table({}, "default"))
    assert shipped.control.own is None
    assert replace(own.control, own=None, gains=shipped.control.gains).gains == shipped.control.gains
