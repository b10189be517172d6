"""Claims: three axes, optimal control of a linear model (section 3.2)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
