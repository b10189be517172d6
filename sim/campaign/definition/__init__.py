"""What a campaign is: its file, the distributions in it, and what they give for each run."""
