"""``torquer header`` and ``torquer vectors``: the files, and what they are not written over."""

import pytest
from click.testing import CliRunner

from torquer.cli.main import main


def call(*words):
    return CliRunner().invoke(main, [*map(str, words)])


def test_header_writes_its_files_and_replaces_them_by_force_alone(tmp_path):
    out = tmp_path / "include"
    done = call("header", "microsat", "--out", out, "--set", "coils.backoff_s=50")
    names = "torquer.h, torquer.c, torquer_crc.h, torquer_scenario.h, coil_limits.h"
    assert (done.exit_code, done.stdout) == (0, f"written: {names} in {out}\n")
    assert "#define TORQUER_BACKOFF_MS 50000u " in (out / "torquer_scenario.h").read_text()
    refused = call("header", "microsat", "--out", out)
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
    assert "50000u" in (out / "torquer_scenario.h").read_text()
    assert call("header", "microsat", "--out", out, "--force").exit_code == 0
    assert "100000u" in (out / "torquer_scenario.h").read_text()


@pytest.mark.parametrize(
    "words", [("header", "no-such-satellite", "--out", "c"), ("vectors", "no-such-run", "--out", "v.jsonl")]
)
def test_bad_input_is_one_sentence(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    done = call(*words)
    assert (done.exit_code, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert not list(tmp_path.iterdir())
