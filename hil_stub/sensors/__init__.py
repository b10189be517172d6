"""The sensor boards, and the stimulus of their sensors on a bench."""
