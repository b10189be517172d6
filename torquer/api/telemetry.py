"""``torquer.telemetry``: the flight filter over what a satellite recorded."""

from os import PathLike
from pathlib import Path

from pydantic import Field

from fsw.input.schema import Section
from sim.commissioning.telemetry import command
from sim.progress import shown
from torquer.api.arguments import checked, optional_path, path_text
from torquer.api.errors import one_sentence
from torquer.api.printed import CommissioningResult


class _TelemetryOptions(Section):
    start_s: float = Field(ge=20.0, le=100000.0)


class FollowedPass(CommissioningResult):
    """A recorded pass that the flight filter has followed; ok where its motion can be believed."""

    @property
    def rate_degps(self) -> tuple[float, float, float]:
        """Mean rate, body axes."""
        x, y, z = self.values["rate_degps_mean"]
        return x, y, z

    @property
    def reason(self) -> str | None:
        """Why it cannot be believed."""
        reason: str | None = self.values["reason"]
        return reason


@one_sentence
def telemetry(
    recorded: str | PathLike[str],
    *,
    tle: str | PathLike[str],
    calibration: str | PathLike[str] | None = None,
    start_s: float = 400.0,
    page: str | PathLike[str] | None = None,
    progress: bool = False,
) -> FollowedPass:
    """Run the flight filter, without gyros, over recorded telemetry, as ``torquer telemetry`` does.

    Args:
        recorded: ``PASS.csv``.
        tle: two-line element sets; of many the nearest is taken.
        calibration: what ``torquer.calibrate`` has written; None: samples as they are.
        start_s: seconds of field from which the filter starts.
        page: HTML page to write; None: none.
        progress: show progress on stderr.

    Raises:
        InputError: a file cannot be read or written, is malformed, or would replace another of them.
    """
    options = checked(_TelemetryOptions, "telemetry", start_s=start_s)
    of_pass, elements = Path(path_text(recorded, "recorded")), Path(path_text(tle, "tle"))
    known, drawn = optional_path(calibration, "calibration"), optional_path(page, "page")
    with shown(progress):
        return FollowedPass(command.telemetry(of_pass, elements, known, drawn, options.start_s))
