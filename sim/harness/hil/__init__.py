"""Hardware in the loop: the flight software in real time against boards, and the conformance of a board."""
