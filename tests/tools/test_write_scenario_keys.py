"""tools/write_scenario_keys.py: the committed page and schema are as the code says; stale ones are named."""

import write_scenario_keys as tool


def test_what_is_committed_is_not_stale(monkeypatch):
    monkeypatch.setattr("sys.argv", ["write_scenario_keys.py", "--check"])
    assert tool.main() == 0


def test_a_stale_page_is_named_and_written_again(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(tool, "DOCS", tmp_path)
    (tmp_path / "scenario-keys.md").write_text("# Scenario keys\n")
    monkeypatch.setattr("sys.argv", ["write_scenario_keys.py", "--check"])
    assert tool.main() == 1
    assert f"{tmp_path / 'scenario-keys.md'} is stale" in capsys.readouterr().out
    monkeypatch.setattr("sys.argv", ["write_scenario_keys.py"])
    assert tool.main() == 0
    assert {path.name for path in tmp_path.iterdir()} == {"scenario-keys.md", "scenario.schema.json"}
    assert (tmp_path / "scenario-keys.md").read_text() == tool.page()
