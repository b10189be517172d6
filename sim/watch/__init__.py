"""The live view: what the frames of a bus, or of a log, show as they come. It only listens."""
