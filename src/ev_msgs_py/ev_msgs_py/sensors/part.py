"""Sensors as the compiled loop calls them, behind the part whose numbers in the frame they change."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ev_msgs_py.compiling.machine_code import function_address
from ev_msgs_py.contract import frame
from ev_msgs_py.sensors.measuring import HEAD, measure
from ev_msgs_py.sensors.row import SensorRow

_TEXT = f'''"""Sensors: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), cache=True, error_model="numpy")
def step(now, next, state, constants):
    head = carray(constants, {HEAD}, FLOAT)
    sensors = carray(constants, int(head[0]), FLOAT)
    measure(carray(next, {frame.SIZE}, FLOAT), carray(state, int(head[1]), FLOAT), sensors)
    return 0
'''


@cache
def function() -> int:
    """The address of the one function of all sensors."""
    return function_address("sensors", _TEXT, {"FLOAT": np.float64, "measure": measure})


class SensorPart:
    """The sensors of one object that integrates; `state` is the row of its numbers, advanced in place."""

    def __init__(self, parameters: Any, seed: int) -> None:
        row = SensorRow(parameters, seed)
        self.constants, self.state = np.array(row.constants), np.array(row.state)

    def addresses(self) -> tuple[int, int, int]:
        """Of the function, the state and the constants."""
        return function(), self.state.ctypes.data, self.constants.ctypes.data

    def notes(self) -> tuple[str, ...]:
        """Nothing: what sensors do stands in their parameters."""
        return ()
