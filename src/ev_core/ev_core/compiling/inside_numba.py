"""Touches of numba's inside: each has a plain public way as well, and can be switched off.

A touch makes compiled code faster to make, to load or to run; without it the same text gives the
same bits. EV_STACK_PLAIN_NUMBA names touches that shall not be used, separated by commas, or is
`all`. A touch is not used either where the installed numba lacks its private names: one line says
so (docs/compiled_laws.md, tools/newest_numba.py). Those of code on disk, `overloads` and
`object_code`, are in `inside_numba_code`, `checks` in `inside_numba_checks`.

numba is imported where it is used: loading it takes longer than a node takes to start.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pkgutil import resolve_name
from typing import Any

from ev_core.parameters.record import working_memory
from ev_msgs_py.compilable import INLINED
from ev_msgs_py.refusal import ParameterError, quoted

VARIABLE = "EV_STACK_PLAIN_NUMBA"
# By touch the names of numba that it needs, as far as they can be looked for.
TOUCHES = {
    "callees": "core.codegen:JITCodeLibrary._finalize_dynamic_globals "
    "core.codegen:JITCPUCodegen.create_library "
    "core.codegen:JITCodeLibrary._verify_declare_only_symbols "
    "core.codegen:JITCPUCodegen._module_pass_manager "
    "core.codegen:JITCPUCodegen.set_env core.compiler_lock:global_compiler_lock",
    "stack": "extending:lower_builtin core.cgutils:alloca_once np.arrayobj:make_array "
    "np.arrayobj:populate_array",
    "edits": "core.typing.context:BaseContext.refresh "
    "core.typing.context:BaseContext.resolve_value_type",
    "overloads": "core.caching:NullCache core.compiler:CompileResult._rebuild "
    "core.compiler:CompileResult._reduce "
    "core.serialize:dumps core.codegen:CodeLibrary.has_dynamic_globals "
    "core.dispatcher:Dispatcher.compile",
    "object_code": "core.codegen:CodeLibrary._get_compiled_object "
    "core.codegen:CodeLibrary.has_dynamic_globals",
    "options": "",
    "checks": "core.cpu:CPUTargetOptions.finalize core.targetconfig:ConfigStack.top_or_none "
    "cpython.mathimpl:registry core.imputils:builtin_registry cpython.builtins:cast_int",
}
_OPTIONS = ("targetoptions", "_sig", "types")  # of a function: njit, cfunc, vectorize


@cache
def switched_off() -> frozenset[str]:
    """The touches that EV_STACK_PLAIN_NUMBA names; ParameterError if one of them is none."""
    named = frozenset(os.environ.get(VARIABLE, "").replace(",", " ").split())
    for name in sorted(named - {*TOUCHES, "all"}):
        allowed = ", ".join(TOUCHES)
        raise ParameterError(
            f"{VARIABLE}: {quoted(name)} is refused, expected all, or some of {allowed}"
        )
    return frozenset(TOUCHES) if "all" in named else named


@cache
def is_used(touch: str) -> bool:
    """Return whether a touch is used.

    It is not switched off, and the installed numba has the names that it needs.
    """
    if touch in switched_off():
        return False
    try:
        for name in TOUCHES[touch].split():
            resolve_name(f"numba.{name}")
    except (ImportError, AttributeError) as error:
        print(
            f"numba is another one, so {touch} goes the plain way, which is slower: {error}",
            file=sys.stderr,
        )
        return False
    return True


# callees: functions that only compiled functions call become machine code within their callers
# alone. numba makes each of them machine code of its own as well, for callers in Python, which
# takes a third of the whole time, and optimises what is inlined again at every level. Plain: it
# does.


@contextmanager
def only_machine_code_of(name: str, made: Sequence[Any]) -> Iterator[None]:
    """Make machine code in this block only of the function with this name.

    Python cannot call the others. Objects that numba has `made` of functions of others, which
    Python may call, are made again before and behind it.
    """
    make_anew(made)
    if not is_used("callees"):
        yield
        return
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.registry import cpu_target

    codegen: Any = cpu_target.target_context.codegen()
    engine, create_library, set_env = codegen._engine, codegen.create_library, codegen.set_env
    inlined = {function.__qualname__ for function in INLINED}
    as_callee, as_inlined = _libraries()

    def library_of(function: str, **options: Any) -> Any:
        if function == name:
            return create_library(function, **options)
        return (as_inlined if function in inlined else as_callee)(codegen, function, **options)

    def set_environment(symbol: str, environment: Any) -> None:
        if engine.is_symbol_defined(symbol):  # of machine code
            set_env(symbol, environment)

    with global_compiler_lock:
        codegen.create_library, codegen.set_env = library_of, set_environment
        try:
            yield
        finally:
            del codegen.create_library, codegen.set_env
            make_anew(made)


def _libraries() -> tuple[type, type]:
    """Classes of numba's libraries for callees, and for inlined functions."""
    from numba.core.codegen import JITCodeLibrary

    class Callee(JITCodeLibrary):
        """A library that is optimised roughly, for that of its caller is optimised wholly.

        It can be linked.
        """

        def _optimize_final_module(self) -> None:
            manager, builder = self._codegen._module_pass_manager(slp_vectorize=False, cost="cheap")
            manager.run(self._final_module, builder)

        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._verify_declare_only_symbols()
            self._finalized = True

    class Inlined(Callee):
        """A library that is not optimised: the library that includes it does that."""

        def _optimize_final_module(self) -> None:
            pass

    return Callee, Inlined


