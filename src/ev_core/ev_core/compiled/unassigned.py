"""Names of a function that may have no value where they are read.

Plain Python raises there, compiled they are 0.

How it works: the statements are followed in their order, with the names that have a value by then
on every way there. Behind branches these are the names that have one at the end of each, and behind
a loop those from before it, unless its text shows that it runs once at least. Ways that return,
raise or leave the loop do not count for what follows.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator
from typing import Any

Names = frozenset[str]


def unassigned(tree: ast.AST, function: Callable[..., Any]) -> Iterator[tuple[ast.expr, str]]:
    """Places where a function reads a name that may have no value, with the mistake in words."""
    for defined in ast.walk(tree):
        if isinstance(defined, ast.FunctionDef):
            for node in _Flow(defined, function.__globals__).found:
                lacks = f"{node.id} may have no value here"
                yield node, f"{lacks}, give it one on every way: compiled it is 0"
            return  # inner functions are refused as such


class _Flow:
    """The ways through a function; `found` are the places that read a name without a value."""

    def __init__(self, defined: ast.FunctionDef, constants: dict[str, Any]) -> None:
        self._constants = constants
        self._own = _bound(defined.body)
        self._iterables = _iterables(defined)
        # For each loop around a statement: the names with a value at its breaks and continues.
        self._breaks: list[list[Names]] = []
        self._continues: list[list[Names]] = []
        self.found: list[ast.Name] = []
        given = defined.args
        arguments = (*given.posonlyargs, *given.args, *given.kwonlyargs)
        self._through(defined.body, frozenset(each.arg for each in arguments))

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
                without = None if self._runs(iterated) else have
                return self._around(node, have | _bound([target]), without)
            case ast.Match(subject=subject, cases=cases):
                return self._matched(cases, self._read(subject, have))
            case ast.AnnAssign(value=None):
                return have
        # One with a body of statements is refused as such, or its own text is not followed.
        if not hasattr(node, "body"):
            self._read(node, have)
        return have | _bound([node])

    def _matched(self, cases: Iterable[ast.match_case], have: Names) -> Names | None:
        """Behind some cases, of which one or none is that of the subject."""
        behind: Names | None = None
        tried: Names | None = have
        for case in cases:
            if tried is None:
                break  # the one before takes all
            self._read(case.pattern, tried)
            within = tried | _named(case.pattern)
            if case.guard is not None:
                within = self._read(case.guard, within)
            behind = _on_both(behind, self._through(case.body, within))
            is_bare_name = isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None
            if is_bare_name and case.guard is None:
                tried = None  # it takes all that is left
        return _on_both(behind, tried)

    def _around(
        self, loop: ast.For | ast.While, within: Names, without: Names | None
    ) -> Names | None:
        """Names behind a loop that begins with `within`; `without` are those if it never runs."""
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
        """Return whether a loop runs once at least.

        All but ranges and slices have their length by declaration.
        """
        match iterated:
            case ast.Call(
                func=ast.Name(id="range"), args=[ast.Call(func=ast.Name(id="len"), args=[of])]
            ):
                return self._runs(of)
            case ast.Call(func=ast.Name(id="range"), args=args):
                return self._range_runs(args)
            # enumerate, zip, reversed and the like, or a function of one's own
            case ast.Call(args=args):
                return all(map(self._runs, args))
            case ast.IfExp(body=one, orelse=other):
                return self._runs(one) and self._runs(other)
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                return bool(parts)
            case ast.Subscript(slice=ast.Slice()):
                return False
            case ast.Name(id=name) if name in self._iterables:
                # Hidden meanwhile, for it may be made of itself.
                found = self._iterables[name]
                self._iterables[name] = None
                runs = found is not None and self._runs(found)
                self._iterables[name] = found
                return runs
        return not isinstance(iterated, ast.ListComp | ast.GeneratorExp)

    def _range_runs(self, bounds: list[ast.expr]) -> bool:
        """Return whether a range has an element, by constants of the module alone."""
        # A call may depend on anything, or do something.
        if any(isinstance(each, ast.Call) for bound in bounds for each in ast.walk(bound)):
            return False
        tree = ast.Expression(ast.Tuple(bounds, ast.Load(), lineno=1, col_offset=0))
        try:
            found = eval(compile(tree, "", "eval"), dict(self._constants))
            return len(range(*found)) > 0
        except Exception:  # it depends on what the function is given
            return False

    def _read(self, node: ast.AST, have: Names) -> Names:
        """Look at what a statement or a part of one reads, and add what it names by :=."""
        have |= {each.target.id for each in ast.walk(node) if isinstance(each, ast.NamedExpr)}
        hidden = {id(name) for each in ast.walk(node) for name in _of_comprehension(each)}
        for each in ast.walk(node):
            if id(each) in hidden:
                continue
            name: ast.AST | None = None
            if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load):
                name = each
            elif isinstance(each, ast.AugAssign):
                name = each.target  # x += 1 reads x, though its name is marked as written
            if isinstance(name, ast.Name) and name.id in self._own and name.id not in have:
                self.found.append(name)
        return have


def _bound(nodes: Iterable[ast.AST]) -> Names:
    """The names that some statements or targets give a value."""
    found = [each for node in nodes for each in ast.walk(node)]
    hidden = {id(name) for each in found for name in _of_comprehension(each)}
    names: set[str] = set()
    for each in found:
        if isinstance(each, ast.pattern):
            names |= _named(each)
        elif id(each) in hidden:
            continue
        elif isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store):
            names.add(each.id)
    return frozenset(names)


def _named(pattern: ast.pattern) -> Names:
    """The names that a pattern of a case gives a value."""
    names: set[str] = set()
    for each in ast.walk(pattern):
        # {"a": 1, **rest} binds `rest`; all other patterns bind `name`, if anything.
        name = getattr(each, "rest" if isinstance(each, ast.MatchMapping) else "name", None)
        if name is not None:
            names.add(name)
    return frozenset(names)


def _of_comprehension(node: ast.AST) -> Iterator[ast.Name]:
    """Names that belong to a comprehension alone; none for any other node."""
    if isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp):
        own: set[str] = set()
        for of in node.generators:
            own |= {each.id for each in ast.walk(of.target) if isinstance(each, ast.Name)}
        # The first iterable is read outside of the comprehension.
        first = {id(each) for each in ast.walk(node.generators[0].iter)}
        for each in ast.walk(node):
            if isinstance(each, ast.Name) and each.id in own and id(each) not in first:
                yield each


def _iterables(tree: ast.AST) -> dict[str, ast.expr | None]:
    """Values of a function's names, None for a name with several, or with a part of one."""
    found: dict[str, ast.expr | None] = {}
    single: dict[int, ast.expr] = {}
    for each in ast.walk(tree):
        if isinstance(each, ast.Assign):
            single[id(each.targets[0])] = each.value
    for each in ast.walk(tree):
        if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store):
            found[each.id] = None if each.id in found else single.get(id(each))
    return found


def _on_both(one: Names | None, other: Names | None) -> Names | None:
    """The names that have a value on both of two ways; None stands for no way."""
    if one is None or other is None:
        return other if one is None else one
    return one & other
