"""Machine code that the compiler has made once, kept on disk and loaded without the compiler.

Loading numba takes longer than a node takes to start. What it makes are object files all the same, and llvmlite, the
part of it that knows processors, loads them within milliseconds.
"""

from __future__ import annotations

import builtins
import hashlib
import importlib.util
import os
import struct
import sys
from functools import cache
from importlib.machinery import PathFinder
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.user_cache import cache_folder, read_checked, write_checked

_SETTINGS = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NUMBA_OPT")  # of the compiler, which change what it makes
# Modules of numba with what compiled code may call, and how their functions are named there.
_HELPERS = {"numba._helperlib": "numba_", "numba.core.runtime._nrt_python": "NRT_"}
_SYMBOL = struct.Struct("<IBBHQQ")  # of an ELF file: name, kind, visibility, section, value, size
_KEPT_TEXTS = 8  # of one name: those of other checkouts, of branches and of tests come back
_MAKERS = ("numba", "llvmlite", "numpy")
# Modules that tell the compiler what no text shows: its options, and what it makes of functions of ours.
_TELLING = ("inside_numba", "library")
_DIGITS = 12
_CODE = "code"

_engines: list[Any] = []  # what they have loaded lasts as long as they do
_reaches: dict[Any, Reach] = {}
_addresses: dict[str, int] = {}


def reach_of(text: str, names: dict[str, Any]) -> Reach:
    """Everything that the compiled form of a text depends on; looked for anew only where something has changed."""
    of = (text, *names, *names.values())
    if of not in _reaches or not _reaches[of].holds:
        _reaches[of] = Reach(*of)
    return _reaches[of]


def key_of(name: str, text: str, names: dict[str, Any]) -> str:
    """The name, and digits that change with everything that the compiled form of a text depends on."""
    return f"{name}_{reach_of(text, names).digits[:_DIGITS]}"


def kept_file(key: str, what: str) -> Path:
    """The file in which something made of a text is kept, for this processor and this compiler."""
    return cache_folder() / f"{key}.{_machine()}.{what}"


@cache
def _machine() -> str:
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    settings = [os.environ.get(name, "") for name in _SETTINGS]
    known = (binding.get_host_cpu_name(), features, *settings, sys.version, *map(version, _MAKERS))
    digest = hashlib.sha256("\0".join(known).encode())
    for name in _TELLING:
        digest.update(Path(__file__).with_name(f"{name}.py").read_bytes())
    return digest.hexdigest()[:_DIGITS]


def keep(key: str, symbol: str, code: bytes) -> None:
    """Keep an object file and the name of its function."""
    write_checked(kept_file(key, _CODE), symbol.encode() + b"\n" + code)
    forget_older(key)


def is_kept(name: str, text: str, names: dict[str, Any]) -> bool:
    """Whether the machine code of a text is on disk, so that nobody has to wait for the compiler."""
    return read_checked(kept_file(key_of(name, text, names), _CODE)) is not None


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
    kept = read_checked(kept_file(key, _CODE))
    if kept is None:
        return 0
    from llvmlite import binding

    symbol, _, code = kept.partition(b"\n")
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
    address: int = engine.get_function_address(symbol.decode())
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


def forget_older(key: str) -> None:
    """Delete what older texts of the same name were compiled to, but for those that were compiled last."""
    folder, name = cache_folder(), key.rpartition("_")[0]
    newest = sorted(folder.glob(f"{name}_{'[0-9a-f]' * _DIGITS}.*"), key=age)
    texts = list(dict.fromkeys(file.name.partition(".")[0] for file in newest))
    for file in newest:
        if file.name.partition(".")[0] in texts[_KEPT_TEXTS:]:
            file.unlink(missing_ok=True)


def age(file: Path) -> float:
    """Rises with the time since a file or folder was written; 0 if it has gone."""
    try:
        return -file.stat().st_mtime
    except FileNotFoundError:  # another process has deleted it
        return 0.0
