"""``torquer faults``: what it prints, what it writes, what it ends with."""

import json
from dataclasses import replace
from math import inf
from xml.etree import ElementTree

import pytest

from sim.errors import HarnessError
from sim.fault_table import command, render
from sim.fault_table.row import CaseResult, CheckOutcome, CheckVerdict, FaultRow, RowFault, RowResult, Unseen
from sim.fault_table.rows.table import ROWS, choose_rows
from sim.faults.kinds import KINDS
from sim.junit import junit_xml
from torquer.cli.main import main


def run(*arguments):
    with pytest.raises(SystemExit) as ended:
        main.main(["faults", *map(str, arguments)], prog_name="torquer")
    return ended.value.code or 0


def case(row, *verdicts, phase=0, seed=1):
    outcomes = tuple(CheckOutcome(f"check {n}", verdict, f"said <{n}>") for n, verdict in enumerate(verdicts))
    return CaseResult(row, phase, seed, outcomes, {"pulses": 7.0, "worst step ms": 1.0}, 0.5)


@pytest.fixture
def planted():
    """A row that passes, one that fails in one of two cases, one that is open."""
    passes, fails, is_open = (
        choose_rows(["none"])[0],
        choose_rows(["loss-50"])[0],
        choose_rows(["second-sender"])[0],
    )
    return [
        RowResult(passes, (case(passes.name, CheckVerdict.PASS),)),
        RowResult(
            fails,
            (
                case(fails.name, CheckVerdict.PASS),
                case(fails.name, CheckVerdict.PASS, CheckVerdict.FAIL, phase=3),
            ),
        ),
        RowResult(is_open, (case(is_open.name, CheckVerdict.OPEN),)),
    ]


def reporting(results):
    """Stands for ``fly_rows``: the rows are done, one after the other."""
    return lambda rows, phases, seeds, workers, watch, report: [report(one) or one for one in results]


@pytest.mark.long
def test_a_row_is_flown_in_every_phase_with_every_seed(capsys, tmp_path):
    code = run(
        "--row",
        "queue-full",
        "--row",
        "time-jumps",
        "--phases",
        2,
        "--seeds",
        2,
        "--workers",
        1,
        "--out",
        tmp_path,
    )
    printed = capsys.readouterr().out
    assert code == 0
    assert "time-jumps" in printed
    assert "2 rows, 8 cases: 2 rows passed, 0 failed; 0 violations of the coil limits" in printed
    written = json.loads((tmp_path / "faults.json").read_text())
    cases = [(one["phase"], one["seed"]) for one in written["rows"][0]["cases"]]
    assert cases == [(0, 1), (0, 2), (1, 1), (1, 2)]


@pytest.mark.long
def test_json_is_json_alone(capsys):
    assert run("--row", "queue-full", "--json", "--workers", 1) == 0
    printed = json.loads(capsys.readouterr().out)
    assert [row["row"] for row in printed["rows"]] == ["queue-full"]
    assert printed["rows"][0]["verdict"] == "PASS"


def test_a_violated_expectation_is_exit_code_1(planted, monkeypatch, capsys):
    monkeypatch.setattr(command, "fly_rows", reporting(planted))
    assert run("--workers", 1) == 1
    monkeypatch.setattr(command, "fly_rows", reporting([planted[0], planted[2]]))
    assert run("--workers", 1) == 0


def test_a_row_tells_all_its_faults_its_settings_and_by_when_they_must_be_named():
    row = FaultRow(
        "planted",
        "",
        "mag_late",
        {"ticks": 7.0},
        expect=("named",),
        unit="magnetometer",
        within_s=900.0,
        then=(RowFault("sun_swapped", {}, inf, "sun sensor", 60.0),),
        unseen=Unseen.ALWAYS,
        settings=("initial.angle_deg=12.0",),
    )
    assert render.injected(row) == (
        "mag late, ticks 7, jitter 0, 120 s; after 60 s sun swapped, axis 0, stays; initial.angle_deg=12.0"
    )
    expected = "named (magnetometer and sun sensor, within 900 s), both sensors agree"
    assert render.expected(row) == expected


def test_the_list_names_every_row(capsys):
    assert run("--list") == 0
    printed = capsys.readouterr().out
    assert all(row.name in printed for row in ROWS)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--row", "gremlins"), "--only gremlins: there is no such row"),
        (("--phases", "0"), "--phases"),
        (("--row", "none", "--write-docs"), "--write-docs: the page is of all rows"),
    ],
)
def test_a_user_error_is_one_sentence(arguments, said, capsys):
    assert run(*arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


@pytest.mark.long
def test_cases_that_were_flown_are_not_flown_again(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("TORQUER_CACHE", str(tmp_path))
    words = ("--row", "queue-full", "--workers", 1)
    assert run(*words) == 0
    assert run(*words, "--phases", 2) == 0
    assert f"{tmp_path}: 1 of 2 results known" in capsys.readouterr().err


def test_junit_counts_failures_and_what_is_open(planted):
    root = ElementTree.fromstring(junit_xml("torquer faults", render.suites(planted)))
    counts = {
        suite.get("name"): (suite.get("tests"), suite.get("failures"), suite.get("skipped")) for suite in root
    }
    assert counts == {"none": ("1", "0", "0"), "loss-50": ("2", "1", "0"), "second-sender": ("1", "0", "1")}
    (failure,) = root.iter("failure")
    assert failure.get("message") == "check 1: said <1>"


def test_pages_name_the_failed_case_and_escape(planted):
    page = render.html(planted)
    assert "phase 3 seed 1" in page
    assert "said <1>" not in page
    assert "said &lt;1&gt;" in page
    assert "://" not in page
    markdown = render.markdown(planted, 4, 1)
    assert "1 row passed, 1 failed, 1 not yet" in markdown
    assert "1 of 2: check 1, said <1>, phase 3 seed 1" in markdown
    assert all(f"| `{kind}` |" in render.kinds_page() for kind in KINDS)


@pytest.mark.long
@pytest.mark.parametrize("width", [390, 1400])
def test_the_page_is_shown_in_a_browser_without_standing_out_sideways(look, tmp_path, planted, width):
    (tmp_path / "faults.html").write_text(render.html(planted), encoding="utf-8")
    page = look(tmp_path / "faults.html", width=width, dark=True)
    assert page.locator("td.bad").count() == 1
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_page_holds_nothing_of_the_wall_clock(planted):
    slower = [replace(one, cases=tuple(replace(case, wall_s=9.0) for case in one.cases)) for one in planted]
    assert render.markdown(planted, 1, 1) == render.markdown(slower, 1, 1)
    assert "worst step" not in render.markdown(planted, 1, 1)


def test_a_broken_limit_is_counted_over_all_cases():
    row = choose_rows(["none"])[0]
    broken = CaseResult("none", 0, 1, (CheckOutcome("limits", CheckVerdict.FAIL, "pulse of 4 s"),), {})
    assert "; 1 violation of the coil limits" in render.tally([RowResult(row, (broken,))])


def test_a_figure_that_some_cases_lack_says_how_many_have_it():
    found = [
        replace(case("late", CheckVerdict.PASS, phase=phase), measured={"pulses": 3.0}) for phase in range(3)
    ]
    found[1] = replace(found[1], measured={"pulses": 5.0, "named s": 17.2})
    line = render.line(RowResult(choose_rows(["mag-late"])[0], tuple(found)))
    assert line.endswith("pulses 5, named s 17.2 in 1 of 3")


def test_there_is_no_page_outside_a_checkout(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(HarnessError, match="no checkout"):
        command.faults((), 1, 1, False, None, 1, True)
