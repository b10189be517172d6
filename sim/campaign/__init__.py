"""Studies made of many flights, side by side on the machine's cores."""
