"""
The estimate against the truth
==============================

The filter knows attitude and rate from a magnetometer, and from a Sun sensor while there is a Sun. Its error,
which only a simulation knows, stays inside the 3 sigma that it states.
"""

import matplotlib.pyplot as plt
import numpy as np

import torquer

run = torquer.fly("microsat", orbits=1.5, seed=2)
estimate, truth = run.estimate, run.truth
sigma_rad = np.sqrt((estimate.attitude_sigma_body_rad**2).sum("body"))

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
axes.fill_between(
    estimate.orbit, 3.0 * np.degrees(sigma_rad), alpha=0.25, label="3 sigma, as the filter states"
)
axes.plot(estimate.orbit, estimate.attitude_error_deg, linewidth=0.8, label="error")
axes.fill_between(
    truth.orbit,
    1.0,
    where=truth.lit < 0.5,
    transform=axes.get_xaxis_transform(),
    color="grey",
    alpha=0.15,
    label="in the Earth's shadow",
)
axes.set(xlabel="orbit", ylabel="attitude, deg", ylim=(0.0, 1.5))
axes.legend()

# sphinx_gallery_thumbnail_path = '_static/gallery/plot_3_estimate.png'
