"""Who may import whom, and what must not be found in the pure layers, read from the syntax trees."""

import ast
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("fsw", "hil_stub", "sim", "torquer")

CALCULATION = {
    "bisect", "collections", "copy", "dataclasses", "enum", "functools", "librt.strings", "marshal", "math",
    "mypy_extensions", "operator", "re", "struct", "types", "typing", "zlib",
    "numpy", "filterpy.kalman", "sgp4.api", "sgp4.io",
}  # fmt: skip
FORBIDDEN_NAMES = {
    "__import__", "breakpoint", "compile", "delattr", "eval", "exec", "globals", "hash", "id", "input",
    "open", "print", "setattr", "vars",
}  # fmt: skip
WORLDLY_NUMPY = {
    f"numpy.{name}"
    for name in ("random", "load", "loadtxt", "genfromtxt", "fromfile", "memmap", "save", "savetxt", "savez")
}
CHANGING_METHODS = {
    "add", "append", "appendleft", "clear", "discard", "extend", "fill", "insert", "pop", "popitem",
    "popleft", "remove", "reverse", "setdefault", "sort", "update",
}  # fmt: skip


def modules(package):
    """Paths of a package's modules; ``__main__`` is a composition root and none of them."""
    paths = sorted((ROOT / package.replace(".", "/")).rglob("*.py"))
    return [path for path in paths if path.name != "__main__.py"]


def dotted(path):
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def impurities(source, allowed):
    """What a module must not hold that only calculates: a list of sentences, empty if it is pure."""
    tree = ast.parse(source)
    found = [f"imports {n}" for n in imported(tree) if not within(n, allowed) or within(n, WORLDLY_NUMPY)]
    shared = set(module_variables(tree))
    hashing = {id(name) for method in hash_methods(tree) for name in ast.walk(method)}
    for node in ast.walk(tree):
        match node:
            case ast.Name(id="hash") if id(node) in hashing:
                pass
            case ast.Name(id=name, ctx=ast.Load()) if name in FORBIDDEN_NAMES:
                found.append(f"uses {name}")
            case ast.Attribute(value=ast.Name(id="np" | "numpy"), attr=attr) if (
                f"numpy.{attr}" in WORLDLY_NUMPY
            ):
                found.append(f"uses numpy.{attr}")
            case ast.Global(names=names):
                found.append(f"writes global {', '.join(names)}")
            case ast.AsyncFunctionDef() | ast.Await():
                found.append("is asynchronous")
            case ast.FunctionDef() | ast.Lambda():
                found += [f"changes {name}" for name in changed(node) if name in shared]
    return found


def hash_methods(tree):
    return [one for one in ast.walk(tree) if isinstance(one, ast.FunctionDef) and one.name == "__hash__"]


def imported(tree):
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(level=level) if level:
                yield "." * level
            case ast.ImportFrom(module=module):
                yield from (f"{module}.{alias.name}" for alias in node.names)


def within(name, allowed):
    return any(name == good or name.startswith(f"{good}.") for good in allowed)


def module_variables(tree):
    """Names that live as long as the process: assigned, imported, or functions and classes."""
    for node in tree.body:
        match node:
            case ast.Assign(targets=targets):
                yield from (name.id for target in targets for name in ast.walk(target) if is_name(name))
            case (
                ast.AnnAssign(target=ast.Name(id=name)) | ast.FunctionDef(name=name) | ast.ClassDef(name=name)
            ):
                yield name
            case ast.Import(names=names) | ast.ImportFrom(names=names):
                yield from ((alias.asname or alias.name).partition(".")[0] for alias in names)


def is_name(node):
    return isinstance(node, ast.Name)


def changed(function):
    """Names not local to a function whose contents it changes: ``x[i] = ``, ``x.a = ``, ``x.append()``."""
    own = {argument.arg for argument in ast.walk(function.args) if isinstance(argument, ast.arg)}
    nodes = [*ast.walk(function)]
    own |= {n.id for n in nodes if is_name(n) and isinstance(n.ctx, ast.Store)}
    for node in nodes:
        match node:
            case ast.Subscript(ctx=ast.Store() | ast.Del()) | ast.Attribute(ctx=ast.Store() | ast.Del()):
                name = root(node)
            case ast.Call(func=ast.Attribute(attr=attr) as method) if attr in CHANGING_METHODS:
                name = root(method)
            case _:
                continue
        if name is not None and name not in own:
            yield name


