"""The pages: files, links and commands that they name exist."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from fsw.core.laws.table import LAWS
from torquer.cli.main import COMMANDS

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
TREES = ("fsw/", "hil_stub/", "sim/", "torquer/", "tests/", "tools/", "docs/", "examples/")


def each(pattern):
    """Page and match, for every match on a page; NAME stands for one to be chosen."""
    return [
        pytest.param(page, found, id=f"{page.name}:{found}")
        for page in PAGES
        for found in sorted(set(re.findall(pattern, page.read_text(encoding="utf-8"))))
        if "NAME" not in found
    ]


@pytest.mark.parametrize(("page", "path"), each(rf"`((?:{'|'.join(TREES)})[\w./-]*)"))
def test_a_file_that_a_page_names_exists(page, path):
    assert (ROOT / path).exists()


@pytest.mark.parametrize(("page", "target"), each(r"\]\(([^)#:]+)(?:#[^)]*)?\)"))
def test_a_link_leads_to_a_file(page, target):
    assert (page.parent / target).exists()


@pytest.mark.parametrize(("page", "command"), each(r"(?m)(?:^|[`$] ?|&& )torquer ([a-z]+)\b"))
def test_a_command_that_a_page_names_exists(page, command):
    assert command in COMMANDS


@pytest.mark.parametrize(("page", "target"), each(r"`make ([a-z-]+)"))
def test_a_make_target_that_a_page_names_exists(page, target):
    assert re.search(
        rf"(?m)^(?:[a-z-]+ )*{target}(?: [a-z-]+)*:", (ROOT / "Makefile").read_text(encoding="utf-8")
    )


SOURCES = "\n".join(
    path.read_text(encoding="utf-8")
    for package in ("fsw", "hil_stub", "sim", "torquer")
    for path in sorted((ROOT / package).rglob("*"))
    if path.suffix in (".py", ".toml", ".dbc")
)


@pytest.mark.parametrize(
    "name",
    sorted(set(re.findall(r"`([A-Za-z]\w+)`", (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")))),
)
def test_a_name_that_the_glossary_gives_is_in_the_code(name):
    assert re.search(rf"\b{name}\b", SOURCES)


LAWS_PAGE = (ROOT / "docs" / "laws.md").read_text(encoding="utf-8")
FIGURES = re.split(r"\n- ", LAWS_PAGE.partition("Each figure below")[2])[1:]


def test_the_page_of_laws_has_its_figures_at_its_end_alone():
    assert len(FIGURES) > 10
    before = LAWS_PAGE.partition("Each figure below")[0]
    assert not re.findall(r"\d deg RMS|\d %", before)


@pytest.mark.parametrize("law", LAWS)
def test_the_page_of_laws_has_every_law_with_its_number(law):
    assert LAWS_PAGE.count(f"\n| `{law}` | {LAWS[law].number} |") == 1


@pytest.mark.parametrize("figures", FIGURES, ids=lambda text: text.partition("`")[2].partition("`")[0])
def test_figures_of_a_law_name_the_test_or_the_command_that_gives_them(figures):
    tests = re.findall(r"`((?:\w+/)*test_\w+\.py)`", figures)
    assert tests or re.search(r"`(torquer|make) ", figures)
    assert all(list((ROOT / "tests" / "fsw" / "core" / "laws").rglob(name)) for name in tests)


MOST_FOUND = 5
"""Modules among which a newcomer finds the one that is meant."""


@cache
def first_sentences():
    """The first paragraph of each module's docstring, in lower case."""
    files = [file for tree in ("fsw", "hil_stub", "sim") for file in (ROOT / tree).rglob("*.py")]
    texts = {file: ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "" for file in files}
    return {
        file.relative_to(ROOT).as_posix(): " ".join(text.split("\n\n")[0].split()).lower()
        for file, text in texts.items()
    }


ANSWERS = re.findall(r"(?m)^\| [^|]+\? \| ([^|]+) \| (`.*`) \|$", (ROOT / "docs" / "design.md").read_text())


@pytest.mark.parametrize(("word", "answers"), ANSWERS)
def test_a_plain_word_leads_to_the_module_that_answers(word, answers):
    found = [file for file, sentence in first_sentences().items() if word.lower() in sentence]
    assert set(re.findall("`([^`]+)`", answers)) <= set(found)
    assert len(found) <= MOST_FOUND


def test_there_are_questions():
    assert len(ANSWERS) >= 10
