"""The ground side of Torquer: the plant, and all that flies, judges and shows a flight."""

import fsw  # noqa: F401  (with it comes what serves compiled modules)
