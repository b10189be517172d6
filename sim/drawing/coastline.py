"""The land of the Earth in outline, from Natural Earth at 1:110 million."""

import json
from importlib import resources

import numpy as np

from sim.value_types import Array


def coastlines() -> list[Array]:
    """Closed outlines, each (points, 2): longitude and latitude [deg], to a tenth."""
    file = resources.files("sim.drawing").joinpath("vendor/land-110m.json")
    topology = json.loads(file.read_text(encoding="utf-8"))
    scale, origin = (np.array(topology["transform"][name]) for name in ("scale", "translate"))
    arcs = [np.cumsum(np.array(arc), axis=0) * scale + origin for arc in topology["arcs"]]
    (land,) = topology["objects"]["land"]["geometries"]
    rings = [ring for polygon in land["arcs"] for ring in polygon]
    outlines = [np.concatenate([_arc(arcs, number) for number in ring]).round(1) for ring in rings]
    return [part for outline in outlines for part in _on_the_map(outline)]


def _on_the_map(outline: Array) -> list[Array]:
    """An outline that leaves the map on one side is drawn there and, shifted, on the other."""
    longitude = np.unwrap(outline[:, 0], period=360.0)
    if abs(longitude[-1] - longitude[0]) > 1.0 or np.ptp(outline[:, 0]) == np.ptp(longitude):
        return [outline]
    whole = np.column_stack((longitude, outline[:, 1]))
    side = -360.0 if longitude.max() > 180.0 else 360.0
    return [whole, whole + np.array((side, 0.0))]


def _arc(arcs: list[Array], number: int) -> Array:
    """An arc of the topology; its complement is the same backwards."""
    return arcs[number] if number >= 0 else arcs[~number][::-1]
