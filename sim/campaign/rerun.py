"""A run of a campaign flown once more by itself, and whether it is the same to the last bit."""

from dataclasses import dataclass
from pathlib import Path

from sim.campaign.definition.campaign import FILE
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.definition.columns import Cell
from sim.campaign.flight import digest_of
from sim.campaign.results.store import DIGESTS, Status, read_results
from sim.errors import HarnessError
from sim.record import run_dir
from sim.scenario.schema import Scenario


@dataclass(frozen=True, slots=True)
class CampaignRun:
    """A run as its campaign drew it, and the row that the campaign has of it; None if it has none."""

    folder: Path
    run: int
    scenario: Scenario
    seed: int
    row: dict[str, Cell] | None


def campaign_run(folder: Path, run: int) -> CampaignRun:
    """A run of the campaign in a folder.

    Raises:
        HarnessError: there is no campaign, or it has no such run.
        TableError: the values that were drawn for the run are not allowed.
    """
    if not (folder / FILE).is_file():
        raise HarnessError(f"--from {folder}: it has no {FILE}")
    campaign = load_campaign(str(folder), {}, {})
    if not 0 <= run < campaign.runs:
        raise HarnessError(f"--run {run}: the campaign in {folder} has the runs 0 to {campaign.runs - 1}")
    drawn = campaign.draw(run)
    with read_results(folder) as results:
        row = results.row(run)
    return CampaignRun(folder, run, campaign.scenario(drawn), drawn.seed, row)


def compare(flown: CampaignRun, path: Path) -> tuple[bool, str]:
    """Whether the run directory ``path`` has the frames that the campaign saw, and a sentence that says so.

    Frames are compared by their digests; where only the commands are equal, the platforms may differ.
    """
    name = f"run {flown.run} of {flown.folder}"
    if flown.row is None or flown.row["status"] != Status.DONE:
        return True, f"{name} has no result to compare with"
    digest = digest_of(run_dir.bus_log(path))
    frames, commands = (flown.row[column] for column in DIGESTS)
    if digest.frames == frames:
        return True, f"equal to {name} bit for bit: SHA-256 of all frames {digest.frames[:16]}"
    if digest.commands == commands:
        return (
            False,
            f"equal to {name} in every command, but not bit for bit: is it another platform or version?",
        )
    return (
        False,
        f"NOT equal to {name}: SHA-256 of the commands {digest.commands[:16]}, there {str(commands)[:16]}",
    )
