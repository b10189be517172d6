"""Where the satellite was above the Earth, and where its coils were driven."""

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from sim.audit.findings import COILS
from sim.drawing.canvas import AXES_COLOURS, INK, WIDTH_IN, legend
from sim.drawing.coastline import coastlines
from sim.drawing.time_chart import DrawnChart
from sim.plant.environment.earth import gmst82_rad, turn_about_pole
from sim.report.charts.coils import shown
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.figures.histories import DARK
from sim.value_types import Array

LAND, COAST = "#e8e6df", "#8a97a5"


def track(flight: DrawnFlight) -> DrawnChart:
    """The track on an equirectangular map."""
    motion = flight.lines.motion
    longitude, latitude = below_deg(flight)
    height_in = 0.91 / 0.775 * WIDTH_IN / 2.0
    picture = Figure(figsize=(WIDTH_IN, height_in))
    panel = picture.subplots(gridspec_kw={"left": 0.075, "right": 0.985, "bottom": 0.105, "top": 0.88})
    panel.add_collection(PolyCollection(coastlines(), facecolors=LAND, edgecolors=COAST, linewidths=0.4))
    dark = motion.samples("lit")[:, 0] < DARK
    panel.plot(*broken(longitude, latitude), color=INK, linewidth=0.6, label="track")
    if dark.any():
        shadow = broken(np.where(dark, longitude, np.nan), latitude)
        panel.plot(*shadow, color=INK, linewidth=1.6, label="in eclipse")
    for coil, colour in zip(COILS, AXES_COLOURS, strict=True):
        pulses = shown([pulse for pulse in flight.audit.pulses if pulse.coil == coil], flight.length_s)
        at = np.searchsorted(motion.places, [float(pulse.start_s) * flight.tick_hz for pulse in pulses])
        at = np.unique(np.minimum(at, len(longitude) - 1))
        panel.plot(longitude[at], latitude[at], ".", color=colour, markersize=4.0, label=f"coil {coil}")
    panel.set_xlim(-180.0, 180.0)
    panel.set_ylim(-90.0, 90.0)
    panel.set_xticks(range(-180, 181, 60))
    panel.set_yticks(range(-90, 91, 30))
    panel.set_xlabel("longitude [deg]")
    panel.set_ylabel("latitude [deg]")
    panel.set_title("Ground track")
    legend(panel)
    return DrawnChart(picture)


def below_deg(flight: DrawnFlight) -> tuple[Array, Array]:
    """Longitude, -180 to 180, and geocentric latitude of the point below at each sample, (samples,) each."""
    motion = flight.lines.motion
    t_s, r_eci_m = motion.places / flight.tick_hz, motion.samples("r_eci_m")
    x, y, z = turn_about_pole(gmst82_rad(flight.start_unix_s, t_s), r_eci_m).T
    return np.degrees(np.arctan2(y, x)), np.degrees(np.arctan2(z, np.hypot(x, y)))


def broken(longitude: Array, latitude: Array) -> tuple[Array, Array]:
    """A track with a gap wherever it leaves the map on one side and comes back on the other."""
    leaps = np.flatnonzero(np.abs(np.diff(longitude)) > 180.0) + 1
    return np.insert(longitude, leaps, np.nan), np.insert(latitude, leaps, np.nan)
