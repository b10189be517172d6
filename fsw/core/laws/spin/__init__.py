"""Laws that build up a spin, and turn its axis."""
