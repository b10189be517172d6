"""Claims on real flight data: passes that SUCHAI-3 recorded, with a calibration by one of them."""
