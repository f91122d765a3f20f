"""Names of a function that may have no value where they are read: plain Python raises there, compiled they are 0.

How it works: the statements are followed in their order, with the names that have a value by then on every way there.
Behind branches these are the names that have one at the end of each, and behind a loop those from before it, unless
its text shows that it runs once at least. Ways that return, raise or leave the loop do not count for what follows.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator
from typing import Any

Names = frozenset[str]


def unassigned(tree: ast.AST, function: Callable[..., Any]) -> Iterator[tuple[ast.expr, str]]:
    """Where the text of a function reads a name that may have no value, and what is wrong with that."""
    for defined in ast.walk(tree):
        if isinstance(defined, ast.FunctionDef):
            flow = _Flow(defined, function.__globals__)
            yield from (
                (node, f"{node.id} may have no value here, give it one on every way: compiled it is 0")
                for node in flow.found
            )
            return  # those within it are refused as such


class _Flow:
    """The ways through a function; `found` are the places that read a name without a value."""

    def __init__(self, defined: ast.FunctionDef, constants: dict[str, Any]) -> None:
        self._constants = constants
        self._own = _bound(defined.body) - _of_comprehensions(defined)
        self._breaks: list[list[Names]] = []
        self._continues: list[list[Names]] = []
        self.found: list[ast.Name] = []
        given = defined.args
        self._through(
            defined.body, frozenset(each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs))
        )

    def _through(self, body: Iterable[ast.stmt], have: Names | None) -> Names | None:
        """The names with a value behind some statements; None if no way leads there."""
        for statement in body:
            if have is None:
                return None
            have = self._over(statement, have)
        return have

    def _over(self, node: ast.stmt, have: Names) -> Names | None:
        match node:
            case ast.Return() | ast.Raise():
                self._read(node, have)
                return None
            case ast.Break():
                self._breaks[-1].append(have)
                return None
            case ast.Continue():
                self._continues[-1].append(have)
                return None
            case ast.If(test=test, body=body, orelse=orelse):
                have = self._read(test, have)
                return _on_both(self._through(body, have), self._through(orelse, have))
            case ast.While(test=test):
                have = self._read(test, have)
                never_ends = isinstance(test, ast.Constant) and bool(test.value)
                return self._around(node, have, None if never_ends else have)
            case ast.For(target=target, iter=iterated):
                have = self._read(iterated, have)
                return self._around(node, have | _bound([target]), None if self._runs(iterated) else have)
            case ast.AnnAssign(value=None):
                return have
        if not hasattr(node, "body"):  # else it is refused as such, or its own text is not followed
            self._read(node, have)
        return have | _bound([node])

    def _around(self, loop: ast.For | ast.While, within: Names, without: Names | None) -> Names | None:
        """Behind a loop whose body begins with the names `within`; `without` are those where it does not run at all."""
        self._breaks.append([])
        self._continues.append([])
        behind = self._through(loop.body, within)
        for each in self._continues.pop():
            behind = _on_both(behind, each)
        breaks = self._breaks.pop()
        if isinstance(loop, ast.While) and without is None:
            behind = None  # it ends by a break alone
        behind = self._through(loop.orelse, _on_both(behind, without))
        for each in breaks:
            behind = _on_both(behind, each)
        return behind

    def _runs(self, iterated: ast.expr) -> bool:
        """Whether a loop runs once at least: over something else than a range, which has its length by declaration."""
        match iterated:
            case ast.Call(func=ast.Name(id="range"), args=[ast.Call(func=ast.Name(id="len"))]):
                return True
            case ast.Call(func=ast.Name(id="range"), args=args):
                if any(isinstance(each, ast.Call) for arg in args for each in ast.walk(arg)):
                    return False
                try:
                    text = compile(ast.Expression(ast.Tuple(args, ast.Load(), lineno=1, col_offset=0)), "", "eval")
                    return len(range(*eval(text, dict(self._constants)))) > 0
                except Exception:  # it depends on what the function is given
                    return False
        return True

    def _read(self, node: ast.AST, have: Names) -> Names:
        """Look at what a statement or a part of one reads, and add what it names by :=."""
        have |= {each.target.id for each in ast.walk(node) if isinstance(each, ast.NamedExpr)}
        for each in ast.walk(node):
            is_read = isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load)
            if isinstance(each, ast.AugAssign):
                each, is_read = each.target, True
            if is_read and isinstance(each, ast.Name) and each.id in self._own and each.id not in have:
                self.found.append(each)
        return have


def _bound(nodes: Iterable[ast.AST]) -> Names:
    """The names that some statements or targets give a value."""
    found = (each for node in nodes for each in ast.walk(node))
    return frozenset(each.id for each in found if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store))


def _of_comprehensions(tree: ast.AST) -> Names:
    return _bound(each.target for each in ast.walk(tree) if isinstance(each, ast.comprehension))


def _on_both(one: Names | None, other: Names | None) -> Names | None:
    """The names that have a value on both of two ways; None stands for no way."""
    if one is None or other is None:
        return other if one is None else one
    return one & other
