"""Claims on the methods of the review, a module for each of its sections."""
