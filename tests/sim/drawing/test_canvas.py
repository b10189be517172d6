"""The look of charts, which is that of the whole process while they are drawn."""

from threading import Event, Thread

import matplotlib
import pytest
from matplotlib.figure import Figure

from sim.drawing.canvas import style
from sim.drawing.inline_svg import svg


class Drawing(Thread):
    """Draws, and goes on doing so until it is told to end."""

    def __init__(self, by_style):
        super().__init__()
        self.begun, self.end, self._by_style = Event(), Event(), by_style
        self.start()
        self.begun.wait(0.2)  # in vain where another one draws

    def run(self):
        if self._by_style:
            with style():
                self.hold()
        else:
            svg(Held((1, 1), drawing=self), "salt")

    def hold(self):
        self.begun.set()
        self.end.wait(20.0)


class Held(Figure):
    """A figure that takes its time."""

    def __init__(self, size, drawing):
        super().__init__(size)
        self.drawing = drawing

    def savefig(self, *args, **kwargs):
        self.drawing.hold()
        super().savefig(*args, **kwargs)


@pytest.mark.long
@pytest.mark.parametrize("second", [True, False], ids=["style", "svg"])
@pytest.mark.parametrize("first", [True, False], ids=["style", "svg"])
def test_two_threads_that_draw_leave_the_settings_of_the_caller(first, second):
    before = dict(matplotlib.rcParams)
    drawings = [Drawing(first), Drawing(second)]
    for drawing in drawings:
        drawing.end.set()
        drawing.join()
    assert dict(matplotlib.rcParams) == before


def test_a_picture_is_made_within_the_look():
    with style():
        assert svg(Figure((1, 1)), "salt").startswith("<svg")
