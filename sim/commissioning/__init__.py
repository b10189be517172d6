"""A satellite made ready: its wiring found, its sensors calibrated, the filter flown on recorded samples."""
