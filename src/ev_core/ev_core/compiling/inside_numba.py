"""All that touches the inside of numba: each touch stands beside the plain public way, and can be switched off.

A touch makes compiled code faster to make, to load or to run; without it the same text gives the same bits.
EV_STACK_PLAIN_NUMBA names touches that shall not be used, separated by commas, or is `all`. A touch is not used either
where the installed numba lacks its private names: one line says so (docs/compiled_laws.md, tools/newest_numba.py).

numba is imported where it is used: loading it takes longer than a node takes to start.
"""

from __future__ import annotations

import builtins
import importlib.util
import os
import pickle
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from importlib.machinery import PathFinder
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from ev_core.compiling.object_symbols import calls
from ev_core.parameters.record import working_memory
from ev_msgs_py.compilable import INLINED
from ev_msgs_py.refusal import ParameterError, quoted

VARIABLE = "EV_STACK_PLAIN_NUMBA"
# By touch the names of numba that it needs, as far as they can be looked for.
TOUCHES = {
    "callees": "core.codegen:JITCodeLibrary._finalize_dynamic_globals core.codegen:JITCPUCodegen.create_library "
    "core.codegen:JITCodeLibrary._verify_declare_only_symbols core.codegen:JITCPUCodegen._module_pass_manager "
    "core.codegen:JITCPUCodegen.set_env core.compiler_lock:global_compiler_lock",
    "stack": "extending:lower_builtin core.cgutils:alloca_once np.arrayobj:make_array np.arrayobj:populate_array",
    "edits": "core.typing.context:BaseContext.refresh core.typing.context:BaseContext.resolve_value_type",
    "overloads": "core.caching:NullCache core.compiler:CompileResult._rebuild core.compiler:CompileResult._reduce "
    "core.serialize:dumps core.codegen:CodeLibrary.has_dynamic_globals core.dispatcher:Dispatcher.compile",
    "object_code": "core.codegen:CodeLibrary._get_compiled_object core.codegen:CodeLibrary.has_dynamic_globals",
    "options": "",
}


@cache
def switched_off() -> frozenset[str]:
    """The touches that EV_STACK_PLAIN_NUMBA names; ParameterError if one of them is none."""
    named = frozenset(os.environ.get(VARIABLE, "").replace(",", " ").split())
    for name in sorted(named - {*TOUCHES, "all"}):
        allowed = ", ".join(TOUCHES)
        raise ParameterError(f"{VARIABLE}: {quoted(name)} is refused, allowed is all, or some of {allowed}")
    return frozenset(TOUCHES) if "all" in named else named


@cache
def is_used(touch: str) -> bool:
    """Whether a touch is used: it is not switched off, and the installed numba has what it needs."""
    if touch in switched_off():
        return False
    try:
        for name in TOUCHES[touch].split():
            resolve_name(f"numba.{name}")
    except (ImportError, AttributeError) as error:
        print(f"numba is another one, so {touch} goes the plain way, which is slower: {error}", file=sys.stderr)
        return False
    return True


# callees: functions that only compiled functions call become machine code within their callers alone. numba makes each
# of them machine code of its own as well, for callers in Python, which takes a third of the whole time, and optimises
# what is inlined again at every level. Plain: it does.


@contextmanager
def only_machine_code_of(name: str) -> Iterator[None]:
    """What is compiled within becomes machine code if its function has this name, else nobody can call it in Python."""
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


def _libraries() -> tuple[type, type]:
    """What numba puts the code of a callee into, and that of one that is inlined."""
    from numba.core.codegen import JITCodeLibrary

    class Callee(JITCodeLibrary):
        """Optimised roughly, for what it is linked into is optimised wholly, and complete as that takes it."""

        def _optimize_final_module(self) -> None:
            manager, builder = self._codegen._module_pass_manager(slp_vectorize=False, cost="cheap")
            manager.run(self._final_module, builder)

        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._verify_declare_only_symbols()
            self._finalized = True

    class Inlined(Callee):
        """Left as it is: the library that includes it optimises it there."""

        def _optimize_final_module(self) -> None:
            pass

    return Callee, Inlined


# stack: working memory lies on the stack. Plain: numba takes it from its heap at each step.


@cache
def make_memory_known() -> None:
    """Tell numba of `working_memory`."""
    from numba.extending import lower_builtin, register_jitable, type_callable

    if not is_used("stack"):
        register_jitable(working_memory)
        return
    from numba import types
    from numba.core import cgutils
    from numba.np.arrayobj import make_array, populate_array

    @type_callable(working_memory)
    def _type(context: Any) -> Any:
        return lambda layout: types.Array(layout.dtype, 1, "C") if isinstance(layout, types.DType) else None

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


