"""tools/write_pages.py: the committed pages are as the code says; a stale one is named and written again."""

import pytest
import write_pages as tool


@pytest.mark.long
def test_what_is_committed_is_not_stale(monkeypatch):
    monkeypatch.setattr("sys.argv", ["write_pages.py", "--check"])
    assert tool.run() == 0


def test_a_stale_page_is_named_and_written_again(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(tool, "PAGES", {"a.md": lambda: "A\n", "b.md": lambda: "B\n"})
    monkeypatch.setattr(tool, "DOCS", tmp_path)
    (tmp_path / "a.md").write_text("A\n")
    (tmp_path / "b.md").write_text("# old\n")
    monkeypatch.setattr("sys.argv", ["write_pages.py", "--check"])
    assert tool.run() == 1
    assert capsys.readouterr().out == f"{tmp_path / 'b.md'} is stale: run tools/write_pages.py\n"
    monkeypatch.setattr("sys.argv", ["write_pages.py"])
    assert tool.run() == 0
    assert (tmp_path / "b.md").read_text() == "B\n"
