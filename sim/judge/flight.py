"""One flight against a user's flight software: flown, concluded and judged."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from sim.errors import FlightError
from sim.fault_table.wrong_estimates import WRONG_DEG
from sim.faults.section import forge_answers
from sim.flight.bus_in_use import ALL_NODES
from sim.flight.flight_loop import ProgressCallback
from sim.flight.fsw_answers import Patience
from sim.flight.node_command import NodeCommand, last_words
from sim.flight.record_flight import check_plant, ticks_of
from sim.flight.sil import fly_against, serve_bus
from sim.judge.answers import AnswerRecord, field_samples, read_answers
from sim.judge.driven import alters_reports, limits_as_driven
from sim.judge.invariants import InvariantVerdict, JudgedFlightRecord, judge_invariants
from sim.judge.law_fit import LawFit, fit_law, least_degps
from sim.judge.profile import Profile, asked_of, not_asked
from sim.judge.valid_estimates import wrong_attitude, wrong_rate
from sim.record import run_dir
from sim.record.candump import whole_entries
from sim.record.pace import Pace
from sim.record.truth import read_truth
from sim.report.conclude import conclude
from sim.report.requirements.judge import Outcome
from sim.report.verdict import Verdict
from sim.scenario.requirements import RequirementSection, in_words
from sim.scenario.schema import Scenario
from sim.value_types import Json

OUTPUT = "flight-software.log"
"""In the run directory: what the command of the flight software printed."""
LEAST_BRAKING = 0.4
"""Mean cosine of a law to the dipole that brakes most. One coil at a time cannot have more than some 0.8;
with one axis reversed, or two swapped, a third of that is left, 0.27, and half is between. Flown were from
0.45 on by sound laws, and up to 0.39 with the bytes of the field or the axes wrong: docs/own-firmware.md."""
OF_SOUND_LAWS = frozenset(("gravity", "coarse", "weak", "saturates"))
"""Causes of a missed requirement by what the satellite is: named for a law in which no mistake is found."""
PLANT_AND_BOARDS = frozenset(("PLANT", "COIL", "MAG", "SUN", "WHEEL"))


@dataclass(frozen=True, slots=True)
class SoftwareUnderTest:
    """A flight software, how it is reached, and how long the plant waits for it.

    Attributes:
        command: started for each flight, on a loop bus of its own; None: it runs already.
        bus: on which it runs.
        profile: what it says that it gives.
        pace: lockstep or real time.
        patience: for its boot and for an answer.
    """

    command: NodeCommand | None
    bus: str
    profile: Profile
    pace: Pace
    patience: Patience


@dataclass(frozen=True)
class JudgedFlight:
    """A flight and what is judged of it.

    Attributes:
        path: its run directory.
        record: what it is judged by.
        asked: the scenario with all of its requirements, of which not all are asked of every profile.
    """

    path: Path
    record: JudgedFlightRecord
    asked: Scenario

    @cached_property
    def invariants(self) -> tuple[InvariantVerdict, ...]:
        """What every flight software must keep, and what its profile promises."""
        return (*judge_invariants(self.record), *self._promises())

    @cached_property
    def requirements(self) -> list[Json]:
        """Those of the scenario as in summary.json, and those that are not asked, with the reason."""
        others = [
            _unasked(one, why)
            for one in self.asked.requirement
            if (why := not_asked(one, self.record.profile))
        ]
        judged: list[Json] = self.record.summary["requirements"]
        if self.law.mistake:  # what a sound law would be limited by explains nothing of this one
            judged = [
                {**one, "reasons": [why for why in one["reasons"] if why["cause"] not in OF_SOUND_LAWS]}
                for one in judged
            ]
        return judged + others

    @cached_property
    def law(self) -> LawFit:
        """What its dipoles show of its law; nothing of one that is to spin the body, or of no flight."""
        if self.record.scenario.control.spin_radps or not self.record.answers.ticks:
            return LawFit(0)
        truth, entries = read_truth(self.path / run_dir.TRUTH), whole_entries(run_dir.bus_log(self.path))
        return fit_law(self.record.scenario, truth, field_samples(entries, len(truth["t_s"])))

    @property
    def ok(self) -> bool:
        """Nothing is broken or missed."""
        found = [one.outcome for one in self.invariants]
        found += [Outcome(one["verdict"]) for one in self.requirements]
        return Outcome.FAILED not in found

    @property
    def reasons(self) -> list[str]:
        """What explains a flight that is not as it should be; empty of one that is."""
        return [self.law.mistake] if not self.ok and self.law.mistake else []

    def _promises(self) -> Iterator[InvariantVerdict]:
        if self.record.profile is not Profile.DETUMBLE:
            return
        name, law = "brakes the body", self.law
        if self.record.faulty:
            yield InvariantVerdict(name, Outcome.NOT_JUDGED, "faults act on what it senses or drives")
            return
        if not law.pulses:
            why = (
                f"it never turned at more than {least_degps(self.record.scenario):.2g} deg/s for long "
                "enough to tell: --set initial.rate_degps=[1,1,1] begins with a tumble"
            )
            yield InvariantVerdict(name, Outcome.NOT_JUDGED, why)
            return
        fit = f"mean cosine to the braking dipole {law.brakes:.2f} over {law.pulses} dipoles"
        found = f"{fit}, work on the body {law.work_j:.2g} J"
        if law.brakes < LEAST_BRAKING:
            found += f", a law that brakes has {LEAST_BRAKING} at least"
        sound = law.brakes >= LEAST_BRAKING and not law.mistake
        yield InvariantVerdict(name, Outcome.MET if sound else Outcome.FAILED, found)


def fly_and_judge(
    software: SoftwareUnderTest,
    scenario: Scenario,
    seed: int,
    path: Path | None,
    orbits: float | None = None,
    watch: ProgressCallback = lambda tick: None,
    honest_deg: float | None = WRONG_DEG,
) -> JudgedFlight:
    """Fly a scenario against the flight software, and judge it.

    A flight that ends before its time is judged too, as far as it went.

    Args:
        software: the flight software.
        scenario: what is flown.
        seed: of all random streams.
        path: the run directory; None: a new one.
        orbits: how long; None: as the scenario says.
        watch: called with the tick now and then.
        honest_deg: the error from which on an attitude that is called valid is wrong; None: none is.

    Raises:
        HarnessError: nothing can be flown: the command does not start, the run cannot be written.
        BusError: the bus cannot be used.
    """
    ticks = ticks_of(scenario, orbits)
    flown = asked_of(scenario, software.profile)
    check_plant(flown, seed)
    with _bus_of(software) as (spec, listener):
        path = run_dir.begin(path, flown, seed, ticks, spec.partition(":")[0], software.pace)
        command = software.command
        named = {
            "command": None if command is None else command.text[:1000],
            "profile": software.profile.value,
        }
        run_dir.update(path, flight_software=named)
        given = {"scenario": str((path / run_dir.SCENARIO).absolute())}
        start = None if command is None else partial(command.start, spec, given, path / OUTPUT)
        try:
            fly_against(path, flown, spec, listener, watch, software.patience, start)
        except FlightError as error:
            _note_end(path, str(error))
    return judged(path, scenario, software.profile, honest_deg)


def judged(path: Path, asked: Scenario, profile: Profile, honest_deg: float | None) -> JudgedFlight:
    """Judge the flight of a run directory, as far as it went.

    Args:
        path: the run directory.
        asked: the scenario with all of its requirements.
        profile: of the flight software.
        honest_deg: as for ``fly_and_judge``.
    """
    run = run_dir.read_run(path)
    scenario, log = asked_of(asked, profile), run_dir.bus_log(path)
    forged = forge_answers(scenario.fault)
    if log.is_file() and log.stat().st_size:
        summary, answers = conclude(path), read_answers(whole_entries(log), forged)
    else:
        summary, answers = _nothing(scenario, run.get("ended", "nothing was flown")), AnswerRecord()
    run = run_dir.read_run(path)
    said = "" if "flown" in run else last_words(path / OUTPUT)
    wrong = rate = None
    if profile is Profile.ATTITUDE and honest_deg is not None and answers.ticks:
        wrong = wrong_attitude(path, scenario.time.tick_hz, honest_deg, forged)
        rate = wrong_rate(path, scenario, forged)
    driven = None
    if answers.ticks and alters_reports(scenario):
        driven = limits_as_driven(scenario, read_truth(path / run_dir.TRUTH))
    faulty = bool(scenario.fault)
    record = JudgedFlightRecord(scenario, profile, run, summary, answers, said, faulty, wrong, driven, rate)
    return JudgedFlight(path, record, asked)


def _nothing(scenario: Scenario, why: str) -> Json:
    """The summary of a flight that never began."""
    requirements = [_unasked(one, "nothing was flown") for one in scenario.requirement]
    return {"failures": {Verdict.COMPLETE.value: why}, "requirements": requirements, "ticks": 0}


@contextmanager
def _bus_of(software: SoftwareUnderTest) -> Iterator[tuple[str, socket.socket | None]]:
    """The bus of a flight: one of its own where the flight software is started, otherwise where it runs."""
    with serve_bus(software.bus, PLANT_AND_BOARDS if software.command is None else ALL_NODES) as served:
        yield served


def _note_end(path: Path, sentence: str) -> None:
    """Note why the flight ended, where the plant could not."""
    if "ended" not in run_dir.read_run(path):
        run_dir.update(path, ended=sentence.partition(": the run is not complete")[0][:1000])


def _unasked(one: RequirementSection, why: str) -> Json:
    words = in_words(one.index, one.what)
    return {
        "id": one.id,
        "index": one.index,
        "what": one.what,
        "verdict": Outcome.NOT_JUDGED.value,
        "text": f"{words}: not judged, {why}",
        "reasons": [],
    }
