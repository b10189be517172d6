"""Laws that predict what each choice will lead to."""
