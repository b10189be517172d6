"""Claims: prediction, adaptation and the papers of PoSAT-1 (sections 3.3, 3.4)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
