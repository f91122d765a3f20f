"""Notes on what a user may not have meant: what has no effect, what comes too late, numbers of another unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ev_core.faults.fault import parsed
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import quoted
from ev_stack.scenarios.parameter_file import ParameterFile

if TYPE_CHECKING:
    from ev_stack.scenarios.scenario import Overrides, Run

_FAST = 50.0  # [m/s], 180 km/h, from which on a speed without a unit may be meant in another one


def notes_on(
    files: Sequence[ParameterFile], runs: Sequence[Run], overrides: Overrides, whole: bool
) -> list[str]:
    """A line for each; what files set and no run uses only if all runs of the scenario are there."""
    return [
        *(_unused_in(files, runs, overrides) if whole else ()),
        *(note for run in runs for note in (*_late_faults(run), *_uneven_end(run))),
        *_fast(overrides.values, runs),
    ]


def _late_faults(run: Run) -> Iterator[str]:
    """A line for each fault that the run does not live to see."""
    for role, configuration in run.configurations.items():
        for fault in parsed(configuration.faults):
            if (
                fault.periods(configuration.common.control_period)[0]
                > stamps.from_seconds(run.duration) // run.period
            ):
                yield f"{run.namespace}/{role}: fault {quoted(fault.text)} begins after the end at {run.duration:g} s"


def _uneven_end(run: Run) -> Iterator[str]:
    """A line for a run that does not end with a control period."""
    end = stamps.to_seconds(stamps.from_seconds(run.duration) // run.period * run.period)
    if abs(end - run.duration) > 1e-9:
        period = stamps.to_seconds(run.period)
        yield f"{run.name} ends at {end:g} s: {run.duration:g} s is no multiple of control_period, {period:g} s"


def _fast(values: Iterable[tuple[str, str, Any]], runs: Sequence[Run]) -> Iterator[str]:
    """A line for a number that is given for a speed and would be a usual one in km/h."""
    for node, name, value in values:
        if isinstance(value, int | float) and abs(value) >= _FAST:
            configurations = (run.configurations.get(node) for run in runs)
            found = [each for c in configurations if c for each in c.entries() if each.name == name]
            if found and found[0].spec.unit == "m/s":
                yield f"{node}.{name} = {value:g} m/s is {3.6 * value:g} km/h; km/h are written '{value:g} km/h'"


def _unused_in(
    files: Sequence[ParameterFile], runs: Sequence[Run], overrides: Overrides
) -> list[str]:
    """What files set and no run uses, a note for each file, but for roles whose method the command line chooses."""
    switched = {node for node, key, _ in overrides.values if key == "method"}
    roles = [role for role in ROLES if role not in switched]
    notes = []
    for file in files:
        found: dict[str, bool] = {}  # by name whether it is used
        for run in runs:
            for role in (role for role in roles if role in run.configurations):
                for name in file.values_for(f"{run.namespace}/{role}"):
                    is_used = name not in run.configurations[role].unused
                    found[f"{role}.{name}"] = found.get(f"{role}.{name}", False) or is_used
        if unused := [name for name, is_used in found.items() if not is_used]:
            notes.append(f"used by no chosen method: {', '.join(unused)} of {file.path}")
    return notes
