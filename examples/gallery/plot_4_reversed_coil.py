"""
A reversed coil, found and named
================================

Half an orbit into the flight coil 1, of 0 to 2, is connected the wrong way round. The flight software
sees that its pulses turn the satellite the other way, isolates it and flies on with two coils.
"""

import matplotlib.pyplot as plt

import torquer

reversed_coil = {"kind": "coil_wired", "at_s": 3000.0, "parameters": {"axis": 1.0, "scale": -1.0}}
sound = torquer.fly("microsat", orbits=2, seed=2)
broken = torquer.fly("microsat", orbits=2, seed=2, set={"fault": [reversed_coil]})

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
for name, run in (("all coils sound", sound), ("coil 1 reversed", broken)):
    axes.plot(run.truth.orbit, run.truth.pointing_deg, label=name)
reversed_orbit = float(sound.truth.orbit.sel(time=3000.0))
axes.axvline(reversed_orbit, color="grey", linestyle=":", label="reversed")
axes.set(xlabel="orbit", ylabel="pointing error, deg", yscale="log")
axes.legend()

# %%
# The summary names the unit, and the last pulse of that coil is a test of it at most:

print(broken)
print(broken.pulses[broken.pulses.coil == 1].tail(1))

# sphinx_gallery_thumbnail_path = '_static/gallery/plot_4_reversed_coil.png'
