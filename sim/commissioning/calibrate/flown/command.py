"""``torquer calibrate`` of a run or a log."""

from pathlib import Path

import numpy as np
import tomli_w

from fsw.input.schema import Nested
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.run_fit import RunCalibration, calibrated
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.commissioning.calibrate.flown.tables import tables
from sim.commissioning.calibrate.flown.verdicts import sentences, turn_rad, turn_sigma_rad, untold
from sim.console import answer, say, warn
from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.destination import check_file
from sim.scenario.schema import flight_table, load


def calibrate(
    run_or_log: Path, scenario: str | None, settings: Nested, out: Path | None, page: Path | None
) -> int:
    """Calibrate by a log: exit code 1 if it does not tell everything.

    Raises:
        HarnessError: no such log, no scenario for it, or it tells nothing of the magnetometer.
        TableError: the scenario is not valid.
    """
    for path in (out, page):
        if path is not None:
            check_file(path)
    log, folder = run_dir.locate(run_or_log)
    beside = folder / run_dir.SCENARIO
    if scenario is None and not beside.is_file():
        raise HarnessError(f"{log}: no {run_dir.SCENARIO} beside it: name its scenario by --scenario")
    table = flight_table(load(scenario or str(beside), settings))
    if table.calibration.model_dump(exclude_none=True):
        warn(
            "the scenario's table is calibrated already; the log holds what the boards sent, and so is judged"
        )
    tick_s = 1.0 / table.time.tick_hz
    samples = read_samples(log, table.time.tick_hz)
    found = calibrated(samples, table)
    missing = untold(found)
    for line in sentences(found, tick_s):
        say(line)
    for line in missing:
        say(f"not told: {line}", failed=True)
    text = _written(found, table, out)
    if page is not None:
        from sim.commissioning.calibrate.flown.page import calibration_page  # noqa: PLC0415  (loads matplotlib)

        html = calibration_page(found, run_or_log.name, tick_s, float(samples.unix_s[0]), text)
        page.write_text(html, encoding="utf-8")
    answer(_as_json(found, tick_s, missing, out, page))
    return int(bool(missing))


def _written(found: RunCalibration, table: FlightTable, out: Path | None) -> str:
    """Both tables as TOML, which is written where a file is named."""
    try:
        text = tomli_w.dumps(tables(found, table))
    except HarnessError:
        if out is not None:
            raise
        return ""
    if out is not None:
        out.write_text(text, encoding="utf-8")
    return text


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
