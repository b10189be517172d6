"""What a run leaves: a row of SQLite, from which everything else is made."""
