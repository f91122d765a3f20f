"""Notes on what a user may not have meant: what comes too late, numbers of another unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from ev_core.faults.fault import parsed
from ev_msgs_py.contract import stamps
from ev_msgs_py.refusal import quoted
from ev_stack.scenarios.records import Run

_FAST = 50.0  # [m/s], 180 km/h, from which on a speed without a unit may be meant in another one


class Remark(str):
    """A note that asks for nothing, which a page folds away; other notes are warnings."""

    __slots__ = ()


def notes_on(runs: Sequence[Run], values: Iterable[tuple[str, str, Any]]) -> list[str]:
    """A line for each; `values` are those of the command line."""
    notes: list[str] = []
    for run in runs:
        notes += _late_faults(run)
        notes += _uneven_end(run)
    notes += _fast(values, runs)
    notes += _estimated(runs)
    return notes


def _late_faults(run: Run) -> Iterator[str]:
    """A line for each fault that begins after the end of the run."""
    periods = stamps.from_seconds(run.duration) // run.period
    for role, configuration in run.configurations.items():
        for fault in parsed(configuration.faults):
            first, *_ = fault.periods(configuration.common.control_period)
            # At the last instant itself a fault would still be seen.
            if first > periods:
                yield (
                    f"{run.namespace}/{role}: fault {quoted(fault.text)} "
                    f"begins after the end at {run.duration:g} s"
                )


def _uneven_end(run: Run) -> Iterator[str]:
    """A line for a run that does not end with a control period."""
    end = stamps.to_seconds(stamps.from_seconds(run.duration) // run.period * run.period)
    if abs(end - run.duration) > 1e-9:
        period = stamps.to_seconds(run.period)
        yield Remark(
            f"{run.name} ends at {end:g} s: {run.duration:g} s is no multiple of "
            f"control_period, {period:g} s"
        )


def _estimated(runs: Sequence[Run]) -> Iterator[str]:
    """A line for each car with estimated tyres."""
    cars = [
        configuration.common.vehicle
        for run in runs
        for configuration in run.configurations.values()
    ]
    named = {car.name: car.tyre.estimated_from for car in cars if car.tyre.estimated_from}
    for car, size in named.items():
        yield Remark(f"{car}: its tyres are an estimate from {size}, by rules of thumb")


def _fast(values: Iterable[tuple[str, str, Any]], runs: Sequence[Run]) -> Iterator[str]:
    """A line for a number that is given for a speed and would be a usual one in km/h."""
    for node, name, value in values:
        if not isinstance(value, int | float) or abs(value) < _FAST:
            continue
        played = [run.configurations[node] for run in runs if node in run.configurations]
        units = [each.spec.unit for of in played for each in of.entries() if each.name == name]
        if units and units[0] == "m/s":
            yield (
                f"{node}.{name} = {value:g} m/s is {3.6 * value:g} km/h; "
                f"km/h are written '{value:g} km/h'"
            )
