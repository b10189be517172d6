"""The page of all keys of a scenario, written from the schema."""

from collections.abc import Mapping, Sequence
from typing import Any

from fsw.table.table import default_values
from sim.scenario.keys.editor_schema import json_schema, unit_of

HEAD = """# Scenario keys

Written from the schema by `tools/write_pages.py`. Every key of a scenario file, by section, with
its unit, what is allowed, and its default; one with no default is optional. A name ends with its
unit, components are in body axes. `torquer sil --set SECTION.KEY=VALUE` lays a value over any of them.

`torquer scenarios --schema > scenario.schema.json` writes the schema as JSON Schema. Editors with Taplo
(VS Code: Even Better TOML) complete and check a file that begins with `#:schema scenario.schema.json`.
"""
FLIGHT = """## [flight]

Values of the onboard table that differ from those above, for instance the inertia that the controller
assumes. Values that both share (orbit, body, coils, control, time) are taken from the scenario, all
others from `fsw/flight.toml`.
"""
_BOUNDS = {
    "minimum": "at least",
    "exclusiveMinimum": "above",
    "maximum": "at most",
    "exclusiveMaximum": "below",
}
_TYPES = {
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
    "object": "section",
}
_ONBOARD_ALONE = (
    "field",
    "uncertainty",
    "calibration",
    "cells",
    "estimator",
    "modes",
    "fdir",
    "telemetry",
)
"""Sections of the onboard table that a scenario does not have, or has with other keys."""
NO_DEFAULTS: Mapping[str, Any] = {}
_SAID = {
    "flight.uncertainty": "Bounds of what the table may be wrong by. One that is left out takes the ordinary "
    "value for a satellite of this size: [uncertainty.md](uncertainty.md).",
    "flight.calibration.magnetometer": "b_body = matrix (reading - offset_nt): offset, and scale, "
    "non-orthogonality and turn as one matrix. Beyond a reading of `range_nt`, 65000 unless "
    "given, an axis saturates.",
    "flight.calibration": "Of this very satellite: [calibration.md](calibration.md).",
}
"""Text of sections whose docstring is for a reader of the code."""


def page() -> str:
    """The page as Markdown."""
    schema = json_schema()
    sections = schema["$defs"]
    parts = [HEAD, "## Top level\n", _table(_plain(schema), schema["required"])]
    for name, value in schema["properties"].items():
        if name != "flight":
            parts += _section(name, value, sections)
    parts.append(FLIGHT)
    onboard, defaults = schema["properties"]["flight"]["properties"], default_values()
    for name in _ONBOARD_ALONE:
        parts += _section(f"flight.{name}", onboard[name], sections, defaults.get(name, {}))
    return "\n".join(parts)


def _section(
    name: str, value: dict[str, Any], sections: dict[str, Any], defaults: Mapping[str, Any] = NO_DEFAULTS
) -> list[str]:
    """Heading, text and table of a section, and of those in it; nothing for a plain key.

    ``defaults``: of its keys where the schema has none.
    """
    parts: list[str] = []
    for target, repeated in _targets(value):
        section = sections[target]
        message = section["properties"].get("message", {}).get("const")
        heading = f"[[{name}]]" if repeated else f"[{name}]"
        said = _SAID.get(name) or _text(section)
        parts += [f"## {heading}{f' {message}' if message else ''}\n", f"{said}\n"]
        plain = _plain(section)
        if plain:
            parts.append(_table(plain, section.get("required", ()), defaults))
        for key, inner in section["properties"].items():
            parts += _section(f"{name}.{key}", inner, sections)
    return parts


def _targets(value: dict[str, Any]) -> list[tuple[str, bool]]:
    """The sections that a value refers to, and whether there may be several of each."""
    if "$ref" in value:
        return [(value["$ref"].rpartition("/")[2], False)]
    items = value.get("items", {})
    inner = [*value.get("anyOf", ()), *items.get("oneOf", ()), *([items] if "$ref" in items else ())]
    repeated = "items" in value
    return [(target, repeated or again) for each in inner for target, again in _targets(each)]


def _plain(section: dict[str, Any]) -> dict[str, Any]:
    return {
        key: value for key, value in section["properties"].items() if key != "flight" and not _targets(value)
    }


def _text(section: dict[str, Any]) -> str:
    return str(section.get("description", "")).replace("``", "`")


def _table(keys: dict[str, Any], required: Sequence[str], defaults: Mapping[str, Any] = NO_DEFAULTS) -> str:
    rows = ["| key | unit | allowed | default |", "|---|---|---|---|"]
    for key, value in keys.items():
        default = "must be given" if key in required else _default(value.get("default", defaults.get(key)))
        rows.append(f"| `{key}` | {unit_of(key)} | {_allowed(value)} | {default} |")
    return "\n".join([*rows, ""])


def _default(default: object) -> str:
    if default in (None, [], {}):
        return ""
    text = str(default).lower() if isinstance(default, bool) else str(default)
    return f"`{text}`"


def _allowed(value: dict[str, Any]) -> str:
    """What a value may be, in words."""
    if "const" in value:
        return f"`{value['const']}`"
    if "enum" in value:
        return ", ".join(f"`{each}`" for each in value["enum"])
    if "anyOf" in value:
        return " or ".join(_allowed(each) for each in value["anyOf"] if each.get("type") != "null")
    if value.get("type") == "array":
        return _list(value)
    bounds = [f"{word} {value[name]:g}" for name, word in _BOUNDS.items() if name in value]
    return f"{_TYPES[value.get('type', 'object')]} {' and '.join(bounds)}".strip()


def _list(value: dict[str, Any]) -> str:
    parts = value.get("prefixItems")
    if not parts:
        return f"list of: {_allowed(value.get('items', {'type': 'number'}))}"
    if parts[0].get("type") == "array":
        return f"{len(parts)} lists of {_list(parts[0])}"
    return f"{len(parts)} of: {_allowed(parts[0])}"
