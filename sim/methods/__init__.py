"""The methods of the source papers: where each is, what is claimed for it, and by what that is measured."""