# stack: working memory lies on the stack. Plain: numba takes it from its heap at each step.


@cache
def make_memory_known() -> None:
    """Let numba know `working_memory`."""
    from numba.extending import lower_builtin, register_jitable, type_callable

    if not is_used("stack"):
        register_jitable(working_memory)
        return
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array, populate_array

    @type_callable(working_memory)
    def _type(context: Any) -> Any:
        return lambda layout: (
            types.Array(layout.dtype, 1, "C") if isinstance(layout, types.DType) else None
        )

    @lower_builtin(working_memory, types.DType)
    def _lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = signature.return_type
        size = context.get_constant(types.intp, kind.dtype.size)
        data = cgutils.alloca_once(builder, context.get_data_type(kind.dtype))
        data.align = 64
        cgutils.memset(builder, data, size, 0)
        array = make_array(kind)(context, builder)
        one = context.get_constant(types.intp, 1)
        populate_array(array, data=data, shape=[one], strides=[size], itemsize=size, meminfo=None)
        return array._getvalue()


# No touch, for numba offers it: a choice, an enum, is compared with a parameter, a float.


@cache
def make_choices_known() -> None:
    """Let numba turn a member of an `IntEnum` into a float, as Python does."""
    from numba import types
    from numba.extending import lower_cast

    @lower_cast(types.IntEnumMember, types.Float)
    def _as_float(context: Any, builder: Any, kind: Any, to: Any, value: Any) -> Any:
        return context.cast(builder, value, kind.dtype, to)


# edits: numba forgets what it has made of functions that have changed since. Plain: a new process
# is asked for.


def forget_made_of(functions: Sequence[Callable[..., Any]]) -> None:
    """Let numba make these functions again; ParameterError if this touch is switched off."""
    if not is_used("edits"):
        raise ParameterError(
            "a compiled function has changed, which needs a new process without edits in "
            f"{VARIABLE}"
        )
    from numba.core.registry import cpu_target

    typing: Any = cpu_target.typing_context
    typing.refresh()
    for known in functions:
        for template in typing.resolve_value_type(known).templates:
            template._impl_cache.clear()


_replaced: list[Any] = []  # machine code of C functions, since others may hold their addresses


def make_anew(made: Iterable[Any]) -> None:
    """Let numba compile functions of others again, callees first.

    They are made by njit, cfunc or vectorize, or are methods of a jitclass.

    The numbers that these take from their modules were those of another time, and their indices
    were not checked. Code in numba's own files on disk is not taken either, for the same reasons.
    """
    config: Any = import_module("numba").config
    before, config.BOUNDSCHECK = config.BOUNDSCHECK, 1
    try:
        for each in made:
            if hasattr(each, "recompile"):
                each.recompile()
            elif hasattr(each, "native_name"):
                _replaced.append(each._library)
                each._cache.flush()
                each.compile()
            elif hasattr(each, "_dispatcher"):
                of = each._dispatcher
                kinds = [*of.overloads]
                _replaced.append(of.overloads.copy())
                of.overloads.clear()
                of.cache.flush()
                for kind in kinds:
                    of.compile(kind)
    finally:
        config.BOUNDSCHECK = before


# options: what numba knows of what it has made, and no text shows. Plain: it is another one in each
# process, so that nothing that reaches it is taken from disk.


def options_of(found: Any) -> tuple[Any, ...]:
    """The options and types of a function; of a jitclass its fields, methods and properties."""
    is_made = type(found).__module__.partition(".")[0] == "numba"
    if is_made and "options" in switched_off():
        return (id(found),)
    of = getattr(found, "class_type", None)
    if of is None:
        return tuple(str(getattr(found, name, "")) for name in _OPTIONS)
    methods = (of.jit_methods, of.jit_static_methods, *of.jit_props.values())
    return str(of.struct), tuple(of.jit_props), *(tuple(each.items()) for each in methods)
