"""The board of a reaction wheel, which guards its motor by itself."""