def root(node):
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if is_name(node) else None


# --- the checker itself: what it must find, and what it must let pass


@pytest.mark.parametrize(
    "violation",
    [
        "import time",
        "import numpy.random",
        "from numpy import random",
        "from numpy.random import default_rng",
        "import numpy, os",
        "import collections_extra",
        "from random import gauss",
        "from datetime import datetime",
        "from . import neighbour",
        "from fsw.bus import interface",
        "from fsw import io",
        "import filterpy",
        "from scipy.optimize import root",
        "def f():\n    import socket",
        "try:\n    import can\nexcept ImportError:\n    can = None",
        "if True:\n    from threading import Lock",
        "def f():\n    print(1)",
        "say = print",
        "x = open('x').read()",
        "__import__('time')",
        "def f(x):\n    return hash(x)",
        "import numpy as np\ndef f():\n    return np.random.default_rng()",
        "import numpy as np\nx = np.loadtxt('x')",
        "n = 0\ndef f():\n    global n\n    n += 1",
        "seen = []\ndef f(x):\n    seen.append(x)",
        "seen: dict[int, int] = {}\ndef f(x):\n    seen[x] = 1",
        "seen = {}\ndef f(x):\n    del seen[x]",
        "seen = {}\ndef f(x):\n    seen[x] += 1",
        "seen = {1: []}\ndef f(x):\n    seen[1].append(x)",
        "a, seen = 1, []\ndef f(x):\n    seen.append(x)",
        "seen = []\nclass A:\n    def f(self, x):\n        seen.append(x)",
        "seen = []\nf = lambda x: seen.append(x)",
        "def f():\n    f.calls = 1",
        "class A:\n    n = 0\n    def f(self):\n        A.n += 1",
        "from fsw.wire import messages\ndef f():\n    messages.x = 1",
        "async def f():\n    pass",
    ],
)  # fmt: skip
def test_the_checker_finds(violation):
    assert impurities(violation, CALCULATION | {"fsw.wire"})


@pytest.mark.parametrize(
    "innocent",
    [
        "import numpy as np\nfrom numpy.typing import NDArray\nfrom collections.abc import Callable",
        "from fsw.wire.frame import Frame\nfrom filterpy.kalman import KalmanFilter",
        "TABLE = {1: 2}\ndef f(x):\n    return TABLE[x]",
        "class A:\n    def __hash__(self):\n        return hash(self.x)",
        "seen = []\ndef f(x):\n    seen = []\n    seen.append(x)\n    return seen",
        "def f(seen):\n    seen[0] = 1",
        "class A:\n    def f(self, x):\n        self.seen = []\n        self.seen.append(x)",
        "values = [n for n in range(3)]\nvalues.append(3)",
        "def f(x):\n    'open and print'\n    return x.random",
    ],
)
def test_the_checker_lets_pass(innocent):
    assert impurities(innocent, CALCULATION | {"fsw.wire"}) == []


# --- the layers


@pytest.mark.parametrize("path", modules("fsw.core"), ids=dotted)
def test_the_flight_core_only_calculates(path):
    assert impurities(path.read_text(), CALCULATION | {"fsw.core", "fsw.wire"}) == []


BESIDE_LAWS = {f"fsw.core.laws.{name}" for name in ("plan", "interface", "entry", "motion")}
SHARED_BY_LAWS = [path for path in modules("fsw.core.laws") if within(dotted(path), BESIDE_LAWS)]


@pytest.mark.parametrize("path", SHARED_BY_LAWS, ids=dotted)
def test_what_laws_share_knows_no_law(path):
    laws = [name for name in imported(ast.parse(path.read_text())) if within(name, {"fsw.core.laws"})]
    assert [name for name in laws if not within(name, BESIDE_LAWS)] == []


@pytest.mark.parametrize("path", modules("fsw.wire"), ids=dotted)
def test_the_wire_only_calculates(path):
    assert impurities(path.read_text(), CALCULATION | {"fsw.wire"}) == []


BOARDS = [path for path in modules("hil_stub") if path.parent.name != "process"]


