"""The pulses of a run and the runs of a campaign as pandas tables. The extra ``torquer[data]``."""

from pathlib import Path
from typing import TYPE_CHECKING

from sim.audit.findings import AuditReport
from sim.campaign.results.store import read_results
from sim.scenario.schema import Scenario
from torquer.api.errors import required

if TYPE_CHECKING:
    import pandas as pd


def pulses(report: AuditReport, scenario: Scenario) -> "pd.DataFrame":
    """A row for each pulse: coil 0 to 2, level -3 to 3, nominal dipole, start, end and length.

    Times are from tick 0. A pulse that was driven at no level of the scenario has no dipole.
    """
    pandas = required("pandas", "run.pulses")
    levels_am2 = dict(enumerate(scenario.coils.levels_am2, start=1))
    dipoles_am2 = {sign * level: sign * m for level, m in levels_am2.items() for sign in (1, -1)}
    rows = [
        {
            "coil": pulse.coil,
            "level": pulse.level,
            "dipole_am2": dipoles_am2.get(pulse.level),
            "start_s": float(pulse.start_s),
            "end_s": float(pulse.end_s),
            "length_s": float(pulse.length_s),
        }
        for pulse in report.pulses
    ]
    columns = {
        "coil": int,
        "level": int,
        "dipole_am2": float,
        "start_s": float,
        "end_s": float,
        "length_s": float,
    }
    table: pd.DataFrame = pandas.DataFrame(rows, columns=list(columns)).astype(columns)
    return table


def results(folder: Path) -> "pd.DataFrame":
    """Table ``runs`` of a campaign, by the number of the run; a figure that a run has not is NaN.

    Raises:
        HarnessError: there are no results, or pandas is missing.
    """
    pandas = required("pandas", "campaign.results")
    with read_results(folder) as stored:
        kinds = stored.kinds()
        table: pd.DataFrame = pandas.DataFrame(stored.each(list(kinds)), columns=list(kinds))
    numbers = {name: float for name, kind in kinds.items() if kind in ("REAL", "NUMERIC")}
    return table.astype(numbers).set_index("run")
