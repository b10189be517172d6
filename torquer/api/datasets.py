"""A run's histories as xarray datasets with units; pulses, and runs of campaigns, as pandas tables.

The extra ``torquer[data]``.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.core.state import FlightState
from fsw.table.config import flight_config
from fsw.wire.messages import Mode
from sim.audit.findings import AuditReport
from sim.campaign.results.store import read_results
from sim.faults.section import forge_answers
from sim.record import run_dir
from sim.record.estimates import EstimateRecorder, Estimates
from sim.record.run_record import RunRecord
from sim.record.truth import COLUMNS, OF_WHEEL, Histories, read_truth
from sim.replay.log_replay import replay
from sim.report.figures.attitude_arrays import angle_rad, axis1_angle_rad, law_attitude
from sim.report.figures.histories import FlightHistories
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from torquer.api.errors import required

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

TORQUES = "torque_body_nm"
_AXES = {
    "quaternion": ([0, 1, 2, 3], "component of the quaternion, scalar first"),
    "body": ([1, 2, 3], "body axis"),
    "eci": ([1, 2, 3], "axis of TEME of date"),
}
"""Coordinates of the components by dimension."""
_TIME, _BODY, _QUATERNION = ("time",), ("time", "body"), ("time", "quaternion")
_DIMENSIONS = {"q_body_from_orbit": _QUATERNION, "r_eci_m": ("time", "eci")}
"""Of the histories whose components are not along the body axes."""
RELATIVE_RATE = "rate of the body relative to the orbital frame, body axes"


class _Variable(NamedTuple):
    """A variable of a dataset; its name says quantity, frame and unit."""

    name: str
    dimensions: tuple[str, ...]
    units: str
    meaning: str
    values: NDArray[np.generic]


def truth(path: "Path", scenario: Scenario, record: RunRecord) -> "xr.Dataset":
    """The histories of the plant, of as many ticks as are whole.

    Raises:
        HarnessError: the file is missing or damaged, or xarray is.
    """
    histories = read_truth(path / run_dir.TRUTH)
    variables = [
        _Variable(name, _dimensions(name, width), unit, meaning, histories[name])
        for name, width, unit, meaning in (*COLUMNS, OF_WHEEL)
        if name != "t_s" and name in histories
    ]
    sources = {
        name.partition("/")[2]: torque for name, torque in histories.items() if name.startswith(TORQUES)
    }
    torques = np.stack(list(sources.values()), axis=1)
    q_law_from_orbit = law_attitude(histories["q_body_from_orbit"], scenario.body.law_axes)
    pointing_deg, axis1_deg = (np.degrees(of(q_law_from_orbit)) for of in (angle_rad, axis1_angle_rad))
    variables += [
        _Variable(TORQUES, ("time", "source", "body"), "N m", "torque by source, body axes", torques),
        _Variable("pointing_deg", _TIME, "deg", "angle from the nominal to the true attitude", pointing_deg),
        _Variable(
            "axis1_deg", _TIME, "deg", "angle of axis 1, that looks up, from the local vertical", axis1_deg
        ),
    ]
    return _dataset(variables, histories, scenario, record).assign_coords(source=list(sources))


def estimate(path: "Path", scenario: Scenario, record: RunRecord) -> "xr.Dataset":
    """What the flight software estimated at every tick of the histories, by a replay of the log.

    Raises:
        HarnessError: log or histories are missing or damaged, or xarray is missing.
    """
    required("xarray", "run.estimate")  # before the replay, which takes its time
    histories = read_truth(path / run_dir.TRUTH)
    recorder = EstimateRecorder(len(histories["t_s"]))
    config = flight_config(flight_table(scenario))
    last_tick = -1

    def on_tick(state: FlightState) -> None:
        nonlocal last_tick
        recorder.take(state)
        last_tick = state.tick

    result = replay(run_dir.bus_log(path), config, on_tick, forge_answers(scenario.fault))
    variables = _estimated(recorder.estimates(), histories, last_tick)
    dataset = _dataset(variables, histories, scenario, record)
    dataset["mode"].attrs |= {
        "flag_values": [mode.value for mode in Mode],
        "flag_meanings": " ".join(mode.name for mode in Mode),
    }
    return dataset.assign_attrs(replay="bit-exact" if result.bit_exact else str(result.first_bit_difference))


def _estimated(found: Estimates, histories: Histories, last_tick: int) -> list[_Variable]:
    """The variables; a tick after the last one that the log holds has no mode."""
    both = FlightHistories(histories, found)
    mode = np.where(np.arange(len(found.mode)) <= last_tick, found.mode, np.nan)
    sigma = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
    rate, turn = found.omega_body_radps, found.q_body_from_orbit
    return [
        _Variable("q_body_from_orbit", _QUATERNION, "1", "attitude, scalar first", turn),
        _Variable("omega_body_orbit_radps", _BODY, "rad/s", RELATIVE_RATE, found.omega_body_orbit_radps),
        _Variable("omega_body_radps", _BODY, "rad/s", "inertial rate of the body, body axes", rate),
        _Variable(
            "attitude_sigma_body_rad", _BODY, "rad", "1 sigma of the attitude, body axes", sigma[:, :3]
        ),
        _Variable("rate_sigma_body_radps", _BODY, "rad/s", "1 sigma of the rate, body axes", sigma[:, 3:]),
        _Variable(
            "attitude_error_deg", _TIME, "deg", "angle from the true attitude", both.attitude_error_deg
        ),
        _Variable("rate_error_degps", _TIME, "deg/s", "error of the inertial rate", both.rate_error_degps),
        _Variable("valid", _TIME, "1", "whether the attitude is called valid", found.valid),
        _Variable("mode", _TIME, "1", "mode of the flight software", mode),
    ]


def _dimensions(name: str, width: int) -> tuple[str, ...]:
    return _TIME if width == 1 else _DIMENSIONS.get(name, _BODY)


def _dataset(
    variables: Sequence[_Variable], histories: Histories, scenario: Scenario, record: RunRecord
) -> "xr.Dataset":
    """Variables over the time of the histories, with what the run is in the attributes."""
    xarray = required("xarray", "run.truth")
    t_s = histories["t_s"]
    used = {dimension for variable in variables for dimension in variable.dimensions}
    coordinates = {
        "time": ("time", t_s, {"units": "s", "long_name": "time since tick 0"}),
        "orbit": ("time", t_s / orbit_period_s(scenario), {"units": "1", "long_name": "orbits since tick 0"}),
        **{
            name: (name, numbers, {"long_name": meaning})
            for name, (numbers, meaning) in _AXES.items()
            if name in used
        },
    }
    data = {
        variable.name: (
            variable.dimensions,
            variable.values,
            {"units": variable.units, "long_name": variable.meaning},
        )
        for variable in variables
    }
    dataset: xr.Dataset = xarray.Dataset(
        data,
        coordinates,
        run_dir.identity(scenario, record["seed"]) | {"torquer_version": record["torquer_version"]},
    )
    return dataset


# --- The pulses of a run and the runs of a campaign as pandas tables


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
