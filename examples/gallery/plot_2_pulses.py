"""
Pulses as a raster
==================

One coil at a time, three levels of either polarity, at most 3 s, then 100 s of rest. ``run.pulses`` has a row
for each pulse that the coil board reports.
"""

import matplotlib.pyplot as plt

import torquer

run = torquer.fly("microsat", orbits=2, seed=2)

figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
for polarity, colour in ((1, "tab:blue"), (-1, "tab:red")):
    pulses = run.pulses[run.pulses.level * polarity > 0]
    axes.vlines(
        pulses.start_s / 60.0,
        pulses.coil,
        pulses.coil + 0.15 * pulses.level,
        colour,
        label="positive" if polarity > 0 else "negative",
    )
axes.set(xlabel="time, min", yticks=[0, 1, 2], yticklabels=["coil 0", "coil 1", "coil 2"])
figure.legend(ncols=2, loc="outside upper right")

# %%
# How long each coil was driven, by level:

print(run.pulses.groupby(["coil", "level"]).length_s.sum().unstack(fill_value=0.0).round(1))

# sphinx_gallery_thumbnail_path = '_static/gallery/plot_2_pulses.png'
