"""The source text of a compiled part.

It is a C function that reads signals from a frame, calls the law, and writes its answer.

    int step(double *now, double *next, double *state, double *constants)

How it works: a role that answers reads and writes `now`. One that integrates reads `now`, advances
its state, and writes `next`; with `now` a null pointer it writes its initial outputs. All outputs
begin as NaN, which no frame may hold, and remain NaN where the law raises an exception.

A law that is not ours is compiled with all that it calls so that an index out of range raises an
exception, which costs it time. Then the result is 1, and the state is that before the step: it
works on a copy. The same holds where an output is not finite, or negative and must not be: plain
Python may find the line.

`constants` is one row of numbers for each object: parameters, car, prepared constants.

    total  period  p ...  car ...  records of c ...  c ...  tables ...

`total` is the length of the row. A declared record in `c` is read by name at its place, like `p`
and `car`. For a tuple of numbers in `c` (a table) the row holds its place and its length; the
numbers themselves come at the end.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import is_dataclass
from functools import cache
from typing import Any, get_type_hints

import numpy as np

from ev_core.methods.law import Given, Law, asked_for, given_names, signals_in
from ev_core.methods.law_error import kind_of
from ev_core.methods.method_record import Method
from ev_core.methods.part import without_sign
from ev_core.parameters.record import numbers, record_type, shape_of_record, working_memory
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.packages import OURS

HEAD = ("total", "period")
_RECORD = "record_"  # the name of a record of `c`, with its number
_TEXT = '''"""{title}: generated, do not edit."""

from numba import carray, cfunc, {njit}types

P = types.voidptr

{write}
@cfunc(types.int32(P, P, P, P), error_model="numpy"{checks})
def step(now, next, state, constants):
    k = carray(constants, 1, CONSTANTS)[0]
    row = carray(constants, int(k.total), FLOAT)
    period = k.period
{given}
    there = carray(next, {size}, FLOAT)
{body}
'''
_WRITE = """
@njit(error_model="numpy", boundscheck=True)
def write(there, output):
{writing}

