"""Names that stepped code may use: no bit of a run may depend on machine or way of running."""

from __future__ import annotations

import ast
import inspect
import textwrap

import pytest

from ev_core.methods.register import all_methods
from ev_msgs_py.compilable import FUNCTIONS

all_methods()  # imports everything that is stepped
OURS = [function for function in FUNCTIONS if function.__module__.startswith("ev_")]
# Exact in every C library, and in numba.
EXACT = {
    "inf",
    "nan",
    "pi",
    "tau",
    "ceil",
    "floor",
    "sqrt",
    "copysign",
    "fabs",
    "isfinite",
    "frexp",
    "ldexp",
}
# Working memory, single precision, and the bits of a number; no arithmetic.
NUMPY = {"zeros", "empty", "float32", "float64", "int64", "ndarray"}
FORBIDDEN_CALLS = {"sum", "pow", "hypot"}


def source(function) -> ast.AST:
    return ast.parse(textwrap.dedent(inspect.getsource(function)))


@pytest.mark.parametrize(
    "function", OURS, ids=lambda function: f"{function.__module__}.{function.__name__}"
)
def test_stepped_code_takes_its_functions_from_one_module(function):
    """Those of math and numpy round as the C library does.

    `**` and sum differ between Python and compiled code.
    """
    own = function.__globals__
    for node in ast.walk(source(function)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = getattr(own.get(node.value.id), "__name__", "")
            if module == "math":
                assert node.attr in EXACT, f"math.{node.attr}"
            if module == "numpy":
                assert node.attr in NUMPY, f"numpy.{node.attr}"
        elif (
            isinstance(node, ast.Name)
            and callable(own.get(node.id))
            and not isinstance(own[node.id], type)
        ):
            module = getattr(own[node.id], "__module__", "")
            assert module not in ("math", "numpy") or node.id in EXACT | NUMPY, (
                f"{node.id} of {module}"
            )
        elif isinstance(node, ast.BinOp):
            assert not isinstance(node.op, ast.Pow), ast.unparse(node)
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in FORBIDDEN_CALLS
        ):
            assert own.get(node.func.id) is not None, f"{node.func.id}()"
        elif isinstance(node, ast.Compare):
            assert not any(
                isinstance(side, ast.Constant) and isinstance(side.value, str)
                for side in node.comparators
            )


def test_there_is_stepped_code():
    """The test above looks at something."""
    assert len(OURS) > 200
