"""The verdicts of many flights: as text, page, JSON and JUnit."""

from collections.abc import Sequence

from sim.campaign.report.verdicts import WORDS, CampaignVerdict
from sim.drawing.page_parts import PageHeader, PageSection, Table, Tile, sections_page
from sim.judge.series import JudgedCase
from sim.junit import JunitCase
from sim.report.requirements.judge import Outcome
from sim.value_types import Json

HEADS = {Outcome.MET: "kept", Outcome.FAILED: "BROKEN", Outcome.NOT_JUDGED: "not applicable"}


def case_line(one: JudgedCase) -> str:
    """A case in a line."""
    about = f" ({one.case.about})" if one.case.about else ""
    return f"{HEADS[one.outcome]:<15}{one.name:<24} {one.text}{about}"


def tally_line(flown: Sequence[JudgedCase]) -> str:
    """How many were kept, broken, not applicable."""
    counts = {outcome: sum(one.outcome is outcome for one in flown) for outcome in Outcome}
    text = f"{counts[Outcome.MET]} kept, {counts[Outcome.FAILED]} broken"
    unflown = counts[Outcome.NOT_JUDGED]
    return f"{text}, {unflown} not applicable" if unflown else text


def series_json(flown: Sequence[JudgedCase], verdicts: Sequence[CampaignVerdict] = ()) -> Json:
    """The verdicts as values."""
    return {
        "tally": {
            HEADS[outcome].lower(): sum(one.outcome is outcome for one in flown) for outcome in Outcome
        },
        "cases": [
            {
                "name": one.name,
                "verdict": HEADS[one.outcome].lower(),
                "text": one.text,
                "about": one.case.about,
            }
            for one in flown
        ],
        "verdicts": [
            {"group": one.group, "name": one.name, "met": one.met, "found": one.found} for one in verdicts
        ],
    }


def series_suites(
    flown: Sequence[JudgedCase], verdicts: Sequence[CampaignVerdict] = ()
) -> dict[str, list[JunitCase]]:
    """The verdicts as tests of JUnit."""
    cases = [
        JunitCase(
            "flights",
            one.name,
            failure=one.text if one.outcome is Outcome.FAILED else "",
            skipped=one.text if one.outcome is Outcome.NOT_JUDGED else "",
        )
        for one in flown
    ]
    judged = [
        JunitCase(
            f"population.{one.group}",
            one.name,
            failure=one.found if one.met is False else "",
            skipped=one.found if one.met is None else "",
        )
        for one in verdicts
    ]
    return {"flights": cases, **({"population": judged} if judged else {})}


def series_page(
    name: str, software: str, flown: Sequence[JudgedCase], verdicts: Sequence[CampaignVerdict] = ()
) -> str:
    """The page of a series."""
    broken = sum(one.outcome is Outcome.FAILED for one in flown)
    missed = sum(one.met is False for one in verdicts)
    bad = f"✗ {missed or broken} of {len(verdicts) or len(flown)} broken"
    badge = ("bad", bad) if broken or missed else ("good", "✓ as it should be")
    applied = sum(one.outcome is not Outcome.NOT_JUDGED for one in flown)
    tiles = [Tile("Flights", str(applied), "flown"), Tile("Broken", str(broken), "flights")]
    cases = [(HEADS[one.outcome], one.name, one.case.about, one.text) for one in flown]
    sections = [
        PageSection("flights", "Flights", tables=(Table(("verdict", "flight", "with", "found"), cases),))
    ]
    if verdicts:
        rows = [(WORDS[one.met], one.group, one.name, one.found) for one in verdicts]
        table = Table(("verdict", "", "of", "found"), rows)
        sections.insert(0, PageSection("verdicts", "Population", tables=(table,)))
    return sections_page(PageHeader("Judgement", name, (software,), [badge], tiles), sections)
