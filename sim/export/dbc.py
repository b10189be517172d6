"""The DBC for other tools, its cycle times at any tick rate."""

import re

from sim.export.dictionary import DBC

_CYCLE = re.compile(r'(?m)^(BA_ "GenMsgCycleTime" BO_ \d+ )1000;$')
"""The cycle time of a message that is sent every tick; the others are in seconds, whatever the tick rate."""


def dbc_text(tick_hz: int) -> str:
    """The DBC, messages of every tick being ``tick_hz`` times a second."""
    text = DBC.read_text(encoding="utf-8")
    return _CYCLE.sub(rf"\g<1>{round(1000 / tick_hz)};", text)
