"""A law in cells, as a notebook has them.

Each may be run again with another number, and the compiled law follows.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from helpers.compiled_object import CompiledObject

from ev_core.methods.law import Law
from ev_core.methods.method_record import Method, create
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import WheelTorqueRequest
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

NAME = "edited_law"
IMPORTS = """
from collections import namedtuple
from dataclasses import make_dataclass
from enum import IntEnum
from types import ModuleType
from typing import NamedTuple
import numpy as np
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.contract.wheels import Wheels
from ev_core.parameters.declaration import parameter
consts = ModuleType("consts")
consts.inner = ModuleType("consts.inner")
TABLE = np.zeros(3000)
"""
# By what is edited, its text with a whole number {n}; all of them change what the law says.
CELLS = {
    "constant of a module": "consts.LIMIT = {n}.25",
    "constant of a module's module": "consts.inner.LIMIT = {n}.5",
    "far element of an array": "TABLE[1500] = {n}.0",
    "whole array": "ROW = np.array([{n}.0, 1.0])",
    "row of rows": "ROWS = ((1.0, 2.0), (3.0, {n}.0))",
    "default": "@compilable\ndef scaled(x, by={n}.0):\n    return x * by",
    "closure": "def adding(n):\n    return compilable(lambda x: x + n)\nadded = adding({n}.0)",
    "nested helper": "@compilable\ndef helped(x):\n    return added(scaled(x)) - {n}.0",
    "two of one kind": "FIRST, SECOND, THIRD = ({n}.0, 1.0, 1.0) if {n} % 2 else ({n}.0, {n}.0, 1.0)",
    "order of a named tuple": "Pair = namedtuple('Pair', ('a', 'b') if {n} % 2 else ('b', 'a'))",
    "values of a named tuple": "class Gains(NamedTuple):\n    k: float\nGAINS = Gains({n}.0)",
    "member": "class Mode(IntEnum):\n    ON = {n}",
    "class of parameters": (
        "P = make_dataclass('P', [(name, float, parameter({n}.0 + k, unit='1', low=0.0, high={n}.0 + k, about=name))"
        " for k, name in enumerate(('first', 'second', 'third')[:: -1 if {n} % 2 else 1])], frozen=True)"
    ),
}
LAW = """
@compilable
def law(p, request: WheelTorqueRequest) -> WheelTorqueCommand:
    drive = request.drive
    x = helped(drive.front_left) + consts.LIMIT + consts.inner.LIMIT * TABLE[1500] + ROW[0] - ROWS[1][1]
    y = FIRST * drive.front_right + SECOND * drive.rear_left + THIRD * Pair(x, 2.0).b + GAINS.k
    z = p.first - p.third * 0.5
    return WheelTorqueCommand(Wheels(x, y, z, drive.rear_right if Mode.ON == 1 else 0.0), request.brake)
"""
REQUEST = WheelTorqueRequest(Wheels(3.0, 5.0, 7.0, 11.0), NO_WHEELS)


def namespace(numbers: dict[str, int]) -> dict[str, Any]:
    """The law with these numbers in its cells, as a new process has it."""
    module = ModuleType(NAME)
    exec(
        "\n".join((IMPORTS, *(text.format(n=numbers[cell]) for cell, text in CELLS.items()), LAW)),
        vars(module),
    )
    return vars(module)


def edit(space: dict[str, Any], cell: str, number: int) -> None:
    """Run a cell again."""
    exec(CELLS[cell].format(n=number), space)


def method_of(law: Callable[..., Any], parameters: type) -> Method:
    """The law with a class of parameters."""
    return Method("asr", NAME, Law(law, parameters), (WheelTorqueRequest,), parameters)


def answers(space: dict[str, Any]) -> tuple[Wheels, Wheels]:
    """Commands of the law, compiled and in plain Python."""
    made = (method_of(space["law"], space["P"]), space["P"](), Vehicle(), 0.01)
    return CompiledObject(*made).step(REQUEST).drive, create(*made).step(REQUEST).drive
