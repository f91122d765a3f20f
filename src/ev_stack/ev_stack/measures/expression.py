"""Expressions over channels, metrics and the car.

How it works: `parsed` gives the tree, and `term_of` turns each node of it into a term: its kind,
which is checked at once, and a function of a driven run. So a mistake is found before anything is
driven, and a metric is a call of nested functions afterwards.

An example: `maximum(abs(imu.yaw_rate[time > 2])) / vehicle.mass`.

They are read as Python's syntax and never run as Python: of the tree only what stands here has a
meaning.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ev_core.parameters.data_file import TIME
from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.measures import motion
from ev_stack.measures.derived import SERIES, VEHICLE, of_vehicle
from ev_stack.measures.metric import NotMeasured, between, channel
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.registry import METRICS

# characters, and parts of an expression: its tree is walked by recursion
_LONGEST, _MOST = 500, 200
REDUCTIONS: Mapping[str, Callable[[np.ndarray], float]] = {
    "minimum": np.min,
    "maximum": np.max,
    "largest_magnitude": lambda values: np.abs(values).max(),
    "first": lambda values: values[0],
    "last": lambda values: values[-1],
    "mean": np.mean,
    "root_mean_square": lambda values: np.sqrt(np.mean(values * values)),
    "standard_deviation": np.std,
}
_ARITHMETIC: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    # numpy's, for Python's own raise where a number is divided by 0, and make roots of negative
    # numbers complex.
    ast.Div: np.true_divide,
    ast.Pow: np.power,
}
_COMPARISONS: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_LOGIC: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.BitAnd: np.logical_and,
    ast.BitOr: np.logical_or,
}
AT = "at"  # at(VALUES, TIME)


class Kind(NamedTuple):
    """Kind of a term: a value at each sample, at some of them, or a condition."""

    is_series: bool = False
    is_part: bool = False
    is_condition: bool = False


# A part has lost the instants of its samples, so it can only be reduced or combined with numbers.
_NUMBER, _SERIES, _CONDITION, _PART = Kind(), Kind(True), Kind(True, False, True), Kind(True, True)


class Term(NamedTuple):
    """A part of an expression: its kind, and the function that computes it."""

    kind: Kind
    of: Callable[[DrivenRun], Any]


def _chosen(values: np.ndarray, condition: np.ndarray) -> np.ndarray:
    if not condition.any():
        raise NotMeasured("the condition holds at no sample")
    return values[condition]


# of values and time
OVER_TIME: Mapping[str, tuple[Kind, Callable[[np.ndarray, np.ndarray], Any]]] = {
    "integral": (_NUMBER, np.trapezoid),
    # numpy takes no gradient of a single sample; of one there is no change.
    "derivative": (
        _SERIES,
        lambda values, time: np.gradient(values, time) if len(time) > 1 else 0.0 * values,
    ),
    "unwrap": (_SERIES, lambda values, time: np.unwrap(values)),
}
ELEMENTWISE: Mapping[str, tuple[int, Callable[..., Any]]] = {  # number of arguments, and function
    **{
        name: (1, getattr(np, name))
        for name in (
            "abs",
            "sqrt",
            "exp",
            "log",
            "sin",
            "cos",
            "tan",
            "arcsin",
            "arccos",
            "arctan",
            "sign",
        )
    },
    **{name: (2, getattr(np, name)) for name in ("arctan2", "hypot", "minimum", "maximum")},
    **{
        "degrees": (1, np.degrees),
        "radians": (1, np.radians),
        "clip": (3, np.clip),
        "where": (3, np.where),
    },
}
FUNCTIONS = sorted({*REDUCTIONS, *OVER_TIME, *ELEMENTWISE, AT})


def number_of(tree: ast.expr) -> Callable[[DrivenRun], float]:
    """Build the function that computes a tree.

    Raises ParameterError, in one line, for what has no meaning or is not one number.
    """
    term = term_of(tree)
    if term.kind.is_series:
        raise ParameterError(
            "it has a value at each sample, expected one number, such as maximum(...) of it"
        )

    def of(run: DrivenRun) -> float:
        # What is not finite is refused where the number is used, with the number.
        with np.errstate(all="ignore"):
            return float(term.of(run))

    return of


def parsed(text: str) -> ast.expr:
    """The tree of an expression; ParameterError, in one line, if it is none or too long."""
    if len(text) > _LONGEST:
        raise ParameterError(f"it has {len(text)} characters, expected {_LONGEST}")
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ParameterError(f"no expression: {getattr(error, 'msg', error)}") from None
    if sum(1 for _ in ast.walk(tree)) > _MOST:
        raise ParameterError(f"it has too many parts, expected {_MOST}")
    return tree


def name_of(node: ast.expr) -> str | None:
    """A name with dots; None if a node is none."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and (before := name_of(node.value)) is not None:
        return f"{before}.{node.attr}"
    return None


