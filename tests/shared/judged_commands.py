"""Commands in this process, judged by how they end: an answer or one sentence, soon, and no traceback."""

import contextlib
import io
import time
import warnings

from torquer.cli.main import main

LONGEST_S = 5.0
"""Of processor time: other work on the machine is not the command's."""


def torquer(*words):
    """``torquer`` with these words; see ``judged``."""
    return judged(lambda: main([str(word) for word in words], prog_name="torquer"))


def judged(command):
    """(exit code, stdout, stderr) of a command, once it is sure how it ended."""
    out, err, began = io.StringIO(), io.StringIO(), time.process_time()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            code = command()
        except SystemExit as ended:
            code = ended.code
    code, said = code or 0, err.getvalue()
    assert time.process_time() - began < LONGEST_S
    assert code in (0, 1, 2), said
    if code == 2:
        assert said.count("\n") == 1, said
        assert len(said) < 1100, said
    return code, out.getvalue(), said
