"""Copies of the reference files, cut short and spoiled where a test says so."""

import shutil

import pytest

from sim.validate.reference.reference_table import DATA


class Folder:
    """A folder with copies of some reference files."""

    def __init__(self, path):
        self.path = path

    def copy(self, name, rows=None, as_name=None):
        """A copy, cut to so many rows."""
        lines = (DATA / name).read_text().splitlines()
        first = next((i for i, line in enumerate(lines) if not line.startswith("#")), 0)
        kept = lines if rows is None else lines[: first + 1 + rows]
        target = self.path / (as_name or name)
        target.write_text("\n".join(kept) + "\n")
        return target

    def add(self, name, row, column, error):
        """Add to a number of a copy; gives the line of the file that now holds it."""
        return self.put(name, row, column, lambda text: repr(float(text) + error))

    def put(self, name, row, column, change):
        """Change a field of a copy; gives its line."""
        path = self.path / name
        lines = path.read_text().splitlines()
        head = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        fields = lines[head + 1 + row].split(",")
        place = lines[head].split(",").index(column)
        fields[place] = change(fields[place])
        lines[head + 1 + row] = ",".join(fields)
        path.write_text("\n".join(lines) + "\n")
        return head + 2 + row

    def edit(self, name, old, new):
        """Replace a text that is there once."""
        path = self.path / name
        text = path.read_text()
        assert text.count(old) == 1
        path.write_text(text.replace(old, new))


@pytest.fixture
def folder(tmp_path):
    return Folder(tmp_path)


@pytest.fixture
def whole_folder(folder):
    """Every reference file, cut to a few rows where rows cost time."""
    for path in sorted(DATA.iterdir()):
        if path.name.startswith("attitude"):
            folder.copy(path.name, rows=8)
        else:
            shutil.copyfile(path, folder.path / path.name)
    return folder
