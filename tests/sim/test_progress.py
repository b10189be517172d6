"""What is shown on stderr while something runs."""

import sys
from io import StringIO
from threading import Thread
from types import SimpleNamespace

import pytest

from sim import progress as module
from sim.progress import note, progress, shown


class Terminal(StringIO):
    def isatty(self):
        return True


def written(monkeypatch, stream, show=True):
    monkeypatch.setattr(sys, "stderr", stream)
    with shown(show):
        note("a note")
        with progress("flying", 4) as watch:
            for done in range(5):
                watch(done)
    return stream.getvalue()


def test_notes_are_written_everywhere_and_a_bar_on_a_terminal(monkeypatch):
    assert written(monkeypatch, StringIO()) == "a note\n"
    assert "flying" in written(monkeypatch, Terminal())


def test_a_log_has_a_line_now_and_then_of_a_long_run_and_none_of_a_short_one(monkeypatch):
    assert written(monkeypatch, StringIO()) == "a note\n"
    monkeypatch.setattr(module, "NOTE_EVERY_S", 0.0)
    shares = [f"flying: {share:3d} %\n" for share in (0, 25, 50, 75, 100)]
    assert written(monkeypatch, StringIO()) == "a note\n" + "".join(shares)


def test_the_lines_of_a_log_are_a_minute_apart(monkeypatch):
    now_s = iter([0.0, 59.0, 61.0, 61.0, 120.0, 122.0, 122.0])
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: next(now_s)))
    stream = StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with progress("flying", 4) as watch:
        for done in range(1, 5):
            watch(done)
    assert stream.getvalue() == "flying:  50 %\nflying: 100 %\n"


def test_a_reader_of_the_log_who_has_gone_does_not_end_the_run(monkeypatch):
    def gone(text):
        raise BrokenPipeError

    monkeypatch.setattr(module, "NOTE_EVERY_S", 0.0)
    stream = StringIO()
    stream.write = gone
    monkeypatch.setattr(sys, "stderr", stream)
    with progress("flying", 4) as watch:
        watch(4)
    with pytest.raises(BrokenPipeError):
        note("a warning, which the user must not miss")


def test_a_log_is_left_to_a_caller_who_writes_it(monkeypatch):
    monkeypatch.setattr(module, "NOTE_EVERY_S", 0.0)
    stream = StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with progress("flying", 4, in_log=False) as watch:
        watch(4)
    assert stream.getvalue() == ""


@pytest.mark.parametrize("running", [True, False], ids=["a kernel", "a program that has loaded one"])
def test_a_notebook_has_a_line_that_is_written_over(monkeypatch, running):
    kernel = SimpleNamespace(IPKernelApp=SimpleNamespace(initialized=lambda: running))
    monkeypatch.setitem(sys.modules, "ipykernel.kernelapp", kernel)
    monkeypatch.setattr(module, "LINE_EVERY_S", 0.0)
    text = written(monkeypatch, StringIO())
    assert ("\rflying:  50 %" in text) is running
    assert text.endswith("\rflying: done \n") is running


def test_a_note_takes_the_place_of_the_line_of_a_notebook_whole(monkeypatch):
    kernel = SimpleNamespace(IPKernelApp=SimpleNamespace(initialized=lambda: True))
    monkeypatch.setitem(sys.modules, "ipykernel.kernelapp", kernel)
    monkeypatch.setattr(module, "LINE_EVERY_S", 0.0)
    stream = StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with progress("flying", 4) as watch:
        watch(1)
        note("done")
        note("once more")
        watch(2)
    note("after")
    assert stream.getvalue() == (
        "\rflying:  25 %\rdone         \nonce more\n\rflying:  50 %\rflying: done \nafter\n"
    )


@pytest.mark.parametrize("stream", [StringIO, Terminal])
def test_nothing_is_written_where_it_is_hidden(monkeypatch, stream):
    assert written(monkeypatch, stream(), show=False) == ""


def test_what_one_thread_hides_another_still_shows(monkeypatch):
    stream = StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with shown(False):
        other = Thread(target=note, args=("of another thread",))
        other.start()
        other.join()
        note("hidden")
    assert stream.getvalue() == "of another thread\n"
