"""Which parts play a configured role: the one place where it is decided what runs compiled."""

from __future__ import annotations

import sys
from typing import Any

from ev_msgs_py.faults.restart import Restart
from ev_msgs_py.faults.row import FaultRow, of_signals
from ev_msgs_py.lockstep.configuration import Configuration
from ev_msgs_py.lockstep.part import Part, PythonPart
from ev_msgs_py.sensors.row import SensorRow
from ev_msgs_py.sensors.sensed import Sensed


def part_of(configuration: Configuration, compiled: bool) -> Part:
    """A new part of a configuration, at rest, behind its sensors and faults.

    `compiled` asks for compiled code where the method can be compiled; laws that are too heavy for plain Python are
    compiled all the same.
    """
    return behind_sensors(configuration, method_part(configuration, compiled))


def behind_sensors(configuration: Configuration, part: Part) -> Part:
    """The part of a method behind the sensors and faults of its configuration."""
    rows = _rows(configuration)
    return Sensed(part, rows, _restart(configuration, part)) if rows else part


def _rows(configuration: Configuration) -> list[SensorRow | FaultRow]:
    """What changes the numbers that a part writes: its sensors, and then its faults."""
    rows: list[SensorRow | FaultRow] = []
    common = configuration.common
    if not configuration.is_ideal:
        rows.append(SensorRow(configuration.sensors, common.seed, common.vehicle.driven_wheels))
    if faults := of_signals(configuration.faults):
        rows.append(FaultRow(faults, configuration.method.writes, common.seed, common.control_period))
    return rows


def _restart(configuration: Configuration, part: Part) -> Restart | None:
    faults = [fault for fault in of_signals(configuration.faults) if fault.kind == "restarted"]
    return Restart(part, faults, configuration.common.control_period) if faults else None


def is_compiled(configuration: Configuration) -> bool:
    """Whether compiled code costs no time at the start: it is on disk, or the compiler is loaded already.

    The node of a light law does without the compiler: loading it takes longer than it would save.
    """
    method, common = configuration.method, configuration.common
    if method.law is None or not method.law.is_compilable:
        return False
    if "numba" in sys.modules:
        return True
    from ev_msgs_py.compiling.part import is_kept

    return is_kept(method, configuration.told, common.vehicle, common.control_period)


def compiled_parts(configuration: Configuration) -> list[Any]:
    """The same for the compiled loop, which calls one behind the other: restart, method's part, sensors, faults."""
    part = method_part(configuration, compiled=True)
    restart = _restart(configuration, part)
    return [*([restart] if restart else ()), part, *row_parts(configuration)]


def row_parts(configuration: Configuration) -> list[Any]:
    """Those behind the method's part."""
    rows = _rows(configuration)
    if rows:
        from ev_msgs_py.sensors.part import RowPart

        return [RowPart(row) for row in rows]
    return []


def method_part(configuration: Configuration, compiled: bool) -> Any:
    """The part of the method alone, without sensors."""
    method, common = configuration.method, configuration.common
    law = method.law
    if law is None or not law.is_compilable or not (compiled or law.heavy):
        kind = getattr(method.factory, "part", PythonPart)
        return kind(method, configuration.create())
    from ev_msgs_py.compiling.part import CompiledPart

    return CompiledPart(method, configuration.told, common.vehicle, common.control_period)


def hand_over(before: Part, after: Part) -> None:
    """Let a part go on with the state of another one of its method; sensors and faults too where both have the same."""
    bare(after).state = bare(before).state
    if isinstance(before, Sensed) and isinstance(after, Sensed):
        after.go_on_from(before)


def bare(part: Part) -> Any:
    """The part of the method, without its sensors and faults."""
    return part.part if isinstance(part, Sensed) else part
