"""The structure: folders that say what they are for, tests that mirror them, a flight loop of one screen."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("fsw", "hil_stub", "sim", "torquer")


def relative(path):
    return path.relative_to(ROOT).as_posix()


MODULES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
FOLDERS = sorted({path.parent for path in MODULES})


@pytest.mark.parametrize("folder", FOLDERS, ids=relative)
def test_every_folder_says_what_it_is_for(folder):
    assert ast.get_docstring(ast.parse((folder / "__init__.py").read_text()))


SCRIPTS = [*MODULES, *sorted((ROOT / "tools").glob("*.py")), *sorted((ROOT / "benchmarks").glob("*.py"))]


@pytest.mark.parametrize("path", SCRIPTS, ids=relative)
def test_a_script_runs_its_main_after_all_that_it_defines(path):
    statements = ast.parse(path.read_text()).body
    main = [at for at, statement in enumerate(statements) if "sys.exit(main(" in ast.unparse(statement)]
    main = [at for at in main if isinstance(statements[at], ast.If)]
    assert main in ([], [len(statements) - 1])


# --- tests mirror the packages

TEST_FOLDERS = sorted(
    {path.parent for package in PACKAGES for path in (ROOT / "tests" / package).rglob("test_*.py")}
)


def mirrored(path):
    """The path in a package whose tests are at ``path``."""
    return ROOT / path.relative_to(ROOT / "tests")


@pytest.mark.parametrize("folder", TEST_FOLDERS, ids=relative)
def test_every_folder_of_tests_is_a_package(folder):
    assert (mirrored(folder) / "__init__.py").exists()


@pytest.mark.parametrize(
    "path", [path for folder in TEST_FOLDERS for path in sorted(folder.glob("test_*.py"))], ids=relative
)
def test_every_test_is_of_a_module_or_says_what_it_specifies(path):
    name = path.stem.removeprefix("test_")
    modules = (mirrored(path.parent) / f"{stem}.py" for stem in (name, f"__{name}__"))
    assert any(module.exists() for module in modules) or ast.get_docstring(ast.parse(path.read_text()))


@pytest.mark.parametrize("mark", ["long", "paced", "alone", "interpreted"])
def test_a_mark_that_is_looked_for_stands_in_the_file_of_its_tests(mark):
    """Of a file without it ``pytest -m MARK`` imports nothing."""
    files = set((ROOT / "tests").rglob("*.py")) - {ROOT / "tests" / "conftest.py"}
    files.discard(ROOT / "tests" / "shared" / "compiled_guard.py")
    marking = [relative(path) for path in files if f"mark.{mark}" in path.read_text(encoding="utf-8")]
    assert [path for path in marking if not Path(path).name.startswith("test_")] == []


# --- the flight loop is one screen at one level

STEP = ROOT / "fsw" / "core" / "step.py"
MOST_LINES_OF_A_STAGE, MOST_ARGUMENTS = 40, 6
METHODS_OF_VALUES = {"_replace", "copy"}
"""What ``step`` may call on a value: it makes another of the same type."""


def top_level(path):
    """Functions, classes and what is imported at the top of a module, by name."""
    found = {}
    for statement in ast.parse(path.read_text()).body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            found[statement.name] = statement
        elif isinstance(statement, ast.ImportFrom):
            for name in statement.names:
                found[name.asname or name.name] = (statement.module, name.name)
    return found


def module_path(dotted):
    path = ROOT.joinpath(*dotted.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def resolved(called, path):
    """The definition that an expression names in a module, through its imports; None: a method of a value."""
    if isinstance(called, ast.Name):
        found = top_level(path).get(called.id)
        while isinstance(found, tuple):
            module, name = found
            found = top_level(module_path(module)).get(name)
        return found
    if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
        imported = top_level(path).get(called.value.id)
        if isinstance(imported, tuple):
            return top_level(module_path(".".join(imported))).get(called.attr)
    return None


def stages():
    """``step`` and every function that it calls itself; to make a value is no stage."""
    step = top_level(STEP)["step"]
    found = {"step": step}
    for call in (node for node in ast.walk(step) if isinstance(node, ast.Call)):
        definition = resolved(call.func, STEP)
        if definition is None:
            assert isinstance(call.func, ast.Attribute), f"{ast.unparse(call.func)} cannot be resolved"
            assert call.func.attr in METHODS_OF_VALUES, f"{ast.unparse(call.func)} cannot be resolved"
        elif not isinstance(definition, ast.ClassDef):
            found[ast.unparse(call.func)] = definition
    return found


def test_the_stages_of_a_step_are_found():
    own = {
        "_skip_ticks",
        "_gate",
        "_predict",
        "_update",
        "_judge",
        "_law_input",
        "_schedule",
        "telemetry.report",
    }
    assert own | {"begin_count", "supervise", "command", "by_mode.demand"} < set(stages())


@pytest.mark.parametrize("name", stages())
def test_every_stage_of_a_step_fits_a_screen(name):
    stage = stages()[name]
    assert isinstance(stage, ast.FunctionDef)
    lines, arguments = stage.end_lineno - stage.lineno + 1, stage.args
    counted = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    assert lines < MOST_LINES_OF_A_STAGE
    assert len(counted) + bool(arguments.vararg) + bool(arguments.kwarg) <= MOST_ARGUMENTS


@pytest.mark.long
def test_no_class_name_stands_for_two_things():
    classes = [
        (node.name, f"{relative(path)}:{node.lineno}")
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ClassDef)
    ]
    # what a user law gives has the names of what the core makes of it
    classes = [(name, place) for name, place in classes if not place.startswith("fsw/own_law.py:")]
    places = {name: [place for other, place in classes if other == name] for name, _ in classes}
    assert {name: where for name, where in places.items() if len(where) > 1} == {}
