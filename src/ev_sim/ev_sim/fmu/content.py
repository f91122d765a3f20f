"""What an FMU carries with it: every parameter of every role, so that it hangs on no file of scenario or car."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.nodes.master.real_time import MasterParameters
from ev_msgs_py.contract.roles import MASTER
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
        said = {"name": self.run.name, "duration": self.run.duration, "law": self.law, "without": [*self.without]}
        return json.dumps({**said, "versions": versions(), "roles": roles}, indent=1)


def versions() -> dict[str, str]:
    """Of what has to be there where it is run."""
    return {name: version(name) for name in NEEDED}


def read_content(folder: Path) -> Content:
    """What the file in a folder says; RuntimeError if this machine has other versions than it was made with."""
    said: Mapping[str, Any] = json.loads((folder / FILE).read_text(encoding="utf-8"))
    here = versions()
    others = [f"{name} {made}, here {here[name]}" for name, made in said["versions"].items() if here[name] != made]
    if others:
        raise RuntimeError(f"this FMU was made with {'; '.join(others)}: its numbers would not be the same")
    configurations: dict[str, Configuration] = {}
    for role, values in said["roles"].items():
        configurations[role] = configure(role, values, MasterParameters if role == MASTER else None)
    run = Run(said["name"], "", configurations, said["duration"])
    return Content(run, said["law"], said["without"])
