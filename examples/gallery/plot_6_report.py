"""
The report page
===============

Every flight ends with a page that stands by itself, ``run.report``: zoom into a chart, play the attitude.
"""

from dataclasses import dataclass
from html import escape

import torquer

run = torquer.fly("microsat", orbits=1, seed=2)


# %%
# Here it is in a frame, as notebooks show it too:


@dataclass(frozen=True)
class Frame:
    """A page within another."""

    page: str

    def _repr_html_(self):
        page = escape(self.page)
        return f'<iframe title="report" width="100%" height="800" srcdoc="{page}"></iframe>'


Frame(run.report.read_text(encoding="utf-8"))

# sphinx_gallery_thumbnail_path = 'flight.svg'
