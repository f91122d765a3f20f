"""The table of docs/native.md: what each law needs on several processors: code, constants, stack, instructions.

A law answers to the inputs that were recorded in a run with it. Instructions are counted by the emulator: those of a
program that sets these inputs and lets the law answer, less those of one that sets them only.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from documentation.markdown import code, table
from documentation.own_methods import own_methods
from documentation.processors import DRIVEN, refuse_missing
from ev_core.compiling.object_symbols import code_size
from ev_msgs_py.refusal import ParameterError
from ev_sim.export.content import Content
from ev_sim.export.library import Library
from ev_sim.export.targets import TARGETS, Target
from ev_sim.interface.driving import only_run, overrides
from ev_sim.recording.offline import run_offline
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Run, load_scenario, scenario_names

NATIVE = "docs/native.md"
BLOCK = "law costs"
ROLES = ("electronic_differential", "asr")
SECONDS = 20.0  # of each run
# Where a law is not that of a scenario, it is tried in these, one after the other.
_BASES = ("shchur2019", "urban_mixed", "double_lane_change", "ge_ni2005", "zhileykin2018")
_HERE = Path(__file__).parent
COUNTING = {  # words of the emulators that count
    "x86_64-linux": ("qemu-x86_64", "-cpu", "max"),
    **{name: TARGETS[name].emulator for name in DRIVEN if TARGETS[name].emulator},
}
_FLAGS = ("-std=gnu99", "-O2", "-ffp-contract=off")


class Cost(NamedTuple):
    """What a law needs on a processor: bytes of code and of stack, instructions of a step."""

    code: int
    stack: int
    instructions: int


def law_table() -> str:
    """A row for each law of ours."""
    refuse_missing(COUNTING["x86_64-linux"][0])
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        counter = plugin(Path(folder))
        for role in ROLES:
            for name in own_methods(role):
                scenario, run, recording = driven(role, name)
                content = Content(run, only=[role], bare=True)
                costs = [cost(content, recording, target, counter) for target in DRIVEN]
                constants = sum(len(part.constants) + len(part.state) for part in content.parts) * 8
                cells = (" / ".join(str(getattr(each, what)) for each in costs) for what in Cost._fields)
                where = code(scenario) if run.name == scenario else f"{code(scenario)}, {code(run.name)}"
                rows.append((code(name), where, str(constants), *cells))
                print(" ".join(rows[-1]), file=sys.stderr, flush=True)
    return table(("law", "run", "constants, state", "code", "stack", "instructions a step"), rows)


def driven(role: str, name: str) -> tuple[str, Run, Recording]:
    """The scenario and the first run with a law that there is, and its begin as recorded."""
    methods = {role: name, **own_methods(role)[name].requires}
    for scenario, run in _candidates(role, name):
        changed = overrides(method=methods, duration=min(SECONDS, load_scenario(scenario).parameters.duration))
        try:
            chosen = only_run(scenario, run, changed)
            return scenario, chosen, run_offline(chosen.configurations, chosen.duration)
        except ParameterError:  # the law does not fit this car
            continue
    raise LookupError(f"{role} {name} fits no run of {', '.join(_BASES)}")


def _candidates(role: str, name: str) -> Iterator[tuple[str, str]]:
    yield from _in_scenarios().get((role, name), ())
    yield from ((scenario, load_scenario(scenario).runs[0].name) for scenario in _BASES)


@cache
def _in_scenarios() -> dict[tuple[str, str], list[tuple[str, str]]]:
    """The runs in which laws are, by role and law."""
    found: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for scenario in scenario_names():
        for run in load_scenario(scenario).runs:
            for role in {*ROLES} & {*run.configurations}:
                found.setdefault((role, run.configurations[role].method.name), []).append((scenario, run.name))
    return found


def cost(content: Content, recording: Recording, target_name: str, counter: Path) -> Cost:
    """What a law needs on a processor, by recorded inputs; RuntimeError if it does not answer as recorded."""
    target, rows = TARGETS[target_name], len(recording.time)
    inputs = np.array([recording.channels.get(c.name, np.zeros(rows)) for c in content.inputs]).T.tobytes()
    with tempfile.TemporaryDirectory() as made:
        size, program = _built(content, target, Path(made))
        _, before = _run((*COUNTING[target_name], "-plugin", str(counter)), program, rows, "nothing", inputs)
        shown, after = _run((*COUNTING[target_name], "-plugin", str(counter)), program, rows, "steps", inputs)
        measured, _ = _run(target.emulator, program, rows, "stack", inputs)
    expected = np.array([recording.channels[channel.name] for channel in content.outputs]).T.tobytes()
    if shown[: len(expected)] != expected:
        raise RuntimeError(f"{content.run.name}: {content.roles[0]} answers otherwise on {target_name}")
    stack = int(np.frombuffer(measured[len(expected) :], "<u4")[0])
    return Cost(size, stack, round((int(after) - int(before)) / rows))


def _built(content: Content, target: Target, folder: Path) -> tuple[int, Path]:
    """The bytes of the law's code, and the program around it."""
    library = Library(content, "model")
    objects = library.objects(target, folder)
    source = folder / "law_costs.c"
    source.write_bytes((_HERE / source.name).read_bytes())
    sources = library.write(folder, target, ["model.h", "constants.h", "model.c"])
    program = target.program([*objects, sources[-1], source], folder / "law_costs", _FLAGS)
    return sum(code_size(file.read_bytes()) for file in objects), program


def _run(emulator: tuple[str, ...], program: Path, rows: int, what: str, inputs: bytes) -> tuple[bytes, str]:
    done = subprocess.run([*emulator, program, str(rows), what], input=inputs, capture_output=True, check=True)
    return done.stdout, done.stderr.decode()


def plugin(folder: Path) -> Path:
    """The counter, built for the emulator's own version of its interface; RuntimeError if it has no such interface."""
    made = folder / "qemu_count.so"
    for number in range(1, 9):
        words = ["gcc", "-O2", "-fPIC", "-shared", f"-DAPI={number}", "-o", made, _HERE / "qemu_count.c"]
        subprocess.run(words, check=True)
        tried = subprocess.run([*COUNTING["x86_64-linux"], "-plugin", made, "/bin/true"], capture_output=True)
        if tried.returncode == 0 and tried.stderr.strip().isdigit():
            return made
    raise RuntimeError("this qemu-user does not take plugins")