@pytest.mark.parametrize("path", BOARDS, ids=dotted)
def test_the_boards_only_calculate_and_know_the_wire(path):
    standard = {name for name in CALCULATION if name in sys.stdlib_module_names}
    assert impurities(path.read_text(), standard | {"hil_stub", "fsw.wire"}) == []


@pytest.mark.parametrize("path", modules("sim.plant"), ids=dotted)
def test_the_plant_knows_the_wire_and_the_boards(path):
    ours = {name for name in imported(ast.parse(path.read_text())) if name.partition(".")[0] in PACKAGES}
    assert {name for name in ours if not within(name, {"sim.plant", "fsw.wire", "hil_stub"})} == set()


def test_every_layer_has_modules():
    layers = ("fsw.core", "fsw.wire", "hil_stub.coils", "hil_stub.sensors", "sim.plant")
    assert all(len(modules(layer)) > 2 for layer in layers)
    assert len(BOARDS) > 10


# --- import-linter: the contracts of pyproject.toml, indirect imports too


def lint(folder):
    command = "import sys, importlinter.cli as cli; sys.exit(cli.lint_imports(no_cache=True, no_logo=True))"
    done = subprocess.run(
        [sys.executable, "-c", command], cwd=folder, capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.long
def test_the_contracts_are_kept():
    code, said = lint(ROOT)
    assert code == 0, said
    assert "0 broken" in said


PLANTED = {
    "what flies does not know what stays on the ground": ("fsw/node.py", "import sim.plant.plant"),
    "torquer: the command line over": ("torquer/api/run.py", "import torquer.cli.main"),
    "fsw: the node over its table": ("fsw/core/step.py", "from fsw.bus import interface"),
    "fsw.core: a step over what it is made of": ("fsw/core/algebra/vector.py", "import fsw.core.laws.table"),
    "fsw.core.laws: the choice among them and their table over the laws": (
        "fsw/core/laws/plan/riccati.py",
        "import fsw.core.laws.interface",
    ),
    "what is thought of the sensors and of the coils": (
        "fsw/core/fdir/coils/effects.py",
        "import fsw.core.fdir.sensors.pair",
    ),
    "boards: what starts them over the bench": ("hil_stub/node.py", "def f():\n    import hil_stub.bench"),
    "boards know the wire, and what starts them": ("hil_stub/process/command.py", "import fsw.core.state"),
    "boards on their own know the wire alone": ("hil_stub/coils/interlock.py", "import fsw.bus.hub"),
    "sim: from the plant over flights": ("sim/record/candump.py", "import sim.replay.log_replay"),
    "sim.commissioning: wiring and calibration over": (
        "sim/commissioning/recorded/columns.py",
        "import sim.commissioning.telemetry.follow",
    ),
    "sim.judge: the command over pages": ("sim/judge/profile.py", "import sim.judge.invariants"),
    "sim.campaign: commands over their workers": ("sim/campaign/flight.py", "import sim.campaign.one_run"),
    "sim.plant: boards and physics over": ("sim/plant/rotation.py", "import sim.plant.hardware.coils"),
    "the plant knows the wire": (
        "sim/plant/environment/field.py",
        "import fsw.core.orbit.igrf",
    ),
    "the auditor shares no code": ("sim/audit/auditor.py", "from hil_stub.coils import interlock"),
    "gain design is theory": ("sim/design/theory/linear.py", "import sim.scenario.schema"),
}
"""What each contract of pyproject.toml must find: its first words, and a line in a module."""


def test_every_contract_has_a_planted_import():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    names = [contract["name"] for contract in contracts]
    assert [name for name in names if not any(name.startswith(words) for words in PLANTED)] == []
    assert [contract["name"] for contract in contracts if "ignore_imports" in contract] == []


@pytest.mark.long
def test_the_contracts_catch_planted_imports(tmp_path):
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for module, line in PLANTED.values():
        with (tmp_path / module).open("a") as file:
            file.write(f"\n{line}\n")
    code, said = lint(tmp_path)
    assert code == 1
    assert f"{len(PLANTED)} broken" in said
    assert [name for name in PLANTED if f"{name}" not in said.partition("Broken contracts")[2]] == []
