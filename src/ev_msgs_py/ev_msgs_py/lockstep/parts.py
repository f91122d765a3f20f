"""Which parts play a configured role: the one place where it is decided what runs compiled."""

from __future__ import annotations

import sys
from typing import Any

from ev_msgs_py.lockstep.configuration import Configuration
from ev_msgs_py.lockstep.part import Part, PythonPart
from ev_msgs_py.sensors.sensed import Sensed


def part_of(configuration: Configuration, compiled: bool) -> Part:
    """A new part of a configuration, at rest, behind its sensors.

    `compiled` asks for compiled code where the method can be compiled; laws that are too heavy for plain Python are
    compiled all the same.
    """
    part: Part = method_part(configuration, compiled)
    if configuration.is_ideal:
        return part
    return Sensed(part, configuration.sensors, configuration.common.seed)


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

    return is_kept(method, configuration.parameters, common.vehicle, common.control_period)


def compiled_parts(configuration: Configuration) -> list[Any]:
    """The same for the compiled loop, which calls one behind the other: the method's part, and its sensors'."""
    parts = [method_part(configuration, compiled=True)]
    if not configuration.is_ideal:
        from ev_msgs_py.sensors.part import SensorPart

        parts.append(SensorPart(configuration.sensors, configuration.common.seed))
    return parts


def method_part(configuration: Configuration, compiled: bool) -> Any:
    """The part of the method alone, without sensors."""
    method, common = configuration.method, configuration.common
    law = method.law
    if law is None or not law.is_compilable or not (compiled or law.heavy):
        return PythonPart(method, configuration.create())
    from ev_msgs_py.compiling.part import CompiledPart

    return CompiledPart(method, configuration.parameters, common.vehicle, common.control_period)


def hand_over(before: Part, after: Part) -> None:
    """Let a part go on with the state of another one of its method; sensors go on too where both have the same."""
    _bare(after).state = _bare(before).state
    if isinstance(before, Sensed) and isinstance(after, Sensed):
        after.sensors.go_on_from(before.sensors)


def _bare(part: Part) -> Any:
    return part.part if isinstance(part, Sensed) else part
