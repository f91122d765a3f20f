"""Writes an FMU: PythonFMU's builder, a module of three lines and the content.

The content is every parameter of every role, so that an FMU hangs on no file of scenario or car.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.nodes.master.real_time import MasterParameters
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.interface import extra
from ev_sim.recording.recording import atomic_file
from ev_sim.running.output_folder import OutputFolder
from ev_sim.scenarios.scenario import Run

FILE = "content.json"
NEEDED = ("ev_sim", "ev_control", "ev_core", "ev_msgs_py", "numba", "llvmlite")  # what decides the bits


@dataclass(frozen=True)
class Content:
    """A run, and what of it the FMU is: the `law` of one role, or all but the roles in `without`."""

    run: Run
    law: str = ""
    without: Sequence[str] = ()

    def as_json(self) -> str:
        """All of it, and the versions that it was made with."""
        roles = {role: configuration.values() for role, configuration in self.run.configurations.items()}
        content = {"name": self.run.name, "duration": self.run.duration, "law": self.law, "without": [*self.without]}
        return json.dumps({**content, "versions": versions(), "roles": roles}, indent=1)


def versions() -> dict[str, str]:
    """The versions of what has to be installed where the FMU is run."""
    return {name: version(name) for name in NEEDED}


def read_content(folder: Path) -> Content:
    """What the file in a folder holds; RuntimeError if this machine has other versions than it was made with."""
    content: Mapping[str, Any] = json.loads((folder / FILE).read_text(encoding="utf-8"))
    here = versions()
    others = [f"{name} {made}, here {here[name]}" for name, made in content["versions"].items() if here[name] != made]
    if others:
        raise RuntimeError(f"this FMU was made with {'; '.join(others)}: its numbers would not be the same")
    configurations: dict[str, Configuration] = {}
    for role, values in content["roles"].items():
        configurations[role] = configure(role, values, MasterParameters if role == MASTER else None)
    run = Run(content["name"], "", configurations, content["duration"])
    return Content(run, content["law"], content["without"])


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
