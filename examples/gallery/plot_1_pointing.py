"""
A flight and its pointing
=========================

The 50 kg satellite begins 40 deg from its nominal attitude, tumbling slowly, and turns itself upright
against the Earth's field.
"""

import matplotlib.pyplot as plt

import torquer

run = torquer.fly("microsat", orbits=2.5, seed=2)
truth = run.truth

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
axes.plot(truth.orbit, truth.pointing_deg, label="whole attitude")
axes.plot(truth.orbit, truth.axis1_deg, label="axis 1, from the vertical")
axes.set(xlabel="orbit", ylabel="pointing error, deg", yscale="log")
axes.legend()

# %%
# What ``torquer sil`` prints is what the run prints:

print(run)

# sphinx_gallery_thumbnail_path = '_static/gallery/plot_1_pointing.png'