# edits: numba forgets what it has made of functions that have changed since. Plain: a new process is asked for.


def forget_made_of(functions: Sequence[Callable[..., Any]]) -> None:
    """Let numba make these functions anew; ParameterError if it is not to be asked for that."""
    if not is_used("edits"):
        raise ParameterError(f"a compiled function has changed, which needs a new process without edits in {VARIABLE}")
    from numba.core.registry import cpu_target

    typing: Any = cpu_target.typing_context
    typing.refresh()
    for known in functions:
        for template in typing.resolve_value_type(known).templates:
            template._impl_cache.clear()


# overloads: what numba makes of functions that Python calls is kept in files of ours. Plain: each process makes it.


def keep_overloads(
    function: Any,
    ready: Callable[[], None],
    alone: Callable[[], AbstractContextManager[None]],
    read: Callable[[str], bytes | None],
    write: Callable[[str, bytes], None],
) -> None:
    """Let numba, once `ready`, `read` what it has made of a function for types, given as a text, and `write` it.

    It does so within `alone`, so that of several processes one compiles; addresses of this process are not written.
    """
    if not is_used("overloads"):
        return
    from numba.core.caching import NullCache
    from numba.core.compiler import CompileResult
    from numba.core.serialize import dumps

    class Kept(NullCache):
        def load_overload(self, signature: Sequence[Any], target: Any) -> Any:
            ready()
            target.refresh()
            kept = read(repr(_with_names(signature)))
            return None if kept is None else CompileResult._rebuild(target, *pickle.loads(kept))

        def save_overload(self, signature: Sequence[Any], made: Any) -> None:
            if not made.library.has_dynamic_globals:
                write(repr(_with_names(signature)), dumps(made._reduce()))

    def compiled(signature: Any) -> Any:
        with alone():
            return type(function).compile(function, signature)

    function._cache, function.compile = Kept(), compiled


def _with_names(kinds: Sequence[Any]) -> list[Any]:
    """Types with the names of what they hold, which numba does not show of a named tuple."""
    return [(kind, getattr(kind, "fields", ()), _with_names(getattr(kind, "types", ()))) for kind in kinds]


# object_code: machine code is taken out of numba, and loaded without it by llvmlite. Plain: each process compiles.

# Modules of numba with what compiled code may call, and how their functions are named there.
_HELPERS = {"numba._helperlib": "numba_", "numba.core.runtime._nrt_python": "NRT_"}

_engines: list[Any] = []  # what they have loaded lasts as long as they do


def object_code(function: Any) -> tuple[str, bytes] | None:
    """The name of a C function (`cfunc`) and its object file; None if that holds addresses of this process."""
    if not is_used("object_code") or function._library.has_dynamic_globals:
        return None
    return function.native_name, function._library._get_compiled_object()


def loaded(symbol: str, code: bytes) -> int:
    """The address of a function of an object file; 0 if its code calls what is not there."""
    if "object_code" in switched_off():
        return 0
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    try:
        _name_helpers(binding)  # before an engine makes other things known by the names of exceptions
    except (ImportError, AttributeError):  # of another numba
        return 0
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    found = binding.ObjectFileRef.from_data(code)
    called = calls(code)
    if any(name.startswith("NRT_") and "alloc" in name for name in called):
        from numba.core.registry import cpu_target
        from numba.core.runtime.nrt import rtsys

        rtsys.initialize(cpu_target.target_context)  # the heap of numba, for which such code has to wait
    if not all(map(binding.address_of_symbol, called)):
        return 0
    engine.add_object_file(found)
    engine.finalize_object()
    _engines.append(engine)
    address: int = engine.get_function_address(symbol)
    return address


def _name_helpers(binding: Any) -> None:
    """Tell what code may call besides the C library, as numba itself does when it has compiled something."""
    package: Any = importlib.util.find_spec("numba")
    numba = Path(package.submodule_search_locations[0])
    helpers = {f"PyExc_{name}": id(value) for name, value in vars(builtins).items() if isinstance(value, type)}
    for place, prefix in _HELPERS.items():
        folder, _, name = place.rpartition(".")
        module: Any = sys.modules.get(place)
        if module is None:
            spec: Any = PathFinder.find_spec(name, [str(numba.joinpath(*folder.split(".")[1:]))])
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
        for helper, address in module.c_helpers.items():
            helpers[helper[1:] if helper.startswith("_") else prefix + helper] = address
    for name, address in helpers.items():
        if not binding.address_of_symbol(name):
            binding.add_symbol(name, address)


# options: what numba knows of what it has made, and no text shows. Plain: it is another one in each process, so that
# nothing that reaches it is taken from disk.

_OPTIONS = ("targetoptions", "_sig", "types")  # of a function: njit, cfunc, vectorize


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
