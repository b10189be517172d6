"""``torquer xtce``: the file, and the packages that it takes."""

import sys

import pytest
from click.testing import CliRunner

from sim.export.dictionary import messages
from sim.export.xtce import xtce_text
from torquer.cli.main import main


def call(*words):
    return CliRunner().invoke(main, ["xtce", *map(str, words)])


@pytest.mark.long
def test_it_writes_the_document(tmp_path):
    out = tmp_path / "bus.xml"
    done = call("--out", out)
    assert (done.exit_code, done.stdout) == (0, f"written: {out}\n")
    assert out.read_text(encoding="utf-8") == xtce_text()
    assert "already exists" in call("--out", out).stderr


@pytest.mark.parametrize("package", ["yamcs", "cantools"])
def test_a_package_that_is_missing_is_named_with_its_extra(tmp_path, monkeypatch, package):
    messages.cache_clear()
    monkeypatch.setitem(sys.modules, package, None)
    refused = call("--out", tmp_path / "bus.xml")
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
    assert "pip install 'torquer[" in refused.stderr
    assert list(tmp_path.iterdir()) == []
    messages.cache_clear()
