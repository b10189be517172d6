"""Claims of Tavares et al. (ConSat): PoSAT-1's predictive law in flight, and the ways to its dipole."""
