"""H2 and H-infinity: norms of a periodic loop, gains of the PD law, another way to the Riccati equation."""
