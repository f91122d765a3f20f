"""Compile every installed method and what steps it, so that no run has to wait for it. scripts/prepare.sh calls this.

    python -m ev_sim.commands.compile_all

What is compiled already is found on disk by the fingerprint of its text, and only loaded.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from typing import Any

from ev_core.compiling.user_cache import cache_folder
from ev_core.lockstep.finding import find_method
from ev_core.methods.register import Method, all_methods
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.frame import PLACES, places
from ev_msgs_py.refusal import ParameterError
from ev_sim.command_line.refusal import refuse

_PERIOD = 0.005  # [s], that all methods allow; compiled code is the same for all periods
_STEPPING = ("", "")  # in the place of role and method: the loops, sensors and observers


def main() -> None:
    """Compile on all cores; exit status 1, and one line for each, if something cannot be compiled."""
    methods = [method for of_role in all_methods().values() for method in of_role.values()]
    compilable = [method for method in methods if method.law and method.law.is_compilable]
    try:
        cache_folder()  # also for the workers
    except ParameterError as error:
        refuse(error)
    import numba  # noqa: F401, once for all workers that are forked from this process

    with ProcessPoolExecutor(os.cpu_count()) as workers:
        found = list(workers.map(_compile_jobs, [[_STEPPING], *_sharing(compilable)]))
    sys.exit("\n".join(error for errors in found for error in errors) or None)


def _sharing(methods: Iterable[Method]) -> list[list[tuple[str, str]]]:
    """Role and name of methods, those together that share functions of one type; what takes long comes first."""
    groups: dict[Any, list[Method]] = {}
    for method in methods:
        kind = (method.law.parameters, method.law.state) if method.law.heavy else method.law.function
        groups.setdefault(kind, []).append(method)
    longest_first = sorted(groups.values(), key=_cost, reverse=True)
    return [[(method.role, method.name) for method in group] for group in longest_first]


def _cost(group: list[Method]) -> tuple[bool, int, int]:
    """A rough order of how long methods take: whether they are heavy, how many they are, how much they read."""
    read = [places(signal) for signal in group[0].reads if signal in PLACES]
    return group[0].law.heavy, len(group), sum(map(len, read))


def _compile_jobs(jobs: Iterable[tuple[str, str]]) -> list[str]:
    gc.disable()  # it looks through all that the compiler remembers, a twentieth of the time, and finds little
    return [error for error in map(_compile, jobs) if error]


def _compile(job: tuple[str, str]) -> str:
    """Why it cannot be compiled, in one line; empty if it could."""
    try:
        if job == _STEPPING:
            _compile_stepping()
        else:
            from ev_core.compiled.part import CompiledPart

            method = find_method(*job)
            CompiledPart(method, method.parameters(), Vehicle(), _PERIOD)
    except Exception as error:  # whatever a law raises: the others go on
        return f"{' '.join(job)}: {type(error).__name__}: {error}".splitlines()[0]
    return ""


def _compile_stepping() -> None:
    from ev_core.compiled.loop import compile_loops
    from ev_core.compiled.part import row_function
    from ev_core.faults.row import FaultRow
    from ev_core.node_loop import steps
    from ev_core.sensors.row import SensorRow
    from ev_sim.batches import observer

    compile_loops()
    steps.address()
    row_function(SensorRow)
    row_function(FaultRow)
    observer.function()


if __name__ == "__main__":
    main()
