"""The fault engine: faults as data, injected by a seeded man in the middle, judged by independent audit."""
