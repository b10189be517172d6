"""From what a law asks for to what the coil driver is asked."""
