"""Claims: gravity gradient, Sun, drag and other help (sections 2.3, 2.4)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
