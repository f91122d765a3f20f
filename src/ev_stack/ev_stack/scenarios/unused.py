"""Values that do nothing in the runs: refused if a command gives them, noted if a file does."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Any

from ev_core.lockstep.configuration import refuse_unused
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.sources import Sources

_DRIVER = "driver"
_PROFILE = "speed_profile."


def refuse_unused_values(values: Iterable[tuple[str, str, Any]], runs: Sequence[Run]) -> None:
    """ParameterError for (node, parameter, value) that nothing in these runs takes."""
    for node, key, _ in values:
        # No method can play what is no node of the graph.
        if node != "*" and node not in ROLES:
            raise unknown_name("node", node, ROLES)
        played = [
            each for run in runs for each in run.configurations.values() if node in ("*", each.role)
        ]
        if not played:
            raise ParameterError(
                f"{node}.{key} is refused: no node plays {node}, expected with --method {node}=NAME"
            )
        # For `*` it is enough that one node uses it.
        if all(key in each.unused for each in played):
            try:
                refuse_unused([key], [each for each in played if each.role == played[0].role])
            except ParameterError as error:
                raise ParameterError(f"{node}: {error}", key) from None


def refuse_unfollowed_speed(values: Iterable[tuple[str, str, Any]], runs: Sequence[Run]) -> None:
    """ParameterError for a speed over time, or a cycle, where no driver ever follows one."""
    for node, name, _ in values:
        if node not in ("*", _DRIVER) or not name.startswith(_PROFILE):
            continue
        drivers = [run.configurations[_DRIVER] for run in runs]
        if not any(f"{_PROFILE}time" in driver.values() for driver in drivers):
            raise ParameterError(
                f"driver.{name} is refused: driver method {drivers[0].method.name} "
                "follows no speed over time"
            )
        if not any(_follows_a_speed(run) for run in runs):
            raise ParameterError(
                f"driver.{name} is refused: the driver goes by the pedals from the start on, "
                "expected with driver.pedals.begin=false"
            )
        return


def _follows_a_speed(run: Run) -> bool:
    driver = run.configurations[_DRIVER].values()
    is_pressed = driver.get("pedals.begin", False)
    # Until the pedals begin, by time or by speed, the driver follows his speed.
    if not is_pressed or driver["pedals.begin_time"] or driver["pedals.begin_speed"]:
        return True
    return run.configurations[MASTER].values().get("speed") == "imposed"


def unused_in_files(
    runs: Sequence[Run], sources: Sequence[Sources], switched: Collection[str]
) -> list[str]:
    """A note for each file on what it sets and no run uses.

    Roles with a method `switched` by the command line are left out: the file was written for
    another method.
    """
    notes = []
    for place, file in enumerate(sources[0].files):
        found: dict[str, bool] = {}  # by name whether it is used
        for run, of_run in zip(runs, sources, strict=True):
            for role, configuration in run.configurations.items():
                if role in switched:
                    continue
                for name in of_run.given[role][place]:
                    # Over all runs: what one of them uses is not unused.
                    full = f"{role}.{name}"
                    is_used = name not in configuration.unused
                    found[full] = found.get(full, False) or is_used
        unused = [name for name, is_used in found.items() if not is_used]
        if unused:
            notes.append(f"used by no chosen method: {', '.join(unused)} of {file.path}")
    return notes
