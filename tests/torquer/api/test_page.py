"""The examples of docs/api.md run, on flights that are shorter."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import torquer

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "api.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
NAMES = set(re.findall(r"torquer\.(\w+)\(", PAGE))


@pytest.mark.long
@pytest.mark.parametrize("example", EXAMPLES, ids=range(len(EXAMPLES)))
@pytest.mark.slow
def test_it_runs_and_says_what_the_page_says(example, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plt, "show", lambda: None)
    exec(compile(example.replace("orbits=3", "orbits=0.02"), "docs/api.md", "exec"), {})
    plt.close("all")
    said = re.findall(r"print\(.*\)\n +# (.*)", example)
    assert capfd.readouterr().out.splitlines() == said


def test_it_names_every_function():
    functions = {name for name in torquer.__all__ if name.islower()}
    assert NAMES & set(torquer.__all__) == functions
