"""Compiled code of runs, made before they begin: on all cores, with a bar that counts.

How it works: a unit is one piece of code with a key. Units that are not on disk are handed to
forked workers, one at a time to each, those that take longest first. A worker leaves its code on
the disk, where the run and its nodes find it. A worker that is killed costs its unit only.

What is missing then is compiled when it is used, by nodes as well. What is on disk is only
looked for.
"""

from __future__ import annotations

import gc
import os
import sys
import threading
from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import suppress
from functools import partial
from importlib.util import find_spec
from multiprocessing.connection import wait
from typing import Any, NamedTuple

from ev_core.compiled.loop import LOOPS
from ev_core.compiling.code_store import can_be_kept, kept_code
from ev_core.compiling.machine_code import Code, counted_by_others
from ev_core.compiling.user_cache import cache_folder
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.method_record import Method
from ev_core.vehicle.description import Vehicle
from ev_sim.driver.off_path import DISTANCES
from ev_stack.recording.outcome import bar_of_code
from ev_stack.running.children import Worker, WorkerLost
from ev_stack.scenarios.records import Run


class Unit(NamedTuple):
    """Something to compile: what it is called, whether it is on disk, what makes it.

    Of one `key` one is made.
    """

    name: str
    is_kept: Callable[[], bool]
    make: Callable[[], object]
    key: str


def compile_for(runs: Iterable[Run], in_nodes: bool, others: Collection[str] = ()) -> None:
    """Compile what runs lack, offline or in nodes, but for roles that `others` play.

    What cannot be compiled says so when it is used.
    """
    played = [
        each for run in runs for role, each in run.configurations.items() if role not in others
    ]
    heavy_first = sorted(
        played, key=lambda each: each.method.law is None or not each.method.law.heavy
    )
    units: list[Unit | None] = []
    for each in heavy_first:
        with suppress(Exception):  # whatever a law raises when it is prepared
            units.append(unit_of(each))
    compile_units([*filter(None, units), *of_reports(played), *stepping(in_nodes)])


def compile_units(units: Iterable[Unit]) -> list[str]:
    """Compile those units that are not on disk; one line for each that cannot be compiled."""
    if not can_be_kept():
        return []
    # By key: runs with the same law share its code.
    missing = list({unit.key: unit for unit in units if not unit.is_kept()}.values())
    if not missing:
        return []
    cache_folder()  # also for the workers
    count = min(len(missing), _processes())
    with bar_of_code(len(missing)) as bar, counted_by_others():
        found = _on_workers(missing, count, bar.update) if count > 1 else _here(missing, bar.update)
    return [error for error in found if error]


def _processes() -> int:
    """Number of processes to fork: none beside other threads, for their locks would stay held."""
    return (
        len(os.sched_getaffinity(0))
        if sys.platform == "linux" and threading.active_count() == 1
        else 1
    )


def _here(units: Sequence[Unit], progress: Callable[[], object]) -> list[str]:
    found = []
    for unit in units:
        found.append(_error_of(unit))
        progress()
    return found


def _on_workers(units: Sequence[Unit], count: int, progress: Callable[[], object]) -> list[str]:
    from ev_core.compiling.machine_code import register_functions

    register_functions()  # once for all workers that are forked from this process

    # Reversed, so that `pop` takes the first, which take longest, first.
    waiting, found = list(reversed(range(len(units)))), []
    workers: list[Worker] = []
    try:
        for _ in range(count):
            workers.append(Worker(partial(_made_by_worker, units)))
            workers[-1].begin(waiting.pop())
        # A worker leaves when nothing waits, or when it is lost.
        while workers:
            for worker in wait(workers):
                is_lost = False
                try:
                    found.append(worker.result())
                except WorkerLost:  # such as for lack of memory: the others go on
                    is_lost = True
                    found.append(
                        f"{units[worker.number].name}: the process that compiled it was killed"
                    )
                progress()
                if waiting and not is_lost:
                    worker.begin(waiting.pop())
                else:
                    workers.remove(worker)
                    worker.end()
    finally:
        for worker in workers:
            worker.end()
    return [
        *found,
        *(f"{units[number].name}: all processes that compile were killed" for number in waiting),
    ]


def _made_by_worker(units: Sequence[Unit], number: int) -> str:
    # it looks through all that the compiler remembers, a twentieth of the time, and finds little
    gc.disable()
    return _error_of(units[number])


def _error_of(unit: Unit) -> str:
    """Why it cannot be compiled, in one line; empty if it could."""
    try:
        unit.make()
    except Exception as error:  # whatever a law raises: the others go on
        return f"{unit.name}: {type(error).__name__}: {error}".splitlines()[0]
    return ""


def unit_of(configuration: Configuration) -> Unit | None:
    """The method of a role as it is configured; None if it runs in plain Python."""
    method, common = configuration.method, configuration.common
    return unit_of_method(method, configuration.given, common.vehicle, common.control_period)


def unit_of_method(method: Method, parameters: Any, vehicle: Vehicle, period: float) -> Unit | None:
    """The same of a method with parameters that need not fit together."""
    if method.law is None or not method.law.is_compilable:
        return None
    from ev_core.compiled.part import CompiledPart, code_key  # numba is slow to import

    def is_kept() -> bool:
        return kept_code(key) is not None

    key = code_key(method, parameters, vehicle, period)
    return Unit(
        f"{method.role} {method.name}",
        is_kept,
        lambda: CompiledPart(method, parameters, vehicle, period),
        key,
    )


def unit_of_code(code: Code) -> Unit:
    """Unit of code that belongs to no method."""
    return Unit(code.name, code.is_kept, code.address, code.name)


def of_reports(played: Iterable[Configuration]) -> list[Unit]:
    """Units for the reports of runs with a driver that follows a path."""
    has_path = any(each.role == "driver" and hasattr(each.given, "path") for each in played)
    return [unit_of_code(DISTANCES)] if has_path else []


def stepping(in_nodes: bool) -> list[Unit]:
    """Units that step the methods, in nodes or offline; without ROS there are no nodes."""
    if in_nodes and find_spec("rclpy") is None:
        return []
    if not in_nodes:
        return [*map(unit_of_code, LOOPS)]
    from ev_nodes.stepping.stepped_node import node_loop

    loop = node_loop()
    return [unit_of_code(loop.steps.CODE)] if loop and loop.is_switched_on() else []
