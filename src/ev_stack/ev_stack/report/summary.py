"""The file summary.json: what was run, with which parameters, and what came out.

How it works: what differs is found by comparing configured runs, not words of a command line: the
driven scenario, the same without the command line, and the defaults of its methods. So a value
counts in whatever way it was given, and one that was given and changes nothing does not.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.parameters.declaration import flatten
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import ROLES
from ev_stack.measures.handling import has_spun
from ev_stack.measures.metric import Metric, Parameters, Runs
from ev_stack.recording.recording import atomic_file, combined_hash, signal_hash
from ev_stack.scenarios.notes import Remark
from ev_stack.scenarios.records import Run, Scenario

COMMAND_LINE, SCENARIO_FILE = "command line", "scenario"
EVERY_NODE = "every node"
_OF_THE_CAR = "vehicle."
PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "rclpy")


@dataclass(frozen=True, slots=True)
class Difference:
    """A parameter with `value` in the place of `instead_of`, and the cause `by`.

    `instead_of` is the value of the scenario's own file where the command line is the cause, else
    the default.
    """

    by: str
    node: str
    parameter: str
    value: Any
    instead_of: Any
    unit: str


def differences(driven: Scenario, own: Scenario) -> list[Difference]:
    """List the parameters of the command line, then those of the scenario's file.

    `own` is the scenario without the command line.

    The car's parameters count where the command line changes them: its file gives all of them.
    """
    nodes: dict[Difference, list[str]] = {}
    for run, before in zip(driven.runs, own.runs, strict=True):
        for found in _of_run(run, before):
            # Equal differences of several nodes come together under one key, without a node.
            key = Difference(
                found.by,
                "",
                found.parameter,
                _frozen(found.value),
                _frozen(found.instead_of),
                found.unit,
            )
            nodes.setdefault(key, []).append(f"{run.name}/{found.node}")
    listed = [
        Difference(
            key.by, _together(members, driven), key.parameter, key.value, key.instead_of, key.unit
        )
        for key, members in nodes.items()
    ]
    # Those of the command line first; sorting is stable, so the order of the nodes stays.
    return sorted(listed, key=lambda difference: difference.by)


def _of_run(run: Run, before: Run) -> Iterator[Difference]:
    for role, configuration in run.configurations.items():
        own, defaults = before.configurations.get(role), _defaults(configuration)
        # an optional role that the command line gives a method
        scenarios = own.values() if own else defaults
        for entry in configuration.entries():
            name, value = entry.name, entry.default
            instead_of = scenarios.get(name, defaults[name])
            if value != instead_of:
                yield Difference(COMMAND_LINE, role, name, value, instead_of, entry.spec.unit)
            elif value != defaults[name] and not name.startswith(_OF_THE_CAR):
                yield Difference(SCENARIO_FILE, role, name, value, defaults[name], entry.spec.unit)


def _defaults(configuration: Configuration) -> dict[str, Any]:
    """Parameters that a node would have if only its method and its car were chosen.

    Options of the method that are on count as off, but their sensors have defaults.
    """
    given = {
        name: value
        for name, value in configuration.values().items()
        if name.startswith(_OF_THE_CAR)
    }
    given["method"] = configuration.method.name
    extra = type(configuration.extra) if configuration.extra is not None else None
    options = {name: configuration.values()[name] for name in configuration.method.switches}
    # A switch that is on brings sensors; their defaults are wanted, with the switch itself off.
    with_sensors = configure(configuration.role, {**given, **options}, extra).values()
    plain = {**with_sensors, **configure(configuration.role, given, extra).values()}
    return {**plain, "method": ROLES[configuration.role].default_method}


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _together(members: list[str], driven: Scenario) -> str:
    """The nodes in short: every node, a node of all runs, or each by its run."""
    roles = list(dict.fromkeys(name.rpartition("/")[2] for name in members))
    # Some nodes differ in some runs only: then each is named with its run.
    if len(members) != len(roles) * len(driven.runs):
        return ", ".join(members)
    return EVERY_NODE if len(roles) == len(driven.runs[0].configurations) else ", ".join(roles)


@dataclass(frozen=True)
class Summary:
    """Everything that stands in summary.json.

    `methods`: role -> method. `own_nodes`: role -> command of a user's node that took its place.
    `mode`: offline, in-process, processes or realtime, with what it was asked for. `wall_time` [s]
    is that of driving, without start, report and figures. `not_reproducible`: why another run may
    give other numbers, empty if it may not. `about` is the scenario in one line, `command` what
    repeats it, `differs` what is not as the scenario's file, or as the defaults have it. `car` is
    the name or file of another car than the scenario's, `curves` what the page shows beside the
    car. `timing`: run -> how well real time was kept.
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
    car: str = ""
    curves: Sequence[str] = ()
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
            "warnings": [note for note in self.notes if not isinstance(note, Remark)],
            "runs": {
                name: {
                    "signal_hash": hashes[name],
                    "samples": len(run.time),
                    "channels": len(run.channels),
                    "simulated_time": run.duration,
                    "spun": has_spun(run),
                }
                for name, run in sorted(self.runs.items())
            },
            "simulated_time": self.simulated_time,
            "wall_time": self.wall_time,
            "real_time_factor": self.simulated_time / self.wall_time
            if self.wall_time > 0
            else None,
            "car": self.car,
            "curves": list(self.curves),
            "vehicle": flatten(self.vehicle),
            "parameters": {
                node: dict(sorted(values.items()))
                for node, values in sorted(self.parameters.items())
            },
            **({"timing": dict(self.timing)} if self.timing else {}),
            "versions": versions(),
        }


def versions() -> dict[str, str | None]:
    """Versions of Python and of the packages that compute or carry numbers.

    None if not installed.
    """
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
