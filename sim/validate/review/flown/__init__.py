"""Claims that flights of the laws show: of satellites that have flown them, and of the rest of a section."""
