"""tools/generate_state_bytes.py: every field of the state is written; what it cannot write it names."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from shutil import copy, copytree, ignore_patterns
from typing import final

import pytest
from generate_state_bytes import Writers

ROOT = Path(__file__).resolve().parents[2]


def check(root):
    return subprocess.run(
        [sys.executable, str(root / "tools" / "generate_state_bytes.py"), "--check"],
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.long
def test_what_is_committed_is_not_stale():
    shown = check(ROOT)
    assert shown.returncode == 0, shown.stdout + shown.stderr


@pytest.mark.long
def test_a_new_field_is_noticed(tmp_path):
    copytree(ROOT / "fsw", tmp_path / "fsw", ignore=ignore_patterns("_compiled", "__pycache__"))
    (tmp_path / "tools").mkdir()
    copy(ROOT / "tools" / "generate_state_bytes.py", tmp_path / "tools")
    copy(ROOT / "pyproject.toml", tmp_path)
    assert check(tmp_path).returncode == 0
    modes = tmp_path / "fsw" / "core" / "modes.py"
    modes.write_text(
        modes.read_text().replace("    trips: int = 0\n", "    trips: int = 0\n    falls: int = 0\n")
    )
    shown = check(tmp_path)
    assert shown.returncode == 1
    assert "stale" in shown.stdout


@final
@dataclass
class Inner:
    number: float


@dataclass
class Open:
    number: float


def written(**types):
    """The lines for a class with these fields, and the functions they call."""
    kind = final(dataclass(type("Whole", (), {"__annotations__": types})))
    writers = Writers()
    writers.of(kind, "")
    return {name: text.splitlines()[1:] for name, (_, text) in writers.functions.items()}


def test_fields_are_written_in_their_order():
    whole = written(second=float, first=int, truth=bool)["_write_whole"]
    assert whole == [
        "    write_f64_le(out, value.second)",
        "    write_i64_le(out, value.first)",
        "    write_i64_le(out, value.truth)",
    ]


def test_what_may_be_none_is_preceded_by_whether_it_is():
    assert written(inner=Inner | None) == {
        "_write_whole": [
            "    inner = value.inner",
            "    out.append(inner is not None)",
            "    if inner is not None:",
            "        _write_inner(out, inner)",
        ],
        "_write_inner": ["    write_f64_le(out, value.number)"],
    }


@pytest.mark.parametrize("kind", [list[Inner], tuple[Inner, ...]])
def test_what_has_any_number_of_items_is_preceded_by_their_number(kind):
    whole, items, _ = written(items=kind).values()
    assert whole[0].endswith("(out, value.items)")
    assert items == [
        "    write_i64_le(out, len(value))",
        "    for item in value:",
        "        _write_inner(out, item)",
    ]


def test_one_function_serves_all_of_a_type():
    assert len(written(one=tuple[float, float], other=tuple[float, float])) == 2


@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        (object, "is no final class"),
        (dict[str, int], "is no final class"),
        (Open, "is no final class"),  # a subclass may have more fields
        (int | str, "is no final class"),
        (int | str | None, "one of several types"),
        (tuple[tuple[int, float, int], tuple[int, int, float]], "has the name of"),
    ],
)
def test_what_cannot_be_written_is_named_by_its_field(kind, reason):
    with pytest.raises(TypeError, match=rf"^Whole.field: .*{reason}"):
        written(field=kind)
