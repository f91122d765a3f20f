"""Lists and records of the state where the text of a law means something else in plain Python than compiled.

In plain Python an assignment binds one list or record to two names, and + and * join and repeat lists. Compiled all of
them are numbers in a row: an assignment copies them, + and * count with them one by one.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from typing import Any

Known = Mapping[str, Any]  # what names of a function stand for in a state


def wrong_lists(tree: ast.AST, state: Any) -> Iterator[tuple[ast.stmt | ast.expr, str]]:
    """Where the function of a tree, which calls the state `s`, does so, and why it is wrong."""
    known = _known(tree, state)
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=targets, value=value):
                for target in targets:
                    for place, of in _pairs(target, value):
                        if what := _shared(place, of, known):
                            yield node, what
            case ast.BinOp(left=one, right=other) | ast.AugAssign(target=one, value=other):
                if any(isinstance(_in_state(_whole(each), known), list) for each in (one, other)):
                    yield node, f"{ast.unparse(node)} joins lists in plain Python, write a loop over their numbers"


def _known(tree: ast.AST, state: Any) -> dict[str, Any]:
    """The state, and what other names of the function stand for in it."""
    known = {"s": state}
    nodes = [each for each in ast.walk(tree) if isinstance(each, ast.Assign | ast.For)]
    for node in sorted(nodes, key=lambda each: each.lineno):
        target = node.target if isinstance(node, ast.For) else node.targets[0]
        found = _in_state(node.iter if isinstance(node, ast.For) else node.value, known)
        if isinstance(node, ast.For):
            found = found[0] if isinstance(found, list) else None
        if isinstance(target, ast.Name) and _is_shared(found):
            known[target.id] = found
    return known


def _shared(place: ast.expr, value: ast.expr, known: Known) -> str:
    """What is wrong with an assignment to a place of the state that several numbers stand in; empty if nothing is."""
    to, of = ast.unparse(place), ast.unparse(value)
    whole = _in_state(_whole(place), known)
    if isinstance(place, ast.Name) or not _is_shared(whole):  # a name of its own may stand for it
        return ""
    if isinstance(whole, list) and not is_dataclass(whole[0]):
        return (
            ""
            if _whole(place) is not place
            else f"{to} = {of} may make them one list, numbers are copied by {to}[:] = {of}"
        )
    return f"{to} = {of} may make them one record, copy its entries one by one"


def _is_shared(found: Any) -> bool:
    return isinstance(found, list) or is_dataclass(found)


def _pairs(target: ast.expr, value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Targets and values of an assignment, one by one where both are tuples."""
    if not isinstance(target, ast.Tuple):
        return [(target, value)]
    values = value.elts if isinstance(value, ast.Tuple) else [value] * len(target.elts)
    return list(zip(target.elts, values, strict=False))


def _whole(value: ast.expr) -> ast.expr:
    """What a slice is one of; anything else as it is."""
    return value.value if isinstance(value, ast.Subscript) and isinstance(value.slice, ast.Slice) else value


def _in_state(node: ast.expr, known: Known) -> Any:
    """What an expression such as s.ring or s.wheels[i].ring is in a state; None if it is anything else."""
    match node:
        case ast.Name(id=name):
            return known.get(name)
        case ast.Attribute(value=of, attr=name):
            return getattr(_in_state(of, known), name, None)
        case ast.Subscript(value=of, slice=place) if not isinstance(place, ast.Slice):
            each = _in_state(of, known)
            return each[0] if isinstance(each, list) and each else None
    return None
