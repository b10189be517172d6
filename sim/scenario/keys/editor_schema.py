"""The schema of scenario files as JSON Schema, by which editors complete and check them."""

import json
from typing import Any

from fsw.table.table import FlightTable
from sim.scenario.schema import Scenario

UNITS = (
    ("_nt_per_am2", "nT per A m^2"),
    ("_nm_rts", "N m sqrt(s)"),
    ("_nms_per_t2", "N m s/T^2"),
    ("_per_ampere_am2", "A m^2 per A"),
    ("_degps", "deg/s"),
    ("_radps", "rad/s"),
    ("_wpm2", "W/m^2"),
    ("_kgm2", "kg m^2"),
    ("_am2", "A m^2"),
    ("_nms", "N m s"),
    ("_percent", "%"),
    ("_orbits", "orbits"),
    ("_orbit", "orbits"),
    ("_days", "days"),
    ("_deg", "deg"),
    ("_ohm", "ohm"),
    ("_km", "km"),
    ("_m2", "m^2"),
    ("_nt", "nT"),
    ("_nm", "N m"),
    ("_hz", "Hz"),
    ("_m", "m"),
    ("_s", "s"),
    ("_j", "J"),
)
"""Units by the suffix of a key, longer ones before those that they end with."""
OF_GAINS = {"k_w": "N m s/T^2", "k_a": "N m/T^2", "k_i": "N m/(T^2 s)", "orbits": "orbits"}


def unit_of(key: str) -> str:
    """The unit that a key's name ends with; empty for one that has none."""
    return OF_GAINS.get(key) or next((unit for end, unit in UNITS if key.endswith(end)), "")


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a scenario file; it cannot check conditions on several keys.

    ``flight`` has the keys of the onboard table, none of which is required there.
    """
    schema = Scenario.model_json_schema()
    onboard = FlightTable.model_json_schema(ref_template="#/$defs/Flight{model}")
    for section in onboard["properties"].values():
        section.pop("default", None)  # an object of nulls, which a file cannot hold
    sections: dict[str, Any] = schema["$defs"]
    for name, section in onboard["$defs"].items():
        sections[f"Flight{name}"] = {key: value for key, value in section.items() if key != "required"}
    schema["properties"]["flight"] = {
        "type": "object",
        "description": "Values of the onboard table that differ from those above.",
        "additionalProperties": False,
        "properties": onboard["properties"],
    }
    _for_people([schema, *sections.values()])
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def as_text() -> str:
    """The schema as the text of a file."""
    return json.dumps(json_schema(), indent=1) + "\n"


def _for_people(sections: list[dict[str, Any]]) -> None:
    """Drop the titles, which repeat the names, and give each key its unit."""
    for section in sections:
        section.pop("title", None)
        for key, value in section.get("properties", {}).items():
            value.pop("title", None)
            if unit := unit_of(key):
                value["description"] = unit
