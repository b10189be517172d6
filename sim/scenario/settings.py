"""Settings of a program, laid over a scenario: keys with dots, values of Python and numpy."""

import json
from collections.abc import Iterator, Mapping
from functools import reduce
from pathlib import PurePath

import numpy as np
from pydantic import BaseModel

from fsw.input.schema import Nested, TableError, merge
from fsw.input.toml_text import MOST_LEVELS


def nested(settings: Mapping[str, object] | None) -> Nested:
    """Settings as the sections of a scenario: ``{"time.tick_hz": 10}`` is ``{"time": {"tick_hz": 10}}``.

    Arrays and numbers of numpy become lists and numbers, as TOML has them.

    Raises:
        TableError: not a mapping, a key that cannot be one, or values that are nested too deeply.
    """
    if settings is None:
        return {}
    if not isinstance(settings, Mapping):
        raise TableError(f"set = {settings!r:.80}: give a dictionary such as {{'time.tick_hz': 10}}")
    return reduce(merge, (_section(key, value) for key, value in settings.items()), {})


def settings_texts(settings: Nested) -> list[str]:
    """Settings as ``KEY=VALUE``, as ``--set`` takes them."""
    return [
        f"{key}={value if isinstance(value, str) else json.dumps(value, default=str)}"
        for key, value in flat(settings)
    ]


def flat(settings: Nested, prefix: str = "") -> Iterator[tuple[str, object]]:
    """Each value under its whole key, ``time.tick_hz``."""
    for key, value in settings.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def plain(value: object, levels: int = MOST_LEVELS) -> object:
    """A value as TOML has it, of at most ``levels`` levels.

    Raises:
        TableError: it has more.
    """
    if not levels:
        raise TableError(f"set: a value has more than {MOST_LEVELS} levels")
    match value:
        case np.generic() | np.ndarray():
            return value.tolist()
        case PurePath():
            return str(value)
        case BaseModel():
            return value.model_dump(mode="json", exclude_none=True)
        case Mapping():
            return {key: plain(one, levels - 1) for key, one in value.items()}
        case list() | tuple():
            return [plain(one, levels - 1) for one in value]
    return value


def _section(key: object, value: object) -> Nested:
    parts = key.strip().split(".") if isinstance(key, str) else [""]
    if not all(parts) or len(parts) > MOST_LEVELS:
        raise TableError(f"set: {key!r:.80} is no key of a scenario such as 'time.tick_hz'")
    section: Nested = {parts[-1]: plain(value)}
    for part in reversed(parts[:-1]):
        section = {part: section}
    return section