"""
_COPIED = 8192  # numbers of a state that the stack has room for


def constants_type(trees: Mapping[str, Any], c: Any) -> np.dtype:
    """The layout of a row up to the numbers of `c` that stand alone."""
    parts = [(name, record_type(tree)) for name, tree in trees.items() if tree]
    parts += [(f"{_RECORD}{n}", record_type(record)) for n, record in enumerate(_records(c))]
    return np.dtype([*((name, np.float64) for name in HEAD), *parts])


def constants_row(trees: Mapping[str, Any], c: Any, period: float) -> np.ndarray:
    """The row of one object."""
    head = [0.0, period]
    for tree in trees.values():
        head += numbers(tree)
    leaves: list[Any] = []
    for leaf in _leaves(c):
        if is_dataclass(leaf):
            head += numbers(leaf)
        else:
            leaves.append(leaf)
    # Tables begin behind all that stands alone: two numbers for a table, one for anything else.
    place = len(head) + sum(2 if isinstance(leaf, tuple) else 1 for leaf in leaves)
    tables: list[float] = []
    for leaf in leaves:
        if isinstance(leaf, tuple):
            head += [float(place + len(tables)), float(len(leaf))]
            try:
                tables += map(float, leaf)
            except (TypeError, ValueError):
                raise _wrong_constant(leaf) from None
        else:
            head.append(float(leaf))
    row = np.array(head + tables)
    row[0] = len(row)
    return row


def _wrong_constant(c: Any) -> TypeError:
    return TypeError(
        f"prepare gives {kind_of(c)}, expected a NamedTuple of numbers and tuples of numbers"
    )


def _leaves(c: Any) -> list[Any]:
    if c is None:
        return []
    if not hasattr(c, "_fields"):
        if not isinstance(c, (int, float, tuple, np.number)) and not is_dataclass(c):
            raise _wrong_constant(c)
        return [c]
    return [leaf for value in c for leaf in _leaves(value)]


def _records(c: Any) -> list[Any]:
    return [leaf for leaf in _leaves(c) if is_dataclass(leaf)]


@compilable
def table(row: Any, place: int) -> Any:
    """The table with its place and length at this place of the row."""
    begin = int(row[place])
    return row[begin : begin + int(row[place + 1])]


@compilable
def are_finite(numbers: Any, begin: int, end: int) -> bool:
    """Return whether the numbers of a frame from `begin` to `end` are finite."""
    are = True
    for i in range(begin, end):
        are = are and math.isfinite(numbers[i])
    return are


@compilable
def copy(there: Any, here: Any) -> None:
    """Copy a row of numbers one by one.

    An assignment of all of them takes a heap, which exports lack.
    """
    for i in range(len(there)):
        there[i] = here[i]


class Unpacking:
    """The source text that makes `c` of a row, and the names in it.

    The row begins with the record `k`.
    """

    def __init__(self, c: Any, begin: int) -> None:
        self.names: dict[str, Any] = {"table": table}
        self._place = begin
        self._records = 0
        self.text = self._expression(c)

    def _expression(self, value: Any) -> str:
        if value is None:
            return "None"
        if hasattr(value, "_fields"):
            name = f"C_{len(self.names)}"
            self.names[name] = type(value)
            return f"{name}({', '.join(self._expression(inner) for inner in value)})"
        if is_dataclass(value):
            self._records += 1
            return f"k.{_RECORD}{self._records - 1}"
        place = self._place
        if isinstance(value, tuple):
            self._place += 2
            return f"table(row, {place})"
        self._place += 1
        return f"row[{place}]"


def is_checked(method: Method) -> bool:
    """Return whether indices of a law are checked: unless both its name and its text are ours.

    The suite compiles ours once with the checks.
    """
    written_in = law_of(method).function.__globals__["__name__"].partition(".")[0]
    return method.package not in OURS or written_in not in OURS


def law_of(method: Method) -> Law:
    """The functions that a method is made of."""
    assert method.law is not None, f"{method.role} {method.name} is not made of functions"
    return method.law


_sources: dict[Any, tuple[str, dict[str, Any]]] = {}


def part_source(method: Method, given: Given) -> tuple[str, dict[str, Any]]:
    """The text, and the names that it uses.

    They are the same objects for all that is laid out alike, as the runs of a batch.
    """
    law = law_of(method)
    records = (*given.trees.values(), given.values["s"])
    key = (
        method.role,
        method.name,
        method.reads,
        method.writes,
        law.function,
        law.outputs,
        *map(shape_of_record, records),
        _shape_of(given.values["c"]),
    )
    if key not in _sources:
        _sources[key] = _part_source(method, given)
    return _sources[key]


def _shape_of(c: Any) -> Any:
    if hasattr(c, "_fields"):
        return type(c), *map(_shape_of, c)
    return shape_of_record(c) if is_dataclass(c) else isinstance(c, tuple) or type(c)


def _part_source(method: Method, given: Given) -> tuple[str, dict[str, Any]]:
    law = law_of(method)
    layout = constants_type(given.trees, given.values["c"])
    unpacking = Unpacking(given.values["c"], layout.itemsize // 8)
    names: dict[str, Any] = {
        "CONSTANTS": layout,
        "FLOAT": np.float64,
        "law": law.function,
        "Wheels": Wheels,
    }
    names.update(unpacking.names)
    lines = [f"{name} = k.{name}" for name, tree in given.trees.items() if tree]
    lines.append(f"c = {unpacking.text}")
    names["STATE"] = state = record_type(given.values["s"])
    size, checked = state.itemsize // 8, is_checked(method)
    is_copied = checked and 0 < size <= _COPIED
    if is_copied:
        names["working_memory"], names["copy"] = working_memory, copy
        lines += [f"kept, memory = carray(state, {size}, FLOAT), working_memory(STATE)"]
        lines += ["numbers, s = memory.view(FLOAT), memory[0]", "copy(numbers, kept)"]
    elif size:
        lines.append("s = carray(state, 1, STATE)[0]")
    reading = [f"here = carray(now, {frame.SIZE}, FLOAT)"]
    arguments = list(given_names(law.function))
    for asked in asked_for(law.function):
        argument = f"signal_{len(arguments)}"
        reading.append(f"{argument} = {made_of_frame(asked, names)}")
        arguments.append(argument)
    call = f"law({', '.join(arguments)})"
    if ROLES[method.role].kind is RoleKind.INTEGRATES:
        names["outputs"] = law.outputs
        here, *signals = reading
        is_stepped = "if here.ctypes.data:"
        reading = [here, is_stepped, *_indented(signals)]
        calls = [*([is_stepped] if checked else []), f"    {call}"]
        calls.append(f"output = outputs({', '.join(given_names(law.outputs))})")
    else:
        calls = [f"output = {call}"]
    write, writing = "", _writing(method.writes, checked)
    names["NAN"] = math.nan
    if checked:
        # In a `try` the compiler makes a block of each operation, and follows the blocks by
        # recursion. So reading and writing, of up to hundreds of numbers, stand outside.
        names["are_finite"], names["without_sign"] = are_finite, without_sign
        write = _WRITE.format(writing="\n".join(_indented(writing)))
        begin, end = frame.span(method.writes)
        done = [*(["copy(kept, numbers)"] if is_copied else []), "status = 0"]
        writing = [
            "write(there, output)",
            f"if are_finite(there, {begin}, {end}):",
            *_indented(done),
        ]
        calls = [
            "status = 1",
            "try:",
            *_indented([*calls, *writing]),
            "except Exception:",
            "    pass",
        ]
        writing = []
    body = [*reading, *calls, *writing]
    body = [f"there[{frame.PLACES[signal].start}] = NAN" for signal in method.writes] + body
    body.append("return status" if checked else "return 0")
    text = _TEXT.format(
        title=f"{method.role} {method.name}",
        write=write,
        njit="njit, " if checked else "",
        checks=", boundscheck=True" if checked else "",
        given="\n".join(_indented(lines)),
        size=frame.SIZE,
        body="\n".join(_indented(body)),
    )
    return text, names


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def made_of_frame(asked: type, names: dict[str, Any]) -> str:
    """The expression that makes an argument of the frame `here`.

    An argument is a signal or a NamedTuple of signals.
    """
    names[asked.__name__] = asked
    if signals_in(asked) == (asked,):
        return _reading(asked)
    fields = [made_of_frame(each, names) for each in get_type_hints(asked).values()]
    return f"{asked.__name__}({', '.join(fields)})"


@cache
def _reading(signal: type) -> str:
    """The expression that makes a signal of the frame `here`."""
    if signal is Instant:
        return f"Instant(here[{frame.TIME}])"
    begin, shape = frame.PLACES[signal].start, shape_of(signal)
    values = [f"here[{begin + i}]" for i in range(shape.size)]
    if shape.per_wheel:
        values = [f"Wheels({', '.join(values[i : i + 4])})" for i in range(0, shape.size, 4)]
    return f"{signal.__name__}({', '.join(values)})"


def _writing(writes: tuple[type, ...], checked: bool) -> list[str]:
    """The statements that put the `output` into the frame `there`, as its messages carry it."""
    lines = []
    for n, signal in enumerate(writes):
        begin, shape = frame.PLACES[signal].start, shape_of(signal)
        source = "output" if len(writes) == 1 else f"output[{n}]"
        for i, (channel, single) in enumerate(zip(shape.channels, shape.single, strict=True)):
            value = f"{source}.{channel}"
            if checked and i in shape.never_negative:
                value = f"without_sign({value})"
            if single:
                value = f"types.float32({value})"
            lines.append(f"there[{begin + i}] = {value}")
    return lines
