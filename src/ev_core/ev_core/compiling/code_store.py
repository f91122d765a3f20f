"""The store of machine code on disk: names of files, and their content.

How it works: a file is named after everything that its content depends on. The key of a text is its
name and digits of all that the text reaches (`fingerprint`). The rest of the file's name stands for
processor, compiler and settings. So a file is right as long as its name is found; edited texts,
other processors and other compilers have files of their own, and the oldest of one name are
deleted.
"""

from __future__ import annotations

import hashlib
import os
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ev_core.compiling import inside_numba
from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.user_cache import cache_folder, read_checked, write_checked

DIGITS = 12
_CODE = "code"
_KEPT_TEXTS = 8  # of one name: those of other checkouts, of branches and of tests come back
_MAKERS = ("numba", "llvmlite", "numpy")
# Settings of the compiler that change its code.
_SETTINGS = (
    "NUMBA_CPU_NAME",
    "NUMBA_CPU_FEATURES",
    "NUMBA_OPT",
    "NUMBA_BOUNDSCHECK",
    inside_numba.VARIABLE,
)
# Modules that give the compiler its options, and treat our functions: no text of a function shows
# these.
_INVISIBLE = ("inside_numba", "inside_numba_checks", "inside_numba_code", "machine_code")

_reaches: dict[Any, Reach] = {}


def reach_of(text: str, names: dict[str, Any]) -> Reach:
    """All that the compiled form of a text depends on.

    It is followed again only where it has changed.
    """
    of = (text, *names, *names.values())
    if of not in _reaches or not _reaches[of].holds:
        _reaches[of] = Reach(*of)
    return _reaches[of]


def key_of(name: str, text: str, names: dict[str, Any]) -> str:
    """The name, and digits of everything that the compiled form of a text depends on."""
    return f"{name}_{reach_of(text, names).digits[:DIGITS]}"


def kept_file(key: str, what: str) -> Path:
    """The file for a product of a text, named `what`, by this compiler for this processor."""
    return cache_folder() / f"{key}.{_machine()}.{what}"


@cache
def _machine() -> str:
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    settings = [os.environ.get(name, "") for name in _SETTINGS]
    known = (binding.get_host_cpu_name(), features, *settings, sys.version, *map(version, _MAKERS))
    digest = hashlib.sha256("\0".join(known).encode())
    for name in _INVISIBLE:
        digest.update(Path(__file__).with_name(f"{name}.py").read_bytes())
    return digest.hexdigest()[:DIGITS]


def keep(key: str, symbol: str, code: bytes) -> None:
    """Keep an object file and the name of its function."""
    write_checked(kept_file(key, _CODE), symbol.encode() + b"\n" + code)
    forget_older(key)


def kept_code(key: str) -> tuple[str, bytes] | None:
    """The name of the function and its object file, as `keep` was given them.

    None if nothing is kept.
    """
    kept = read_checked(kept_file(key, _CODE))
    if kept is None:
        return None
    symbol, _, code = kept.partition(b"\n")
    return symbol.decode(), code


def can_be_kept() -> bool:
    """Return whether machine code is kept at all (EV_STACK_PLAIN_NUMBA)."""
    return "object_code" not in inside_numba.switched_off()


def forget_older(key: str) -> None:
    """Delete the files of older texts of the same name, except those that were compiled last."""
    folder, name = cache_folder(), key.rpartition("_")[0]
    newest = sorted(folder.glob(f"{name}_{'[0-9a-f]' * DIGITS}.*"), key=_age)
    texts = list(dict.fromkeys(file.name.partition(".")[0] for file in newest))
    for file in newest:
        if file.name.partition(".")[0] in texts[_KEPT_TEXTS:]:
            file.unlink(missing_ok=True)


def _age(file: Path) -> float:
    """A number that rises with the time since a file or folder was written; 0 if it has gone."""
    try:
        return -file.stat().st_mtime
    except FileNotFoundError:  # another process has deleted it
        return 0.0
