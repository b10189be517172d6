"""run.json: its keys, checked once when it is read."""

from pathlib import Path
from typing import Annotated, Literal, NotRequired, cast

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, with_config
from pydantic_core import from_json
from typing_extensions import TypedDict

from fsw.input.regular_file import read_regular
from fsw.input.schema import faults
from sim.errors import HarnessError
from sim.scenario.names import Name

SCHEMA_VERSION = 1
MOST_BYTES = 1_000_000
_OPEN = ConfigDict(strict=True, extra="allow", allow_inf_nan=False)
"""Unknown keys are accepted: a later version may write more under the same schema version."""

Text = Annotated[str, Field(max_length=1000)]
Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
Count = Annotated[int, Field(ge=0, lt=2**32)]


@with_config(_OPEN)
class Platform(TypedDict):
    """The platform of the run; ``run_dir.fingerprint`` has more keys.

    ``algebra``: what computes the filter's matrices there, unless the table names another.
    """

    machine: Text
    system: Text
    python: Text
    numpy: Text
    algebra: NotRequired[Text]


@with_config(_OPEN)
class CompletedFlightRecord(TypedDict):
    """The outcome of a completed flight."""

    ticks: Count
    slips: NotRequired[Count]
    wall_s: NotRequired[Annotated[float, Field(ge=1e-6, le=1e12)]]


@with_config(_OPEN)
class FlightRecord(TypedDict):
    """The part of run.json that a summary needs. ``flown`` is present once the flight has ended."""

    seed: Annotated[int, Field(ge=0, lt=2**64)]
    flown: NotRequired[CompletedFlightRecord]


@with_config(_OPEN)
class SenderRecord(TypedDict):
    """Frames of a second sender under one identifier; ``tick`` is that of the first."""

    message: Text
    id: Text
    tick: Count
    frames: Count


@with_config(_OPEN)
class LawRecord(TypedDict):
    """The law that a program gave as an object; ``source_sha256`` is None where its source cannot be read."""

    module: Text
    qualname: Text
    source_sha256: Digest | None


@with_config(_OPEN)
class SoftwareRecord(TypedDict):
    """A user's flight software: what was started, and what it answers by its profile.

    ``command``: None where it ran already.
    """

    command: Text | None
    profile: Text


@with_config(_OPEN)
class FrameRecord(TypedDict):
    """A frame: its identifier with the flags of ``can_id``, and its data in hexadecimal digits."""

    id: Count
    data: Annotated[str, Field(pattern="^([0-9A-F]{2}){0,8}$")]


@with_config(_OPEN)
class UnheardRecord(TypedDict):
    """What the flight software sent where it did not answer ``tick``, or (None) did not boot."""

    tick: Count | None
    frames: list[FrameRecord]


@with_config(_OPEN)
class RunRecord(FlightRecord):
    """run.json.

    ``code``: whether the flight code ran compiled; ``algebra``: what computed the filter's matrices;
    ``ended``: why a flight was not completed, where the plant knows; ``unheard``: what came instead of the
    answer for want of which it ended; ``law_object``: only whoever has that
    law can replay the run; ``flight_software``: another one than this project's has flown.
    """

    schema_version: int
    torquer_version: Text
    scenario: Text
    scenario_sha256: Digest
    flight_table_crc: Annotated[str, Field(pattern="^[0-9a-f]{8}$")]
    ticks: Annotated[int, Field(ge=1, lt=2**32)]
    bus: Text
    pace: Literal["lockstep", "realtime"]
    pace_factor: Annotated[float, Field(gt=0.0, le=1e6)] | None
    platform: Platform
    complete: bool
    compressed: NotRequired[bool]
    code: NotRequired[Literal["compiled", "interpreted"]]
    digests: NotRequired[dict[Name, Digest]]
    algebra: NotRequired[Text]
    second_senders: NotRequired[list[SenderRecord]]
    ended: NotRequired[Text]
    unheard: NotRequired[UnheardRecord]
    law_object: NotRequired[LawRecord]
    flight_software: NotRequired[SoftwareRecord]


_RECORD = TypeAdapter(RunRecord)


def read_record(path: Path) -> RunRecord:
    """The content of a run.json.

    Raises:
        OSError: it cannot be read.
        HarnessError: not JSON, of another version, or a key is missing, not what it should be, or contradicts
            another.
    """
    try:
        content = from_json(read_regular(path, MOST_BYTES), allow_inf_nan=False)
    except ValueError as error:
        raise HarnessError(f"{path}: not JSON: {error}") from None
    found = content.get("schema_version") if isinstance(content, dict) else None
    if type(found) is not int or found != SCHEMA_VERSION:
        raise HarnessError(f"{path}: schema_version is {found}, and only {SCHEMA_VERSION} can be read")
    try:
        _RECORD.validate_python(content)
    except ValidationError as error:
        raise HarnessError(f"{path}: {faults(RunRecord, error)}") from None
    if content["complete"] and "flown" not in content:
        raise HarnessError(f"{path}: complete is true, but flown, which every complete run has, is missing")
    return cast(RunRecord, content)  # not pydantic's copy, whose keys are in another order
