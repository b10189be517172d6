"""``torquer calibrate`` of a run or a log."""

from pathlib import Path

import numpy as np
import tomli_w

from fsw.input.schema import Nested, TableError, merge, validated
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.run_fit import RunCalibration, calibrated
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.commissioning.calibrate.flown.tables import tables
from sim.commissioning.calibrate.flown.verdicts import list_undetermined, sentences, turn_rad, turn_sigma_rad
from sim.commissioning.report import CommissioningReport, ReportLine, in_lines
from sim.console import warn
from sim.errors import HarnessError
from sim.record import run_dir
from sim.result_files import check_results, write_result
from sim.scenario.schema import flight_table


def calibrate(
    run_or_log: Path, scenario: str | None, settings: Nested, out: Path | None, page: Path | None
) -> CommissioningReport:
    """Calibrate by a log; ok if it tells everything, and well enough for the tables.

    Raises:
        HarnessError: no such log, no scenario for it, it tells nothing of the magnetometer, or a file to
            write is one of the run, or cannot be written.
        TableError: the scenario is not valid.
    """
    log, folder = run_dir.locate(run_or_log)
    check_results({"--out": out, "--page": page}, _read(log, scenario))
    table = flight_table(run_dir.scenario_of_log(log, folder, scenario, settings))
    if table.calibration.model_dump(exclude_none=True):
        warn(
            "the scenario's table is calibrated already; the log holds what the boards sent, and so is judged"
        )
    tick_s = 1.0 / table.time.tick_hz
    samples = read_samples(log, table.time.tick_hz)
    try:
        found = calibrated(samples, table)
    except HarnessError as error:
        raise HarnessError(f"{log}: {error}") from None
    missing = list_undetermined(found)
    lines = in_lines(sentences(found, tick_s)) + in_lines(
        (f"not determined: {one}" for one in missing), failed=True
    )
    text, fault = _tables(found, table)
    if text and out is not None:
        write_result(out, text)
        lines.append(ReportLine(f"written: {out}"))
    elif out is not None:
        lines.append(ReportLine(f"{out}: {fault}", failed=True))
    if page is not None:
        from sim.commissioning.calibrate.flown.page import calibration_page  # noqa: PLC0415  (loads matplotlib)

        html = calibration_page(found, run_or_log.name, tick_s, float(samples.unix_s[0]), text)
        write_result(page, html)
    values = _as_json(found, tick_s, missing, out if text else None, page)
    return CommissioningReport(tuple(lines), values, not missing and (out is None or bool(text)))


def _read(log: Path, scenario: str | None) -> dict[str, Path | None]:
    """The files that must not be replaced: log and scenario, and whatever else the run holds."""
    of_run = {name: log.parent / name for name in run_dir.FILES}
    named = Path(scenario) if scenario is not None and scenario.endswith(".toml") else None
    return {
        "the log": log,
        "the scenario": named,
        **{f"the run's {name}": path for name, path in of_run.items() if path.is_file()},
    }


def _tables(found: RunCalibration, table: FlightTable) -> tuple[str, str]:
    """Both tables as TOML, or why there are none; with them the onboard table can be read."""
    try:
        new = tables(found, table)
        validated(FlightTable, merge(table.model_dump(), new), "no table is written, as none could fly by it")
        return tomli_w.dumps(new), ""
    except (HarnessError, TableError) as error:
        return "", str(error)


def _as_json(
    found: RunCalibration, tick_s: float, missing: list[str], out: Path | None, page: Path | None
) -> Nested:
    field, response = found.field, found.response
    sigma = np.sqrt(field.covariance.diagonal())
    late, late_sigma = response.delay_ticks, response.delay_sigma
    coils = found.coils
    return {
        "told": not missing,
        "untold": missing,
        "offset_nt": field.offset_nt.tolist(),
        "offset_sigma_nt": sigma[9:].tolist(),
        "matrix": field.matrix.tolist(),
        "matrix_sigma": sigma[:9].reshape(3, 3).tolist(),
        "turn_deg": np.degrees(turn_rad(found)).tolist(),
        "turn_sigma_deg": np.degrees(turn_sigma_rad(found)).tolist(),
        "field_nt_per_am2": found.field_nt_per_am2.tolist(),
        "field_sigma": found.field_sigma.tolist(),
        "field_delay_s": None if late is None else late * tick_s,
        "field_delay_sigma_s": None if late_sigma is None else late_sigma * tick_s,
        "coil_matrix": None if coils is None else coils.matrix.tolist(),
        "coil_sigma": None if coils is None else np.sqrt(coils.covariance.diagonal()).reshape(3, 3).tolist(),
        "pulses": list(response.pulses),
        "residual_nt_rms": np.sqrt(np.nanmean(found.residual_nt**2, axis=0)).tolist(),
        "widened": found.widened,
        "out": out,
        "page": page,
    }
