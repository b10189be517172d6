"""What coils a satellite needs, and what pointing to expect: from inertia, orbit, disturbances and pulses."""
