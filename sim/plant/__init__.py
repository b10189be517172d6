"""Physics: orbit, field, Sun, rigid body, torques, sensors and coils."""
