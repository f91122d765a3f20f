"""Methods by name, or by the path of code or of a recording.

`asr=my_law.py`, `asr=my_law.py:NAME`.
"""

from __future__ import annotations

import hashlib
import sys
import traceback
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from ev_core.methods.former_names import chosen_by
from ev_core.methods.method_record import RECORDINGS, Method
from ev_core.methods.playback import playback_method
from ev_core.methods.register import (
    load_installed_methods,
    methods_of,
    registered_by,
)
from ev_core.native.method import library_method
from ev_core.parameters.data_file import TEXT, TextOfFile, find_file, read_data, tell
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name

LIBRARIES = (".so", ".dylib")  # suffixes of shared libraries
LAW_FILE = ".py"  # suffix of files with laws, which may be followed by :NAME
_registered: dict[tuple[Path, bytes], dict[str, dict[str, Method]]] = {}  # by file and its text


def method_of_file(role: str, name: str) -> Method:
    """The method of a role in a file.

    ParameterError, in one line, if there is none, or if the file cannot be run. A file is run once
    for each text that it has.
    """
    label = f"{role} method {name}"
    file, _, chosen = name.partition(f"{LAW_FILE}:")
    path = find_file(file.removesuffix(LAW_FILE) + LAW_FILE).absolute()
    try:
        text = read_data(path, TEXT)
    except OSError as error:
        raise ParameterError(f"{label}: {error.strerror}", "method") from None
    # Once for each text: a file that is edited while a program runs gives the law of its new text.
    if (path, text) not in _registered:
        _registered[path, text] = _run(label, path, text)
    methods = _registered[path, text].get(role, {})
    names = ", ".join(methods)
    if not methods:
        raise ParameterError(
            f'{label}: the file has no law of this node, marked @method("{role}", ...)', "method"
        )
    if not chosen and len(methods) > 1:
        raise ParameterError(
            f"{label}: the file has several laws: {names}; choose one by {path.name}:NAME", "method"
        )
    if chosen and chosen not in methods:
        raise ParameterError(
            f"{label}: the file has no law {quoted(chosen)}, expected one of {names}", "method"
        )
    return replace(methods[chosen or names], name=name)


def text_of(method: Method) -> str:
    """The digest of the text of the file that has given a method; empty for one of no law file."""
    factory = (method.declared or method).factory
    for (_, text), roles in _registered.items():
        for each in roles.get(method.role, {}).values():
            if each.factory is factory:
                return hashlib.sha256(text).hexdigest()
    return ""


def _run(label: str, path: Path, text: bytes) -> dict[str, dict[str, Method]]:
    """Methods that a file registers; it is run as a module of its own, named after its path."""
    name = f"{path.stem}_{hashlib.sha256(bytes(path)).hexdigest()[:8]}"
    spec: Any = spec_from_file_location(name, path)
    module = sys.modules[name] = module_from_spec(spec)
    try:
        return registered_by(name, lambda: exec(compile(text, path, "exec"), vars(module)))
    # A file of a user's may raise any error, and may call exit().
    except (Exception, SystemExit) as error:
        raise ParameterError(
            f"{label}: {_line_of(error, path)}{type(error).__name__}: {error}", "method"
        ) from error


def _line_of(error: BaseException, path: Path) -> str:
    """The line of a file in which an error was raised, or that is no Python.

    Empty if it is in no line of the file.
    """
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return f"line {error.lineno}: "
    found = ""
    # The last frame of the file is the nearest to the mistake: others lie in what it calls.
    for frame in traceback.extract_tb(error.__traceback__):
        if frame.filename == str(path):
            found = f"line {frame.lineno}: "
    return found


def is_code(name: str) -> bool:
    """Return whether the name of a method is the path of code.

    Code is a shared library or a file with laws.
    """
    return name.endswith((*LIBRARIES, LAW_FILE)) or f"{LAW_FILE}:" in name


def find_method(role: str, name: str) -> Method:
    """The method of a role with this name, or in the library, law file or recording of this path.

    ParameterError if there is none.
    """
    # A scenario of others' must not run code: only the command line names it.
    if isinstance(name, str) and is_code(name) and isinstance(name, TextOfFile):
        raise ParameterError(
            f"{name.file}: parameter method: {quoted(str(name))} is refused, "
            f"expected from a file a name: {', '.join(methods_of(role))}; "
            "code is named on the command line: "
            f"--method {role}=PATH, for a node -p method:=PATH"
        )
    if isinstance(name, str) and name.endswith(LIBRARIES):
        found = library_method(role, name)
        tell(find_file(name))
        return found
    if isinstance(name, str) and is_code(name):
        return method_of_file(role, name)
    if isinstance(name, str) and name.endswith(RECORDINGS):
        found = playback_method(role, name)
        tell(name)
        return found
    known = methods_of(role)
    name = chosen_by(role, name).get("method", name)
    if not isinstance(name, str) or name not in known:
        failed = "".join(f"; not loaded: {line}" for line in load_installed_methods(role))
        raise ParameterError(f"{unknown_name(f'{role} method', name, known)}{failed}")
    return known[name]
