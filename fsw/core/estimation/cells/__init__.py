"""Sun cells: what each should show, and their samples as the filter takes them, one at a time."""
