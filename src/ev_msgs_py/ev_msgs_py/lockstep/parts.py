"""Which part plays a configured role: the one place where it is decided what runs compiled."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.configuration import Configuration
from ev_msgs_py.lockstep.part import PythonPart


def part_of(configuration: Configuration, compiled: bool) -> Any:
    """A new part of a configuration, at rest.

    `compiled` asks for compiled code where the method can be compiled. A node does not ask for it, because loading the
    compiler takes longer than what it would save; laws that are too heavy for plain Python are compiled all the same.
    """
    law = configuration.method.law
    if law is None or not law.is_compilable or not configuration.is_ideal or not (compiled or law.heavy):
        return PythonPart(configuration.method, configuration.create())
    from ev_msgs_py.compiling.part import CompiledPart

    common = configuration.common
    return CompiledPart(configuration.method, configuration.parameters, common.vehicle, common.control_period)
