"""Writes an FMU: PythonFMU's builder, a module of three lines and the content."""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.fmu.content import FILE, Content
from ev_sim.interface.extras import extra
from ev_sim.recording.atomic import atomic_file
from ev_sim.running.output_folder import OutputFolder

_MODULE = '''"""An FMU of ev_sim; all about it is in {file}."""

from ev_sim.fmu.slave import Slave


class {name}(Slave):
    """The model."""
'''


def write_fmu(content: Content, file: Path) -> None:
    """Write an FMU (FMI 2.0, co-simulation) whose model is named after the file, in the place of one of ours at most.

    ParameterError, in one line, for another name, unknown roles, a file of others there, and a law or a car that cannot
    be stepped on its own; ImportError, in one line, without PythonFMU.
    """
    builder = extra("pythonfmu", "fmu").FmuBuilder
    if file.suffix != ".fmu" or not re.fullmatch(r"[A-Za-z]\w*", file.stem):
        raise ParameterError(f"{file} is refused, allowed is NAME.fmu, where NAME is one of a variable in C")
    for role in (*content.without, *([content.law] if content.law else ())):
        if role not in content.run.configurations:
            raise unknown_name("role", role, content.run.configurations)
    known, path = set(sys.modules), list(sys.path)
    with OutputFolder(file.parent, f"fmu {file.name}", [file.name]), tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        module = folder / f"{file.stem}.py"
        module.write_text(_MODULE.format(file=FILE, name=file.stem), encoding="utf-8")
        (folder / FILE).write_text(content.as_json(), encoding="utf-8")
        try:
            built = builder.build_FMU(module, folder / file.name, project_files=[folder / FILE])
        finally:
            sys.path[:] = path  # where the builder puts our folder
            if file.stem not in known:
                sys.modules.pop(file.stem, None)
        with atomic_file(file) as written:
            written.write(built.read_bytes())