def term_of(node: ast.expr) -> Term:
    """Build the term of a tree; ParameterError, in one line, for what has no meaning."""
    # Before all else: a channel such as imu.yaw_rate is an attribute in Python's tree.
    if (name := name_of(node)) is not None:
        return _named(name)
    # By type, not isinstance: True and False are ints.
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return _constant(node.value)
    if isinstance(node, ast.Call):
        return _called(node)
    if isinstance(node, ast.Subscript):
        return _subscript(node)
    if isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        return _each(_ARITHMETIC[type(node.op)], term_of(node.left), term_of(node.right))
    if isinstance(node, ast.BinOp) and type(node.op) in _LOGIC:
        return _logical(_LOGIC[type(node.op)], term_of(node.left), term_of(node.right))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        return _each(
            operator.neg if isinstance(node.op, ast.USub) else operator.pos, term_of(node.operand)
        )
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Invert):
        return _logical(np.logical_not, term_of(node.operand))
    if isinstance(node, ast.Compare) and all(type(each) in _COMPARISONS for each in node.ops):
        return _compared(node)
    # Python's words ask for one truth of a whole series, which numpy does not have.
    hint = (
        "; and, or, not are written &, |, ~" if isinstance(node, ast.BoolOp | ast.UnaryOp) else ""
    )
    raise ParameterError(
        f"{quoted(ast.unparse(node))} has no meaning, expected numbers, channels, time, metrics,"
        f" vehicle.NAME, + - * / **, comparisons, & | ~, [condition] and functions{hint}"
    )


def _time(run: DrivenRun) -> np.ndarray:
    if not len(run.signals.time):
        raise NotMeasured("the run has no samples")
    return run.signals.time


def _named(name: str) -> Term:
    if name == TIME:
        return Term(_SERIES, _time)
    if name in frame.channels():
        return Term(_SERIES, lambda run: channel(run.signals, name))
    if name in SERIES:
        return Term(_SERIES, SERIES[name].of)
    if name in METRICS:
        return Term(_NUMBER, METRICS[name].of)
    if name.startswith(VEHICLE):
        return Term(_NUMBER, of_vehicle(name.removeprefix(VEHICLE), None))
    if name == "pi":
        return Term(_NUMBER, lambda run: np.pi)
    raise (
        unknown_name("channel", name, frame.channels())
        if "." in name
        else unknown_name("name", name, [*METRICS, *SERIES, *FUNCTIONS, TIME, "pi"])
    )


def _constant(value: float) -> Term:
    try:
        # As numpy's, which overflow to infinity instead of raising.
        number = np.float64(value)
    except OverflowError:
        raise ParameterError("a number is too large") from None
    return Term(_NUMBER, lambda run: number)


def _each(function: Callable[..., Any], *terms: Term) -> Term:
    """A function of terms, sample by sample."""
    series = [term.kind for term in terms if term.kind.is_series]
    # Two parts may be of different samples even where they are as long.
    if any(kind.is_part for kind in series) and len(series) > 1:
        raise ParameterError(
            "values at some samples meet others, expected (A * B)[condition] for A[...] * B[...]"
        )
    kind = _NUMBER if not series else _PART if series[0].is_part else _SERIES
    return Term(kind, lambda run: function(*(_as_numbers(term.of(run)) for term in terms)))


def _as_numbers(values: Any) -> Any:
    return (
        # A condition counts as 1 and 0, so its mean is a share; numpy subtracts no booleans.
        values.astype(float) if isinstance(values, np.ndarray) and values.dtype == bool else values
    )


def _logical(function: Callable[..., Any], *terms: Term) -> Term:
    if not all(term.kind.is_condition for term in terms):
        raise ParameterError("& | ~ join conditions, such as (time > 1) & (imu.yaw_rate > 0)")
    return Term(_CONDITION, lambda run: function(*(term.of(run) for term in terms)))


def _compared(node: ast.Compare) -> Term:
    terms = [term_of(each) for each in (node.left, *node.comparators)]
    if any(term.kind.is_part for term in terms) or not any(term.kind.is_series for term in terms):
        raise ParameterError(f"{quoted(ast.unparse(node))} is no condition on all samples")
    functions = [_COMPARISONS[type(each)] for each in node.ops]

    def holds(run: DrivenRun) -> np.ndarray:
        values = [term.of(run) for term in terms]
        return reduce(
            np.logical_and,
            # A chain, as 0 < a < 1, compares neighbours: there is one value more than comparisons.
            (f(a, b) for f, a, b in zip(functions, values, values[1:], strict=False)),
        )

    return Term(_CONDITION, holds)


