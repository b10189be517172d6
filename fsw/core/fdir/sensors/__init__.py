"""Each sensor and both together: by checks, and by what the filter takes and refuses."""
