"""The look of charts: sizes, colours, axes, SVG."""
