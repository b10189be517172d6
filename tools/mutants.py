"""Mutants of a module: its source with one change in one line."""

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

COMPARED = {
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.Is: "is not",
    ast.IsNot: "is",
    ast.In: "not in",
    ast.NotIn: "in",
}
COMBINED = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Mod: ("%", "//"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.BitXor: ("^", "&"),
    ast.Pow: ("**", "*"),
}
CALLED = {"min": "max", "max": "min", "any": "all", "all": "any"}
NEGATED = {
    "scale": (0, "-({})"),
    "cross": (0, "[-part for part in {}]"),
    "dot": (0, "[-part for part in {}]"),
    "transform": (1, "[-part for part in {}]"),
}
"""Of a product with a vector: which factor is negated, and how."""
Span = tuple[int, int]
"""Start and end of a piece of source."""


@dataclass(frozen=True)
class Mutant:
    """One change: the line it is in, that line before and after, and the whole source with it."""

    line: int
    before: str
    after: str
    source: str

    @property
    def change(self) -> str:
        """The change without its line number, so that it outlasts other changes of the file."""
        return f"{self.before} -> {self.after}"


def mutants(source: str, *, signs: bool = False) -> Iterator[Mutant]:
    """Every mutant of a module, in the order of the source, each one once; ``signs``: of a sign alone."""
    sources = {source}
    for (begin, end), text in sorted((_sign_changes if signs else _changes)(source)):
        mutated = source[:begin] + text + source[end:]
        if mutated in sources:
            continue
        sources.add(mutated)
        line = source.count("\n", 0, begin) + 1
        yield Mutant(line, _line(source, begin), _line(mutated, begin), mutated)


def _line(source: str, place: int) -> str:
    begin = source.rfind("\n", 0, place) + 1
    end = source.find("\n", place)
    return source[begin : end if end >= 0 else None].strip()


def _spans(source: str) -> Callable[[ast.AST], Span]:
    """Where a node stands in the source."""
    lines = source.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))
    text = source.encode()

    def at(line: int, column: int) -> int:
        return len(text[: starts[line - 1] + column].decode())

    def span(node: Any) -> Span:  # of the nodes that have a place, which ast gives no class of their own
        return at(node.lineno, node.col_offset), at(node.end_lineno, node.end_col_offset)

    return span


def _sign_changes(source: str) -> Iterator[tuple[Span, str]]:
    """(place, replacement) of each change of a sign: of a sum, a minus, a product of numbers or vectors.

    The number of an axis of an array is left: the minus of a last one counts from the end.
    """
    span = _spans(source)
    tree = ast.parse(source)
    left = {id(part) for node in ast.walk(tree) for part in _signed_elsewhere(node)}
    for node in _executable_nodes(tree):
        match node:
            case ast.BinOp(op=ast.Add() | ast.Sub() as op):
                operands_gap = (span(node.left)[1], span(node.right)[0])
                yield _swap_operator(source, operands_gap, COMBINED[type(op)][1])
            case ast.AugAssign(op=ast.Add() | ast.Sub() as op):
                operands_gap = (span(node.target)[1], span(node.value)[0])
                yield _swap_operator(source, operands_gap, COMBINED[type(op)][1] + "=")
            case ast.UnaryOp(op=ast.USub()) if id(node) not in left:
                begin = span(node)[0]
                yield (begin, begin + 1), ""
            case ast.BinOp(op=ast.MatMult() | ast.Mult() | ast.Div()) if id(node) not in left:
                begin = span(node)[0]
                yield (begin, begin), "-"
            case ast.Call(args=[_, _]) if _named(node.func) in NEGATED:
                place, negated = NEGATED[_named(node.func)]
                begin, end = span(node.args[place])
                yield (begin, end), negated.format(source[begin:end])


def _signed_elsewhere(node: ast.AST) -> list[ast.expr]:
    """The products in a node whose sign is that of another one or changed with it, and numbers of axes."""
    match node:
        case ast.BinOp(op=ast.MatMult() | ast.Mult() | ast.Div()):
            return [node.left, node.right]
        case ast.BinOp(op=ast.Add() | ast.Sub(), right=right) if not isinstance(right, ast.UnaryOp):
            return [right]
        case ast.UnaryOp(op=ast.USub()):
            return [node.operand]
        case ast.Call(args=[_, _]) if _named(node.func) in NEGATED:
            return [node.args[NEGATED[_named(node.func)][0]]]
        case ast.Call():
            return _numbers_of_axes(node)
    return []


