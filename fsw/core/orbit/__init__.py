"""Where the satellite is, and what field and Sun it meets there."""
