"""The sensor boards, and what their sensors are shown on a bench."""
