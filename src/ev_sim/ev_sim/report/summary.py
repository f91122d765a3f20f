"""summary.json: what was run, with what, on what, and what came out."""

from __future__ import annotations

import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

from ev_core.parameters.declaration import flatten
from ev_core.vehicle.description import Vehicle
from ev_sim.measures.metric import Metric
from ev_sim.measures.samples import Parameters, Runs
from ev_sim.recording.files_of_run import atomic_file
from ev_sim.recording.recording import combined_hash, signal_hash
from ev_sim.scenarios.differences import Difference

PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "rclpy")


@dataclass(frozen=True)
class Summary:
    """Everything that summary.json says.

    `methods`: role -> method. `own_nodes`: role -> command of a user's node that took its place.
    `mode`: offline, in-process, processes or realtime, with what it was asked for.
    `wall_time` [s] is that of driving, without start, report and figures. `not_reproducible`: why another run may
    give other numbers, empty if it may not. `about` is the scenario in one line, `command` what repeats it, `differs`
    what is not as the scenario's file, or as the defaults have it. `timing`: run -> how well real time was kept.
    """

    scenario: str
    mode: str
    seed: int
    methods: Mapping[str, str]
    parameters: Parameters
    vehicle: Vehicle
    runs: Runs
    metrics: Mapping[str, Metric]
    wall_time: float
    not_reproducible: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    own_nodes: Mapping[str, str] = field(default_factory=dict)
    about: str = ""
    command: str = ""
    differs: Sequence[Difference] = ()
    timing: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def simulated_time(self) -> float:
        """Simulated time of all runs together [s]."""
        return sum(run.duration for run in self.runs.values())

    def as_json(self) -> dict[str, Any]:
        """The content of summary.json; its keys always come in the same order."""
        hashes = {name: signal_hash(run) for name, run in self.runs.items()}
        return {
            "scenario": self.scenario,
            "about": self.about,
            "command": self.command,
            "mode": self.mode,
            "seed": self.seed,
            "methods": dict(sorted(self.methods.items())),
            "own_nodes": dict(sorted(self.own_nodes.items())),
            "differs": [asdict(difference) for difference in self.differs],
            "metrics": {name: metric.as_json() for name, metric in self.metrics.items()},
            "signal_hash": combined_hash(hashes),
            "reproducible": not self.not_reproducible,
            "not_reproducible": list(self.not_reproducible),
            "notes": list(self.notes),
            "runs": {
                name: {
                    "signal_hash": hashes[name],
                    "samples": len(run.time),
                    "channels": len(run.channels),
                    "simulated_time": run.duration,
                }
                for name, run in sorted(self.runs.items())
            },
            "simulated_time": self.simulated_time,
            "wall_time": self.wall_time,
            "real_time_factor": self.simulated_time / self.wall_time if self.wall_time > 0 else None,
            "vehicle": flatten(self.vehicle),
            "parameters": {node: dict(sorted(values.items())) for node, values in sorted(self.parameters.items())},
            **({"timing": dict(self.timing)} if self.timing else {}),
            "versions": versions(),
        }


def versions() -> dict[str, str | None]:
    """Versions of Python and of the packages that compute or carry numbers; None for what is not installed."""
    return {"python": platform.python_version(), **{name: _version(name) for name in PACKAGES}}


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def write_summary(path: Path | str, content: Mapping[str, Any]) -> None:
    """Write the content of summary.json, as a whole or not at all; floats can be read back exactly.

    ValueError for NaN or infinity, which JSON does not know.
    """
    text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False)
    with atomic_file(path) as file:
        file.write(text.encode() + b"\n")
