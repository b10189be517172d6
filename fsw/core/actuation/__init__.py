"""From the demand of a law to the request to the coil driver."""
