"""The flight filter over recorded telemetry, judged by what it did not use."""
