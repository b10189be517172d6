"""Each coil: by its current, and by what its pulses did to the rate."""
