"""
The estimate against the truth
==============================

The filter knows attitude and rate from a magnetometer, and a Sun sensor while there is a Sun. Its error,
which only a simulation knows, stays inside the 3 sigma that it states.
"""

import matplotlib.pyplot as plt

import torquer

run = torquer.fly("microsat", orbits=1.5, seed=2)
estimate, truth = run.estimate, run.truth
three_sigma_deg = 3.0 * estimate.attitude_sigma_deg

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
axes.fill_between(estimate.orbit, 0.0, three_sigma_deg, alpha=0.25, label="3 sigma, as the filter states it")
axes.plot(estimate.orbit, estimate.attitude_error_deg, linewidth=0.8, label="error")
axes.fill_between(
    truth.orbit,
    0.0,
    1.0,
    where=~truth.sunlit.astype(bool),
    transform=axes.get_xaxis_transform(),
    color="grey",
    alpha=0.15,
    label="in the Earth's shadow",
)
axes.set(xlabel="orbit", ylabel="attitude, deg", ylim=(0.0, 3.0))
axes.legend()
