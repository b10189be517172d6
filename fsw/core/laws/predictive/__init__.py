"""Laws that look at what each choice will lead to."""
