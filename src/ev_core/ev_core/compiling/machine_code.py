"""Machine code that the compiler has made once, loaded without the compiler.

Loading numba takes longer than a node takes to start. What it makes are object files all the same, and llvmlite, the
part of it that knows processors, loads them within milliseconds.
"""

from __future__ import annotations

import builtins
import importlib.util
import struct
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from ev_core.compiling.kept_code import kept_code, key_of

# Modules of numba with what compiled code may call, and how their functions are named there.
_HELPERS = {"numba._helperlib": "numba_", "numba.core.runtime._nrt_python": "NRT_"}
_SYMBOL = struct.Struct("<IBBHQQ")  # of an ELF file: name, kind, visibility, section, value, size

_engines: list[Any] = []  # what they have loaded lasts as long as they do
_addresses: dict[str, int] = {}


def function_address(name: str, text: str, names: dict[str, Any]) -> int:
    """The address of the C function `step` of a text that uses these names: loaded from disk, or compiled first."""
    key = key_of(name, text, names)
    if key not in _addresses:
        _addresses[key] = _loaded(key) or _compiled(key, text, names)
    return _addresses[key]


def _compiled(key: str, text: str, names: dict[str, Any]) -> int:
    from ev_core.compiling.library import compiled_address

    return compiled_address(key, text, names)


def _loaded(key: str) -> int:
    """The address of the function of a text; 0 if it was not kept, or if its code calls what is not there."""
    kept = kept_code(key)
    if kept is None:
        return 0
    from llvmlite import binding

    symbol, code = kept
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    _name_helpers(binding)  # before an engine makes other things known by the names of exceptions
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    found = binding.ObjectFileRef.from_data(code)
    called = calls(found)
    if any(name.startswith("NRT_") and "alloc" in name for name in called):
        _start_heap()
    if not all(map(binding.address_of_symbol, called)):
        return 0
    engine.add_object_file(found)
    engine.finalize_object()
    _engines.append(engine)
    address: int = engine.get_function_address(symbol)
    return address


def calls(found: Any) -> list[str]:
    """The names in an object file (ELF) that others have to define."""
    sections = {section.name(): section.data() for section in found.sections()}
    names = sections[b".strtab"]
    entries = list(_SYMBOL.iter_unpack(sections[b".symtab"]))[1:]  # the first one is none
    return [names[at : names.index(b"\0", at)].decode() for at, _, _, section, _, _ in entries if section == 0]


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


def _start_heap() -> None:
    """Make that of numba ready, from which some code takes memory: such code has to wait for numba to load."""
    from numba.core.registry import cpu_target
    from numba.core.runtime.nrt import rtsys

    heap: Any = rtsys
    heap.initialize(cpu_target.target_context)
