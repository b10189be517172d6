"""``torquer.replay``: a log through the flight software, through the plant, or onto a bus."""

from os import PathLike
from pathlib import Path

from sim.errors import HarnessError
from sim.progress import shown
from sim.replay import command
from sim.replay.command import ReplayReport
from sim.scenario.settings import nested
from torquer.api.arguments import Settings, path_text
from torquer.api.audit import optional_key
from torquer.api.errors import one_sentence
from torquer.api.laws import LawLike, law_given


@one_sentence
def replay(
    run_or_log: str | PathLike[str],
    *,
    scenario: str | PathLike[str] | None = None,
    set: Settings | None = None,
    plant: bool = False,
    onto: str | None = None,
    law: LawLike | None = None,
    effects: bool = False,
    channel: str | None = None,
    verify: str | PathLike[str] | None = None,
    progress: bool = False,
) -> ReplayReport:
    """Replay a log and compare the answers of the flight software byte for byte, as ``torquer replay`` does.

    Args:
        run_or_log: a run directory, or a log.
        scenario: of a bare log, by name or path; None: the ``scenario.toml`` beside it.
        set: values laid over the scenario by key.
        plant: feed the recorded commands to the plant instead, and compare its frames.
        onto: play the log onto this bus instead, at its own pace.
        law: the user law that the run flew, named or given again; without it none is executed.
        effects: execute the user effects that the run names; ``plant`` needs them.
        channel: the one to read, of a log that has several.
        verify: public Ed25519 key in PEM; the run must be signed by its private half.
        progress: show progress on stderr.

    Raises:
        InputError: there is no such log or no scenario of it, the bus cannot be used, or both ``plant`` and
            ``onto`` are asked for.
    """
    if plant and onto is not None:
        raise HarnessError(f"plant, and onto {onto}: a replay is one or the other")
    path = Path(path_text(run_or_log, "run_or_log"))
    of_log = None if scenario is None else path_text(scenario, "scenario")
    with shown(progress), law_given(law) as named:
        log, run = command.locate(path, of_log, nested(set), optional_key(verify), named, effects, channel)
        with run.binding.beside_errors():
            if onto is not None:
                return command.play(log, run, onto)
            return command.through_plant(log, run) if plant else command.through_flight_software(log, run)
