"""What the results of a campaign show: on the terminal, and on a page with pictures."""
