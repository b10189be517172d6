"""
A campaign's distribution
=========================

No two satellites of a series are alike. A campaign flies many, each drawn at random, and says what part
of them meets a requirement, with bounds. Twelve short flights here; a real one has hundreds.
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt

import torquer

folder = Path(mkdtemp())
definition = folder / "campaign.toml"
definition.write_text("""
scenario = "microsat"
runs = 12
orbits = 0.6

[[disperse]]
key = "initial.angle_deg"
distribution = "uniform"
low = 0.0
high = 60.0
""")
done = torquer.campaign(definition, out=folder / "runs")

results = done.results
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
axes.scatter(results["input_initial_angle_deg"], results["pointing_deg_rms_last_orbit"])
axes.set(xlabel="angle at the start, deg", ylabel="pointing error over the flight, deg RMS")

# %%
# ``done.page`` is the page with all statistics; in short:

print(done)

# sphinx_gallery_thumbnail_path = '_static/gallery/plot_5_campaign.png'