def _subscript(node: ast.Subscript) -> Term:
    """`VALUES[condition]`, `VALUES[start:end]` [s], or a number of a list of the vehicle."""
    name = name_of(node.value) or ""
    if name.startswith(VEHICLE):
        place = node.slice.value if isinstance(node.slice, ast.Constant) else None
        return Term(
            _NUMBER, of_vehicle(name.removeprefix(VEHICLE), place if type(place) is int else None)
        )
    if isinstance(node.slice, ast.Slice):
        return _window(node, node.slice)
    values, condition = term_of(node.value), term_of(node.slice)
    if not condition.kind.is_condition or not values.kind.is_series or values.kind.is_part:
        raise ParameterError(
            f"{quoted(ast.unparse(node))} is refused, expected CHANNEL[condition], such as [time >"
            " 1], or [1:2]"
        )
    return Term(_PART, lambda run: _chosen(_as_numbers(values.of(run)), condition.of(run)))


def _window(node: ast.Subscript, ends: ast.Slice) -> Term:
    """The samples from a start to before an end [s], which the run has to cover."""
    if ends.lower is None or ends.upper is None or ends.step is not None:
        raise ParameterError(
            f"{quoted(ast.unparse(node))} is refused, expected [START:END], or [time > START]"
        )
    values, start, end = term_of(node.value), term_of(ends.lower), term_of(ends.upper)
    if (
        not values.kind.is_series
        or values.kind.is_part
        or start.kind.is_series
        or end.kind.is_series
    ):
        raise ParameterError(
            f"{quoted(ast.unparse(node))} is refused, expected CHANNEL[START:END] with two numbers"
        )

    def of(run: DrivenRun) -> np.ndarray:
        inside = between(run.signals, float(start.of(run)), float(end.of(run)))
        return _as_numbers(values.of(run))[inside]

    return Term(_PART, of)


def _at(values: Term, instant: Term) -> Term:
    """The value at an instant [s], linear between samples."""
    if not values.kind.is_series or values.kind.is_part or instant.kind.is_series:
        raise ParameterError(f"{AT} is {AT}(CHANNEL, TIME)")
    return Term(
        _NUMBER,
        lambda run: motion.value_at(
            run.signals, _as_numbers(values.of(run)), float(instant.of(run))
        ),
    )


def _called(node: ast.Call) -> Term:
    name, count = name_of(node.func) or "", len(node.args)
    if name not in FUNCTIONS:
        raise unknown_name("function", name or ast.unparse(node.func), FUNCTIONS)
    terms = [term_of(each) for each in node.args]
    if node.keywords or any(isinstance(each, ast.Starred) for each in node.args):
        raise ParameterError(f"{name} takes values only, no names")
    # minimum and maximum of one series reduce it; of two values they are elementwise, further
    # below.
    if name in REDUCTIONS and count == 1:
        (term,) = terms
        if not term.kind.is_series:
            raise ParameterError(
                f"{name} is of a channel, {quoted(ast.unparse(node.args[0]))} is one number"
            )
        return Term(_NUMBER, lambda run: REDUCTIONS[name](_as_numbers(term.of(run))))
    if name in OVER_TIME and count == 1:
        # Over samples that were chosen, an integral would bridge the gaps between them.
        (term,), (kind, function) = terms, OVER_TIME[name]
        if not term.kind.is_series or term.kind.is_part:
            raise ParameterError(f"{name} is of a channel at all samples")
        return Term(kind, lambda run: function(_as_numbers(term.of(run)), run.signals.time))
    if name == AT and count == 2:
        return _at(*terms)
    wanted, elementwise = ELEMENTWISE.get(name, (2 if name == AT else 1, None))
    if elementwise is None or count != wanted:
        raise ParameterError(
            f"{name} takes {wanted} {'value' if wanted == 1 else 'values'}, here are {count}"
        )
    # The condition stays one, whereas _each makes numbers of it; of _each only the kind is needed.
    if name == "where":
        if not terms[0].kind.is_condition:
            raise ParameterError("where is where(condition, A, B)")
        return Term(
            _each(np.where, *terms).kind, lambda run: np.where(*(term.of(run) for term in terms))
        )
    return _each(elementwise, *terms)
