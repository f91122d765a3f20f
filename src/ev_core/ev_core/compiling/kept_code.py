"""What the compiler has made, in files named by everything that it depends on: text, reach, processor, compiler."""

from __future__ import annotations

import hashlib
import os
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.user_cache import cache_folder, read_checked, write_checked

_SETTINGS = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NUMBA_OPT")  # of the compiler, which change what it makes
_KEPT_TEXTS = 8  # of one name: those of other checkouts, of branches and of tests come back
_MAKERS = ("numba", "llvmlite", "numpy")
# Modules that tell the compiler what no text shows: its options, and what it makes of functions of ours.
_TELLING = ("inside_numba", "library")
_DIGITS = 12
_CODE = "code"

_reaches: dict[Any, Reach] = {}


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


def kept_code(key: str) -> tuple[str, bytes] | None:
    """The name of the function and its object file, as `keep` was given them; None if nothing is kept."""
    kept = read_checked(kept_file(key, _CODE))
    if kept is None:
        return None
    symbol, _, code = kept.partition(b"\n")
    return symbol.decode(), code


def is_kept(name: str, text: str, names: dict[str, Any]) -> bool:
    """Whether the machine code of a text is on disk, so that nobody has to wait for the compiler."""
    return kept_code(key_of(name, text, names)) is not None


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
