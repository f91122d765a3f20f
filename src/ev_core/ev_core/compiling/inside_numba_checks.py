"""The touch `checks` of numba (`inside_numba`).

Functions that a law of others calls fail where plain Python fails. What a function with
`boundscheck` calls checks its indices, its divisors, and whether functions of math have a result.
Plain: every function checks indices and divisors, more slowly, and none checks results.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import cache, reduce
from importlib import import_module
from typing import Any

from ev_core.compiling.inside_numba import is_used

RAISING, QUIET = "python", "numpy"  # numba's words for what a division by zero does
# an argument of functions that can raise, which some within numba itself cannot
_RAISED = "excinfo"


@cache
def make_checks_reach_callees() -> None:
    """Let functions that are compiled for a caller that checks fail where plain Python does."""
    if not is_used("checks"):
        config: Any = import_module("numba").config
        config.BOUNDSCHECK = 1
        return
    from numba.core.targetconfig import ConfigStack

    options_of_cpu: Any = import_module("numba.core.cpu").CPUTargetOptions
    finalize = options_of_cpu.finalize

    def inheriting(self: Any, flags: Any, options: Any) -> None:
        caller: Any = ConfigStack.top_or_none()
        if caller is not None and caller.boundscheck:
            flags.boundscheck, flags.error_model = True, RAISING
        finalize(self, flags, options)

    options_of_cpu.finalize = inheriting
    _check_results()


def error_model() -> str:
    """Error model of a function with a caller that does not check.

    It is quiet, in the plain way one that raises.
    """
    return QUIET if is_used("checks") else RAISING


def _check_results() -> None:
    """Let functions of math, powers, int and round fail as they do in Python.

    They fail where a division by zero does.
    """
    from numba import types
    from numba.core.imputils import builtin_registry
    from numba.core.registry import cpu_target
    from numba.cpython import builtins, mathimpl
    from numba.extending import intrinsic

    cpu_target.target_context.refresh()  # which fills the registry
    numbers = {types.Float: types.float64, types.Integer: types.int64}
    known = [
        each
        for each in builtin_registry.functions
        if each[1] in (pow, operator.pow, operator.ipow, round)
    ]
    for lower, function, kinds in (*mathimpl.registry.functions, *known):
        narrower = tuple(numbers.get(kind, kind) for kind in kinds)  # is preferred
        if narrower != kinds:
            builtin_registry.lower(function, *narrower)(_checked(lower))
    cast = builtins.cast_int._defn  # of int(x)

    def cast_checked(typing: Any, x: Any) -> Any:
        signature, lower = cast(typing, x)
        return signature, _checked(lower)

    builtins.cast_int = intrinsic(cast_checked)


def _checked(lower: Callable[..., Any]) -> Callable[..., Any]:
    """Lowering of a function with a test behind it.

    It raises an error for numbers that have no result.
    """
    from llvmlite.ir import Constant, DoubleType
    from numba import types
    from numba.cpython.mathimpl import is_finite, is_inf, is_nan

    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        result = lower(context, builder, signature, arguments)
        kind = signature.return_type
        can_raise = _RAISED in (each.name for each in builder.function.args)
        raises = can_raise and context.error_model.raise_on_fp_zero_division
        if not raises or not isinstance(kind, types.Float | types.Integer):
            return result
        floats = [each for each in arguments if each.type == DoubleType()]
        given = reduce(builder.fadd, floats, Constant(DoubleType(), 0.0))
        not_below = builder.fcmp_unordered(">=", given, Constant(DoubleType(), 2.0**63))
        is_wrong = builder.or_(
            not_below, builder.fcmp_ordered("<", given, Constant(DoubleType(), -(2.0**63)))
        )
        if isinstance(kind, types.Float):  # NaN of what is none, infinity of what is finite
            is_new = builder.and_(is_nan(builder, result), builder.not_(is_nan(builder, given)))
            is_large = builder.and_(is_inf(builder, result), is_finite(builder, given))
            is_wrong = builder.or_(is_new, is_large)
        with builder.if_then(is_wrong, likely=False):
            context.call_conv.return_user_exc(builder, ValueError, ("math domain error",))
        return result

    return lowered
