"""Mutants: one change each, every kind of change, nothing that is not code."""

import ast
import subprocess
import sys
import tomllib
from itertools import chain
from pathlib import Path

import pytest
from mutants import mutants
from mutation_page import targets

from sim.methods import read_methods

ROOT = Path(__file__).parents[2]

MODULES = {module: target for target in targets() for module in target.modules}


def changes(source, *, signs=False):
    return [mutant.change for mutant in mutants(source, signs=signs)]


@pytest.mark.parametrize(
    ("line", "after"),
    [
        ("a < b", {"a <= b"}),
        ("a >= b", {"a > b"}),
        ("a == b", {"a != b"}),
        ("a is not b", {"a is b"}),
        ("a not in b", {"a in b"}),
        ("x < y < z", {"x <= y < z", "x < y <= z"}),
        ("a + b - c", {"a - b - c", "a + b + c"}),
        ("(a + b) * c", {"(a - b) * c", "(a + b) / c"}),
        ("a // b % c", {"a * b % c", "a // b // c"}),
        ("a & b | c ^ d", {"a | b | c ^ d", "a & b & c ^ d", "a & b | c & d"}),
        ("a << b", {"a >> b"}),
        ("a and b or c", {"a or b or c", "a and b and c"}),
        ("not a", {"a"}),
        ("-a", {"a"}),
        ("-(-a // b)", {"(-a // b)", "-(a // b)", "-(-a * b)"}),
        ("7", {"8"}),
        ("True", {"False"}),
        ("2.0", {"3.001"}),
        ("a if b else c", {"a if not (b) else c"}),
        ("[a for a in b if c]", {"[a for a in b if True]"}),
        ("min(a)", {"max(a)"}),
        ("any(a) and min", {"all(a) and min", "any(a) or min"}),
        ("f(a, b=c)", {"f(a, )"}),
        ("f(a=b, **c)", {"f( **c)"}),
        ('"text"', set()),
        ("a", set()),
    ],
)
def test_in_an_expression(line, after):
    assert set(changes(f"x = {line}\n")) == {f"x = {line} -> x = {one}" for one in after}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("if a:\n    b()\n", ["if a: -> if not (a):", "b() -> pass"]),
        ("while a:\n    break\n", ["while a: -> while not (a):", "break -> continue"]),
        ("while a:\n    continue\n", ["while a: -> while not (a):", "continue -> break"]),
        ("a += b\n", ["a += b -> pass", "a += b -> a -= b"]),
        ("raise a\n", ["raise a -> pass"]),
        ("for a in b:\n    pass\n", ["for a in b: -> for a in ():"]),
        ("def f():\n    return\n", ["return -> pass"]),
        ("def f():\n    return a\n", ["return a -> return None"]),
        ("def f():\n    return None\n", []),
        ("a.b = c\n", ["a.b = c -> pass"]),
        ("a, b[c] = d\n", ["a, b[c] = d -> pass"]),
        ("a = b = c\n", []),
    ],
)
def test_of_a_statement(source, expected):
    assert sorted(changes(source)) == sorted(expected)


def test_what_is_not_executed_is_left():
    source = (
        '"""2 + 2."""\nfrom a import b\n\n\n@c(1)\ndef f(x: d[2]) -> e[3]:\n    """4."""\n    y: g[5] = x\n'
    )
    assert changes(source) == []


def test_operators_between_brackets_and_comments_are_found():
    assert changes("x = (a)  \\\n    + (b)\n") == ["+ (b) -> - (b)"]
    assert changes("x = (a +  # and - too\n     b)\n") == ["x = (a +  # and - too -> x = (a -  # and - too"]


