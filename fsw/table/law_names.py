"""The laws by what they are for, as a message lists them: some of each kind, and how many more there are."""

from collections.abc import Mapping

from fsw.core.laws.entry import Aim

FEW = 5
"""Named of a kind."""


def laws_by_aim(aims: Mapping[str, Aim]) -> str:
    """``three_axis (pd, lqr and 35 more), rate (...)``, of laws with their aims, in their order."""
    kinds = []
    for aim in Aim:
        names = [name for name, its in aims.items() if its is aim]
        more = f" and {len(names) - FEW} more" if len(names) > FEW else ""
        if names:
            kinds.append(f"{aim.value} ({', '.join(names[:FEW])}{more})")
    return ", ".join(kinds)
