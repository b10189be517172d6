"""
Figures for a paper
===================

``run.plot`` draws each figure a column wide, or on axes of one's own; grey bands are eclipses.
``torquer report RUN --figures pdf`` writes all of them.
"""

import matplotlib.pyplot as plt

import torquer

run = torquer.fly("microsat", orbits=2.5, seed=2)
run.plot.pointing()

# %%
# On axes of one's own:

figure, (above, middle, below) = plt.subplots(3, 1, figsize=(7, 7), sharex=True, layout="constrained")
run.plot.pointing(ax=above)
run.plot.estimate_errors(ax=middle)
run.plot.pulses(ax=below)

# sphinx_gallery_thumbnail_path = '_static/gallery/plot_7_paper.png'
