"""The charts of a flight as figures for papers: without titles, of a column's width, in vector graphics."""
