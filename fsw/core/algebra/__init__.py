"""3-vectors, 3x3 matrices and quaternions on plain floats."""
