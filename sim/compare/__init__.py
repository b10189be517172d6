"""``torquer compare``: control laws side by side on the same body, seed and sensors."""
