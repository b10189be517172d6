"""``torquer.calibrate``: sensors, coils and body from what they sent, or what was recorded."""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Strict

from fsw.input.schema import Section
from sim.commissioning.calibrate.command import PARAMETERS, calibrate_recorded, fault_of_ratios
from sim.commissioning.calibrate.flown import command as flown
from sim.commissioning.report import CommissioningReport
from sim.errors import HarnessError, refuse
from sim.progress import shown
from torquer.api.arguments import Settings, checked, laid_over, optional_path, path_text
from torquer.api.errors import one_sentence
from torquer.api.printed import CommissioningResult


class _CalibrateOptions(Section):
    inertia_ratios: Annotated[tuple[float, ...], Strict(False)] | None
    parameters: Literal[9, 12]


class SatelliteCalibration(CommissioningResult):
    """What was calibrated; ok where everything that is asked for is determined."""

    @property
    def magnetometer(self) -> Mapping[str, Any]:
        """What is determined of the magnetometer, by telemetry each parameter, by a log offset and matrix."""
        of_telemetry: Mapping[str, Any] | None = self.values.get("magnetometer")
        if of_telemetry is not None:
            return of_telemetry
        names = ("offset_nt", "offset_sigma_nt", "matrix", "matrix_sigma")
        return {name: self.values[name] for name in names}

    @property
    def written(self) -> Path | None:
        """The file of the calibration; None if there is none."""
        file: Path | None = self.values["out"]
        return file


@one_sentence
def calibrate(
    source: str | PathLike[str],
    *,
    scenario: str | PathLike[str] | None = None,
    set: Settings | None = None,
    tle: str | PathLike[str] | None = None,
    inertia_ratios: Sequence[float] | None = None,
    parameters: int = 9,
    out: str | PathLike[str] | None = None,
    page: str | PathLike[str] | None = None,
    progress: bool = False,
) -> SatelliteCalibration:
    """Calibrate by a run or log with pulses, or by recorded telemetry, as ``torquer calibrate`` does.

    Args:
        source: a run, its directory, a log, or ``PASS.csv``, which needs ``tle`` and ``out``.
        scenario: of a log that has none beside it.
        set: values laid over that scenario by key.
        tle: two-line element sets of a ``PASS.csv``; of many the nearest is taken.
        inertia_ratios: of a ``PASS.csv``: moments of inertia about the body axes; None: a sphere's.
        parameters: of a ``PASS.csv``: 9, offset and symmetric matrix, or 12, a turn of the axes besides.
        out: the file to write; None: none.
        page: HTML page with the residuals; None: none.
        progress: show progress on stderr.

    Raises:
        InputError: an argument that belongs to the other kind of source, or a file cannot be read or written.
    """
    options = checked(_CalibrateOptions, "calibrate", inertia_ratios=inertia_ratios, parameters=parameters)
    path, file, drawn = (
        Path(path_text(source, "source")),
        optional_path(out, "out"),
        optional_path(page, "page"),
    )
    elements, over = optional_path(tle, "tle"), laid_over(set)
    of_log = None if scenario is None else path_text(scenario, "scenario")
    with shown(progress):
        if path.suffix.lower() == ".csv":
            refuse(
                {"--scenario": of_log is not None, "--set": bool(over)},
                f"recorded telemetry in {path} is calibrated without a scenario",
            )
            return SatelliteCalibration(_of_telemetry(path, elements, file, drawn, options))
        of_telemetry = {
            "--tle": elements is not None,
            "--inertia-ratios": options.inertia_ratios is not None,
            "--parameters": options.parameters != PARAMETERS[0],
        }
        refuse(of_telemetry, f"{path} is no PASS.csv")
        return SatelliteCalibration(flown.calibrate(path, of_log, over, file, drawn))


def _of_telemetry(
    path: Path, tle: Path | None, out: Path | None, page: Path | None, options: _CalibrateOptions
) -> CommissioningReport:
    ratios = options.inertia_ratios
    if tle is None or out is None:
        raise HarnessError(f"{path}: recorded telemetry needs {'--tle' if tle is None else '--out'} FILE")
    if ratios is not None and (fault := fault_of_ratios(ratios)):
        raise HarnessError(f"--inertia-ratios: {fault}")
    return calibrate_recorded(path, tle, out, page, ratios, options.parameters)