def _numbers_of_axes(call: ast.Call) -> list[ast.expr]:
    """Those that are negative."""
    by_name = [keyword.value for keyword in call.keywords if keyword.arg == "axis"]
    numbers = call.args if _named(call.func) in ("moveaxis", "swapaxes") else by_name
    return [one for one in numbers if isinstance(one, ast.UnaryOp) and isinstance(one.operand, ast.Constant)]


def _named(called: ast.expr) -> str:
    """The name of what is called, without what it is of."""
    match called:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
    return ""


def _changes(source: str) -> Iterator[tuple[Span, str]]:  # noqa: PLR0912  (a case for each kind of node)
    """(place, replacement) of each change."""
    span = _spans(source)
    for node in _executable_nodes(ast.parse(source)):
        match node:
            case ast.Compare(ops=[op]) if type(op) in COMPARED:
                operands_gap = (span(node.left)[1], span(node.comparators[0])[0])
                yield _swap_operator(source, operands_gap, COMPARED[type(op)])
            case ast.Compare():
                for left, op, right in zip(
                    [node.left, *node.comparators], node.ops, node.comparators, strict=False
                ):
                    yield _swap_operator(source, (span(left)[1], span(right)[0]), COMPARED[type(op)])
            case ast.BoolOp(values=[*values]):
                other = "or" if isinstance(node.op, ast.And) else "and"
                for left, right in pairwise(values):
                    yield _swap_operator(source, (span(left)[1], span(right)[0]), other)
            case ast.BinOp() if type(node.op) in COMBINED:
                operands_gap = (span(node.left)[1], span(node.right)[0])
                yield _swap_operator(source, operands_gap, COMBINED[type(node.op)][1])
            case ast.AugAssign() if type(node.op) in COMBINED:
                operands_gap = (span(node.target)[1], span(node.value)[0])
                yield _swap_operator(source, operands_gap, COMBINED[type(node.op)][1] + "=")
            case ast.UnaryOp(op=ast.Not() | ast.USub() as op):
                begin = span(node)[0]
                yield (begin, begin + len("not " if isinstance(op, ast.Not) else "-")), ""
            case ast.Constant(value=bool() as value):
                yield span(node), str(not value)
            case ast.Constant(value=int() as value):
                yield span(node), str(value + 1)
            case ast.Constant(value=float() as value):
                yield span(node), repr(value * 1.5 + 1e-3)
            case ast.If() | ast.IfExp() | ast.While():
                begin, end = span(node.test)
                yield (begin, end), f"not ({source[begin:end]})"
            case ast.comprehension(ifs=[*conditions]):
                for condition in conditions:
                    yield span(condition), "True"
            case ast.Call(func=ast.Name(id=name) as called) if name in CALLED:
                yield span(called), CALLED[name]
            case ast.For():
                yield span(node.iter), "()"
            case ast.Return(value=None):
                yield span(node), "pass"
            case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
                yield span(value), "None"
            case ast.Assign(targets=[target]) if _is_persistent(target):
                yield span(node), "pass"
            case ast.Continue():
                yield span(node), "break"
            case ast.Break():
                yield span(node), "continue"
        if isinstance(node, ast.Raise | ast.AugAssign | ast.Expr):
            yield span(node), "pass"
        if isinstance(node, ast.Call):
            for keyword in node.keywords:
                if keyword.arg:
                    yield _with_comma(source, span(keyword)), ""


def _swap_operator(source: str, operands_gap: Span, operator: str) -> tuple[Span, str]:
    """Another operator between two operands, whatever brackets and line ends are there too."""
    begin, end = operands_gap
    gap = source[begin:end]
    old = gap.strip("() \t\n\\")
    comment = old.find("#")
    old = old if comment < 0 else old[:comment].strip()
    place = gap.index(old)
    return (begin + place, begin + place + len(old)), operator


def _is_persistent(target: ast.expr) -> bool:
    """Whether the target of an assignment outlasts the function: an attribute, or an element."""
    return any(isinstance(node, ast.Attribute | ast.Subscript) for node in ast.walk(target))


def _with_comma(source: str, argument: Span) -> Span:
    """The span of an argument and the comma after it."""
    begin, end = argument
    after = source[end:].lstrip()
    return begin, len(source) - len(after) + 1 if after.startswith(",") else end


def _executable_nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """Every node but annotations, docstrings, decorators and imports."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list", "type_comment"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.Import | ast.ImportFrom):
                continue
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
                continue
            yield child
            yield from _executable_nodes(child)
