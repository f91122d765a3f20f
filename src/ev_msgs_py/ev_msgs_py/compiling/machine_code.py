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
import tempfile
from functools import cache
from importlib.machinery import PathFinder
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ev_msgs_py.compiling.fingerprint import fingerprint

_SETTINGS = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NUMBA_OPT")  # of the compiler, which change what it makes
# Modules of numba with what compiled code may call, and how their functions are named there.
_HELPERS = {"numba._helperlib": "numba_", "numba.core.runtime._nrt_python": "NRT_"}
_SYMBOL = struct.Struct("<IBBHQQ")  # of an ELF file: name, kind, visibility, section, value, size
_KEPT_TEXTS = 4  # of one name: those of other branches and of tests come back

_engines: list[Any] = []  # what they have loaded lasts as long as they do


@cache
def cache_folder() -> Path:
    """Where compiled code is kept: where EV_STACK_CACHE says, beside the package, or where the user may write."""
    beside = Path(__file__).parents[1] / "__pycache__" / "compiled"
    own = Path(tempfile.gettempdir()) / f"ev_stack-{os.getuid()}" / "compiled"
    for folder in (Path(os.environ.get("EV_STACK_CACHE") or beside), beside, own):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return Path(tempfile.mkdtemp(prefix="ev_stack-"))


def text_file(name: str, text: str, names: dict[str, Any]) -> Path:
    """The file of a text to be compiled, named after everything that its compiled form depends on."""
    return cache_folder() / f"{name}_{fingerprint(text, *names.values())[:12]}.py"


def code_file(text_file: Path) -> Path:
    """The file of the machine code of a text, for this processor and this compiler."""
    return text_file.with_suffix(f".{_machine()}.code")


@cache
def _machine() -> str:
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    settings = [os.environ.get(name, "") for name in _SETTINGS]
    known = (binding.get_host_cpu_name(), features, *settings, version("numba"), version("llvmlite"))
    return hashlib.sha256("\0".join(known).encode()).hexdigest()[:12]


def write_whole(file: Path, content: bytes) -> None:
    """Write a file that other processes see whole or not at all."""
    unfinished = file.with_name(f".{file.name}.{os.getpid()}")
    unfinished.write_bytes(content)
    unfinished.replace(file)


def keep(file: Path, symbol: str, code: bytes) -> None:
    """Keep an object file and the name of its function."""
    write_whole(file, symbol.encode() + b"\n" + code)


def function_address(name: str, text: str, names: dict[str, Any]) -> int:
    """The address of the C function `step` of a text that uses these names: loaded from disk, or compiled first."""
    file = code_file(text_file(name, text, names))
    address = load(file) if file.exists() else 0
    if address:
        return address
    from ev_msgs_py.compiling.library import compiled_address

    return compiled_address(name, text, names)


@cache
def load(file: Path) -> int:
    """The address of the function of a file that was kept; 0 if its code calls what is not there."""
    from llvmlite import binding

    symbol, _, code = file.read_bytes().partition(b"\n")
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    _name_helpers(binding)  # before an engine makes other things known by the names of exceptions
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    found = binding.ObjectFileRef.from_data(code)
    if not all(map(binding.address_of_symbol, calls(found))):
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


def forget_older(file: Path) -> None:
    """Delete what older texts of the same name were compiled to, but for the newest ones."""
    name = file.stem.rpartition("_")[0]
    digest = "[0-9a-f]" * 12
    texts = sorted(file.parent.glob(f"{name}_{digest}.py"), key=_age)
    for old in texts[_KEPT_TEXTS:]:
        for each in (*file.parent.glob(f"{old.stem}.*"), *file.parent.glob(f"*/{old.stem}.*")):
            each.unlink(missing_ok=True)


def _age(file: Path) -> float:
    try:
        return -file.stat().st_mtime
    except FileNotFoundError:  # another process has deleted it
        return 0.0
