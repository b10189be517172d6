"""Claims that flights of a rigid body in the direct dipole show."""
