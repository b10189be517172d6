"""A digest that distinguishes the code of one flight from that of another, by the text of its files."""

import ast
import hashlib
import io
import tokenize
from functools import cache
from pathlib import Path

import sim
from sim.errors import HarnessError

PROJECT = Path(sim.__file__).resolve().parents[1]
FLIGHT_CODE = (
    "fsw",
    "hil_stub",
    "sim/audit",
    "sim/campaign",
    "sim/design/from_scenario.py",
    "sim/design/theory",
    "sim/faults",
    "sim/flight",
    "sim/plant",
    "sim/record",
    "sim/replay",
    "sim/report",
    "sim/scenario",
    "sim/statistics",
    "sim/value_types.py",
)
"""Folders and files that a flight and its figures depend on."""
NOT_FLOWN = (
    "sim/campaign/code_digest.py",
    "sim/campaign/command.py",
    "sim/campaign/executors",
    "sim/campaign/report",
    "sim/campaign/results",
    "sim/fault_table/command.py",
    "sim/fault_table/earlier_rows.py",
    "sim/fault_table/render.py",
    "sim/plant/__main__.py",
    "sim/scenario/keys",
)
"""Within those, what no flight imports: what orders flights, stores their results and shows them."""
WORDS = (
    "sim/report/requirements/causes.py",
    "sim/report/requirements/sizing.py",
)
"""Within those, why a requirement is missed, in words: a flight imports it, and no figure follows from it."""
DATA = (".toml", ".dbc")


@cache
def code_digest(parts: tuple[str, ...] = FLIGHT_CODE, project: Path = PROJECT) -> str:
    """A digest that is the same for the same programs and data, whatever their comments and docstrings.

    Args:
        parts: folders and files; by default all that flights depend on.
        project: where they are.

    Raises:
        HarnessError: one of them is not there, so that its changes would go unnoticed.
    """
    digest = hashlib.sha256()
    for part in (project / part for part in parts):
        whole = [part] if part.is_file() else sorted(part.rglob("*"))
        files = [path for path in whole if path.suffix in (".py", *DATA)]
        if not files:
            raise HarnessError(f"{part}: holds no code to tell from other code")
        for path in files:
            name = path.relative_to(project)
            if not any(name.is_relative_to(left_out) for left_out in (*NOT_FLOWN, *WORDS)):
                content = (
                    path.read_bytes() if path.suffix in DATA else program(path.read_text(encoding="utf-8"))
                )
                digest.update(name.as_posix().encode() + content)
    return digest.hexdigest()[:16]


def program(source: str) -> bytes:
    """The lines of a module without comments and without statements that are only a string."""
    lines: list[str | None] = list(source.splitlines())
    for node in ast.walk(ast.parse(source)):
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            end = node.end_lineno or node.lineno
            lines[node.lineno - 1 : end] = [None] * (end + 1 - node.lineno)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        row, column = token.start
        line = lines[row - 1] if token.type == tokenize.COMMENT else None
        if line is not None:
            lines[row - 1] = line[:column].rstrip() or None
    return "\n".join(line for line in lines if line is not None).encode()
