"""Lists and records of the state that mean something else in plain Python than compiled.

In plain Python an assignment binds one list or record to two names, a slice is a list of its own,
and + and * join and repeat lists. Compiled all of them are numbers in a row: an assignment copies
them, a slice is a part of them, + and * count with them one by one.

How it works: the text of a law is followed, and that of the functions to which it hands parts of
its state, with the part that each name refers to. Twice, for a name may have in a loop the part
that the round before has left in it.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Iterable
from dataclasses import is_dataclass
from types import FunctionType, ModuleType
from typing import Any

from ev_msgs_py.compilable import FUNCTIONS

_ONLY_READING = ("len", "sum", "min", "max")
_SAME_ITEMS = ("reversed", "list", "tuple")
Found = tuple[ast.AST, str]  # where a text is wrong, and what


def wrong_lists(
    functions: Iterable[Any], state: Any, tree_of: Callable[[FunctionType], ast.AST]
) -> dict[FunctionType, list[Found]]:
    """Mistakes by function, of those with a state as `s`, or with parts of one."""
    followed = _Followed(tree_of)
    for function in functions:
        followed.through(function, {"s": state})
    return {function: list(found.values()) for function, found in followed.found.items()}


class _Slice(list[Any]):
    """Some numbers of a list of the state."""


class _Followed:
    """The functions followed so far; `found` are their mistakes, by function and place."""

    def __init__(self, tree_of: Callable[[FunctionType], ast.AST]) -> None:
        self._tree_of = tree_of
        self.marked = set(FUNCTIONS)
        # what a function gives back, by what it was given
        self._given: dict[tuple[Any, ...], Any] = {}
        self.found: dict[FunctionType, dict[ast.AST, Found]] = {}

    def through(self, function: FunctionType, known: dict[str, Any]) -> Any:
        """The part of a state that a function returns for these parts by name.

        None if it returns no part.
        """
        key = (function, *((name, _kind(each)) for name, each in sorted(known.items())))
        if key not in self._given:
            self._given[key] = None  # a function that calls itself is refused as such
            tree = self._tree_of(function)
            arguments = dict.fromkeys(inspect.signature(function).parameters)
            text = _Text(self, function, {**arguments, **known})
            for _ in range(2):
                text.visit(tree)
            self.found.setdefault(function, {}).update(text.found)
            self._given[key] = text.gives
        return self._given[key]


class _Text(ast.NodeVisitor):
    """One function, statement by statement.

    `known` are its names with their parts of a state, None for others.
    """

    def __init__(self, followed: _Followed, function: FunctionType, known: dict[str, Any]) -> None:
        self._followed = followed
        self._known = known
        cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=False)
        self._outside = (function.__globals__, dict(cells))
        self.gives: Any = None
        self.found: dict[ast.AST, Found] = {}
        self._copied: set[ast.AST] = set()  # slices that are copied, or read, at once

    def _note(self, node: ast.AST, what: str) -> None:
        # The first mistake at a place is the nearest to its cause.
        self.found.setdefault(node, (node, what))

    def visit_Return(self, node: ast.Return) -> None:
        self.generic_visit(node)
        given = None if node.value is None else self._part(node.value)
        if isinstance(given, _Slice) and node.value not in self.found:
            self._note(node, "a slice is given back, in plain Python that is a copy")
            given = None
        self.gives = self.gives if given is None else given

    def visit_Assign(self, node: ast.Assign) -> None:
        pairs: list[tuple[ast.expr, ast.expr]] = []
        for target in node.targets:
            pairs += _pairs(target, node.value)
        wrong = [what for place, value in pairs if (what := self._shared(place, value))]
        if wrong:
            self._note(node, wrong[0])
        # A slice on the left takes the numbers of the right side at once.
        is_into_slice = len(pairs) == 1 and _whole(pairs[0][0]) is not pairs[0][0]
        if wrong or is_into_slice:
            self._copied.add(node.value)
        self.generic_visit(node)
        found = self._part(node.value)
        for target in node.targets:
            self._bind(target, found)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit_Assign(ast.copy_location(ast.Assign([node.target], node.value), node))

    def visit_NamedExpr(self, node: ast.NamedExpr) -> None:
        self.generic_visit(node)
        self._bind(node.target, self._part(node.value))

    def visit_For(self, node: ast.For) -> None:
        # A loop over a slice only reads it, unless its body changes what the slice is a copy of;
        # the second look may know better than the first one.
        self._copied.add(node.iter)
        if any(self._changes(each) for part in node.body for each in ast.walk(part)):
            self._copied.remove(node.iter)
        self.visit(node.iter)
        found = self._part(node.iter)
        self._bind(node.target, found[0] if isinstance(found, list) and found else None)
        for each in (*node.body, *node.orelse):
            self.visit(each)

    def visit_BinOp(self, node: ast.BinOp | ast.AugAssign) -> None:
        both = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.target, node.value)
        if any(isinstance(self._part(_whole(each)), list) for each in both):
            self._copied.update(both)
            text = ast.unparse(node)
            self._note(node, f"{text} joins lists in plain Python, write a loop over their numbers")
        self.generic_visit(node)

    visit_AugAssign = visit_BinOp

    def visit_Compare(self, node: ast.Compare) -> None:
        both = (node.left, *node.comparators)
        if any(isinstance(self._part(_whole(each)), list) for each in both):
            self._copied.update(both)
            text = ast.unparse(node)
            self._note(node, f"{text} compares lists as a whole, write a loop over their numbers")
        self.generic_visit(node)

    def visit_If(self, node: ast.If | ast.While | ast.IfExp) -> None:
        if isinstance(self._part(_whole(node.test)), list):
            self._copied.add(node.test)
            text = ast.unparse(node.test)
            self._note(node.test, f"{text} is a list, write what is asked of its numbers")
        self.generic_visit(node)

    visit_While = visit_IfExp = visit_If

    def visit_Call(self, node: ast.Call) -> None:
        if isinstance(node.func, ast.Name) and node.func.id in _ONLY_READING:
            self._copied.update(node.args)
        arguments = (*node.args, *(each.value for each in node.keywords))
        given = [each for each in arguments if _leads_on(self._part(each))]
        # A function of the law's own that is handed this part alone, and so changes nothing else of
        # the state: its own text shows whether a copy makes a difference.
        if len(given) == 1 and isinstance(self._part(node.func), FunctionType):
            self._copied.update(given)
        self.generic_visit(node)
        self._part(node)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.ctx, ast.Store) and isinstance(self._part(node.value), _Slice):
            text = ast.unparse(node)
            why = "in plain Python a slice that is handed over is a copy"
            self._note(node, f"{text} is written, {why}")
        is_read_slice = isinstance(node.slice, ast.Slice) and isinstance(node.ctx, ast.Load)
        if is_read_slice and node not in self._copied:
            of = self._part(node.value)
            if isinstance(of, list) and not _is_record(of[0]):
                why = "a list of its own in plain Python, read its numbers one by one"
                self._note(node, f"{ast.unparse(node)} is {why}")
        elif isinstance(node.value, ast.Subscript):
            self._copied.add(node.value)
        self.generic_visit(node)

    def _changes(self, node: ast.AST) -> bool:
        """Return whether a part of a loop may change numbers of a list of the state."""
        if isinstance(node, ast.Call):
            return any(_is_shared(self._part(each)) for each in node.args)
        return isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store)

    def _bind(self, target: ast.expr, found: Any) -> None:
        if isinstance(target, ast.Name):
            self._known[target.id] = found
        elif isinstance(target, ast.Tuple | ast.List):
            for place, each in enumerate(target.elts):
                of = None
                if isinstance(found, tuple | list) and found:
                    # A list has one element here that stands for all.
                    of = found[min(place, len(found) - 1)]
                self._bind(each, of)

    def _shared(self, place: ast.expr, value: ast.expr) -> str:
        """Mistake in an assignment to a place of the state that holds several numbers.

        Empty if there is none.
        """
        to = ast.unparse(place)
        of = ast.unparse(value)
        whole = self._part(_whole(place))
        # A local name may refer to a part of the state.
        if isinstance(place, ast.Name) or not _is_shared(whole):
            return ""
        if not isinstance(whole, list) or _is_record(whole[0]):
            return f"{to} = {of} may make them one record, copy its entries one by one"
        # A slice on the left copies.
        if _whole(place) is not place:
            return ""
        return f"{to} = {of} may make them one list, numbers are copied by {to}[:] = {of}"

    def _part(self, node: ast.expr) -> Any:
        """Value of an expression such as s.ring or s.wheels[i].ring in a state.

        None if it is not of the state.
        """
        match node:
            case ast.Name(id=name):
                return self._known[name] if name in self._known else self._outside_of(name)
            case ast.Attribute(value=of, attr=name):
                whole = self._part(of)
                found = getattr(whole, name, None)
                if _is_record(whole) or isinstance(whole, tuple):
                    return found
                return self._reached(found)
            case ast.Subscript(value=of, slice=place):
                return _item(self._part(of), place)
            case ast.NamedExpr(value=value):
                return self._part(value)
            case ast.IfExp(body=one, orelse=other):
                found = self._part(one)
                return self._part(other) if found is None else found
            case ast.Tuple(elts=parts):
                return tuple(map(self._part, parts))
            case ast.List(elts=parts):
                found = self._part(parts[0]) if parts else None
                return None if found is None else [found]
            case ast.Call():
                return self._given_by(node)
        return None

    def _outside_of(self, name: str) -> Any:
        own, inner = self._outside
        return self._reached(inner[name].cell_contents if name in inner else own.get(name))

    def _reached(self, found: Any) -> Any:
        """A module, function or named tuple from outside of the function; else None.

        By such it may handle a state.
        """
        if isinstance(found, FunctionType):
            return found if found in self._followed.marked else None
        return found if isinstance(found, ModuleType) or _is_named_tuple(found) else None

    def _given_by(self, node: ast.Call) -> Any:
        given = [self._part(each) for each in node.args]
        items = [each[0] if isinstance(each, list) and each else None for each in given]
        function = self._part(node.func)
        match node.func:
            case ast.Name(id="enumerate") if items:
                return [(None, items[0])]
            case ast.Name(id="zip"):
                return [tuple(items)]
            case ast.Name(id=name) if name in _SAME_ITEMS and items:
                return given[0] if _is_record(items[0]) or isinstance(items[0], tuple) else None
        if not callable(function):
            return None
        by_name = {each.arg: self._part(each.value) for each in node.keywords if each.arg}
        try:
            if isinstance(function, type):
                return function(*given, **by_name)
            known = inspect.signature(function).bind(*given, **by_name).arguments
        except TypeError:  # Python reports this call itself
            return None
        if any(map(_leads_on, known.values())):
            return self._followed.through(function, known)
        return None


def _is_named_tuple(found: Any) -> bool:
    return isinstance(found, type) and issubclass(found, tuple)


def _leads_on(found: Any) -> bool:
    """Return whether a value holds parts of a state."""
    if isinstance(found, tuple):
        return any(map(_leads_on, found))
    return _is_shared(found)


def _item(of: Any, place: ast.expr) -> Any:
    """The element, or the slice, of a part of a state; None if that is none."""
    if isinstance(place, ast.Slice):
        is_of_numbers = isinstance(of, list) and of and not _is_record(of[0])
        return _Slice(of) if is_of_numbers else of
    if isinstance(of, tuple) and isinstance(place, ast.Constant) and isinstance(place.value, int):
        return of[place.value] if -len(of) <= place.value < len(of) else None
    return of[0] if isinstance(of, list | tuple) and of else None


def _is_record(found: Any) -> bool:
    return is_dataclass(found) and not isinstance(found, type)


def _is_shared(found: Any) -> bool:
    return isinstance(found, list) or _is_record(found)


def _kind(found: Any) -> Any:
    """Kind of a part of a state: parts of one kind mean the same in a text."""
    match found:
        case list():
            return (type(found), *map(_kind, found[:1]))
        case tuple():
            return (type(found), *map(_kind, found))
    if _is_record(found):
        return type(found)
    return found if callable(found) else None


def _pairs(target: ast.expr, value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Targets and values of an assignment, one by one where both are tuples."""
    if not isinstance(target, ast.Tuple):
        return [(target, value)]
    values = value.elts if isinstance(value, ast.Tuple) else [value] * len(target.elts)
    return list(zip(target.elts, values, strict=False))


def _whole(value: ast.expr) -> ast.expr:
    """The list of which an expression is a slice; the expression itself if it is no slice."""
    if isinstance(value, ast.Subscript) and isinstance(value.slice, ast.Slice):
        return value.value
    return value