@pytest.mark.parametrize(
    ("line", "after"),
    [
        ("a + b * c", {"a - b * c"}),
        ("a - -b", {"a + -b", "a - b"}),
        ("(a + b) @ c", {"(a - b) @ c", "-(a + b) @ c"}),
        ("a * b / c", {"-a * b / c"}),
        ("a * b + c @ d", {"-a * b + c @ d", "a * b - c @ d"}),
        ("-a * b", {"--a * b"}),
        ("-(a * b)", {"(a * b)"}),
        ("scale(a * b, c)", {"scale(-(a * b), c)"}),
        ("scale(a - b, c)", {"scale(a + b, c)", "scale(-(a - b), c)"}),
        ("cross(a, b)", {"cross([-part for part in a], b)"}),
        ("np.dot(a, b)", {"np.dot([-part for part in a], b)"}),
        ("transform(a, b)", {"transform(a, [-part for part in b])"}),
        ("a < b and min(c, 2)", set()),
        ("np.stack(-a, axis=-1)", {"np.stack(a, axis=-1)"}),
        ("np.moveaxis(-a, -1, 0)", {"np.moveaxis(a, -1, 0)"}),
        ("a.swapaxes(-1, -2)[-1]", {"a.swapaxes(-1, -2)[1]"}),
    ],
)
def test_of_a_sign_alone(line, after):
    assert set(changes(f"x = {line}\n", signs=True)) == {f"x = {line} -> x = {one}" for one in after}


def test_of_a_sign_in_a_sum_that_grows():
    assert changes("a -= b\n", signs=True) == ["a -= b -> a += b"]


def test_the_laws_are_all_there_each_with_the_tests_that_mirror_it():
    (laws,) = [target for target in targets() if target.name == "laws"]
    assert "fsw/core/laws/spin.py" in laws.modules
    assert laws.stages_of("fsw/core/laws/spin.py") == [
        ["tests/fsw/core/laws/test_spin.py"],
        ["tests/fsw/core/laws"],
    ]
    assert laws.stages_of("fsw/core/laws/relay_stages.py")[0] == ["tests/fsw/core/laws"]


def test_of_every_method_of_the_papers_the_signs_are_changed():
    signed = {module for target in targets() if target.signs for module in target.modules}
    named = {where.strip() for method in read_methods() for where in method.where.split(",")}
    modules = {where for where in named if where.endswith(".py")}
    assert len(modules) > 70
    assert modules <= signed


@pytest.mark.long
@pytest.mark.parametrize("module", [module for module in MODULES if module != "fsw/wire/messages.py"])
def test_every_mutant_of_the_modules_is_a_module_that_differs_in_one_line(module):
    source = (ROOT / module).read_text()
    made = MODULES[module].mutants_of(module)
    assert made or MODULES[module].signs
    for mutant in made:
        ast.parse(mutant.source)
        assert mutant.source.count("\n") <= source.count("\n")
        assert mutant.before in source
        assert mutant.source != source
    assert len({mutant.source for mutant in made}) == len(made)


def test_every_module_and_test_that_is_named_is_there():
    for table in tomllib.loads((ROOT / "tests/mutation/targets.toml").read_text()).values():
        for pattern in table["modules"]:
            assert list(ROOT.glob(pattern)), pattern
    for module, target in MODULES.items():
        for name in chain(*target.stages_of(module)):
            assert name.startswith("-") or (ROOT / name).exists(), name


@pytest.mark.long
def test_every_survivor_that_is_listed_is_a_mutant_that_there_is_and_has_a_reason():
    listed = tomllib.loads((ROOT / "tests/mutation/survivors.toml").read_text()).get("survivor", [])
    for one in listed:
        assert one["module"] in MODULES
        made = MODULES[one["module"]].mutants_of(one["module"])
        assert one["change"] in [mutant.change for mutant in made], one["change"]
        assert len(one["reason"]) > 20


@pytest.mark.long
def test_the_command_counts_mutants():
    done = subprocess.run(
        [sys.executable, str(ROOT / "tools" / "mutate.py"), "--list", "interlock"],
        check=True,
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert [line.split()[:2] for line in done.stdout.splitlines()] == [
        ["interlock", "hil_stub/coils/interlock.py"],
        ["interlock", "hil_stub/coils/guard.py"],
        ["interlock", "hil_stub/coils/coil_driver.py"],
        ["interlock", "hil_stub/coils/refusals.py"],
        ["interlock", "hil_stub/coils/read_back.py"],
        ["interlock", "hil_stub/node.py"],
        ["interlock", "hil_stub/coils/events.py"],
    ]
