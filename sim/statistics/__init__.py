"""Statistics of many runs: bounds of percentiles and proportions, performance indices, sensitivity."""
