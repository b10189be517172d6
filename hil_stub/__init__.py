"""Boards between bus and physics, which enforce their own limits; frames in, frames out."""

import fsw.wire  # noqa: F401  (with fsw comes what serves compiled modules)
