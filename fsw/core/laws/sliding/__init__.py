"""Laws that hold the motion to a sliding surface."""
