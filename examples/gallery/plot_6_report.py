"""
The report page
===============

Every flight ends with a page that stands by itself, ``run.report``: zoom into a chart, play the attitude.
Here it is in a frame.
"""

from dataclasses import dataclass
from html import escape
from pathlib import Path

import torquer


@dataclass(frozen=True)
class Frame:
    """A page as notebooks and this gallery show it."""

    page: Path

    def _repr_html_(self):
        content = escape(self.page.read_text(encoding="utf-8"))
        return f'<iframe srcdoc="{content}" title="report" style="width: 100%; height: 50em"></iframe>'


run = torquer.fly("microsat", orbits=1, seed=2)
Frame(run.report)
