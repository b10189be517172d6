"""Control laws: what each sees and asks for, the table of them, and the laws chapter by chapter."""
