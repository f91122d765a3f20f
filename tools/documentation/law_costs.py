"""The table of docs/native.md: what each law needs on several processors: code, constants, stack, instructions.

A law answers to the inputs that were recorded in a run with it, as the program of a processor in
the loop.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

from documentation.markdown import code, table
from documentation.own_methods import own_methods
from documentation.processors import DRIVEN, refuse_missing
from ev_doors.export.content import Content
from ev_doors.export.counting import counted
from ev_doors.export.program import Measured, Program, build_program
from ev_doors.export.targets import TARGETS
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.driving import only_run, overrides
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.scenario import load_scenario

NATIVE = "docs/native.md"
BLOCK = "law costs"
ROLES = ("electronic_differential", "asr")
ON = (*DRIVEN, "thumbv7em")
SECONDS = 20.0  # of each run
# Where a law is not that of a scenario, it is tried in these, one after the other.
_BASES = ("shchur2019", "urban_mixed", "double_lane_change", "ge_ni2005", "zhileykin2018")
COUNTING = {  # words of the emulators that count
    "x86_64-linux": ("qemu-x86_64", "-cpu", "max"),
    **{name: TARGETS[name].emulator for name in ON if TARGETS[name].emulator},
}


def law_table() -> str:
    """A row for each law of ours."""
    refuse_missing(
        COUNTING["x86_64-linux"][0], TARGETS["thumbv7em"].compiler, COUNTING["thumbv7em"][0]
    )
    rows = []
    for role in ROLES:
        for name in own_methods(role):
            scenario, run, recording = driven(role, name)
            content = Content(run, only=[role], bare=True)
            costs = [cost(content, recording, target) for target in ON]
            cells = (
                " / ".join(str(getattr(each, what)) for each in costs)
                for what in ("code", "stack", "instructions_a_step")
            )
            where = (
                code(scenario) if run.name == scenario else f"{code(scenario)}, {code(run.name)}"
            )
            rows.append((code(name), where, str(costs[0].constants), *cells))
            print(" ".join(rows[-1]), file=sys.stderr, flush=True)
    return table(("law", "run", "constants, state", "code", "stack", "instructions a step"), rows)


def driven(role: str, name: str) -> tuple[str, Run, Recording]:
    """The scenario and the first run with a law that there is, and its begin as recorded."""
    required = own_methods(role)[name].requires
    methods = {role: name} | {of: needed for of, needed in required.items() if "." not in of}
    for scenario, run in _candidates(role, name):
        changed = overrides(
            method=methods, duration=min(SECONDS, load_scenario(scenario).parameters.duration)
        )
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
                found.setdefault((role, run.configurations[role].method.name), []).append(
                    (scenario, run.name)
                )
    return found


def cost(content: Content, recording: Recording, target_name: str) -> Measured:
    """What a law needs on a processor, by recorded inputs; RuntimeError if it does not answer as recorded."""
    rest = np.zeros(len(recording.time))
    rows = np.array([recording.channels.get(channel.name, rest) for channel in content.inputs]).T
    with tempfile.TemporaryDirectory() as made:
        words = [
            *COUNTING[target_name],
            build_program(content, TARGETS[target_name], Path(made))[-1],
        ]
        if not TARGETS[target_name].board:  # which counts by itself
            words = counted(words, Path(made))
        with Program(content, words) as running:
            running.create()
            answers = np.array([running.step(row)[1] for row in rows])
            measured = running.measured
    if (
        answers.tobytes()
        != np.array([recording.channels[channel.name] for channel in content.outputs]).T.tobytes()
    ):
        raise RuntimeError(
            f"{content.run.name}: {content.roles[0]} answers otherwise on {target_name}"
        )
    if measured.error:
        raise RuntimeError(f"{target_name}: {measured.why_not_counted}")
    return measured
