"""What changes the numbers of a part in the frame, as the compiled loop calls it behind that part."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from ev_msgs_py.compiling.machine_code import function_address
from ev_msgs_py.contract import frame
from ev_msgs_py.faults import striking
from ev_msgs_py.faults.row import FaultRow
from ev_msgs_py.sensors import measuring
from ev_msgs_py.sensors.row import SensorRow

_TEXT = '''"""Behind a part: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy")
def step(now, next, state, constants):
    head = carray(constants, {head}, FLOAT)
    row = carray(constants, int(head[0]), FLOAT)
    change(carray(next, {size}, FLOAT), carray(state, int(head[1]), FLOAT), row)
    return 0
'''


@cache
def _function(name: str, head: int, change: Callable[..., None]) -> int:
    text = _TEXT.format(head=head, size=frame.SIZE)
    return function_address(name, text, {"FLOAT": np.float64, "change": change})


def function() -> int:
    """The address of the one function of all sensors."""
    return _function("sensors", measuring.HEAD, measuring.measure)


def fault_function() -> int:
    """The address of the one function of all faults of signals."""
    return _function("faults", striking.HEAD, striking.strike)


class RowPart:
    """What a row of sensors or of faults says, behind one object; `state` are its numbers, advanced in place."""

    def __init__(self, row: SensorRow | FaultRow) -> None:
        self.constants, self.state = np.array(row.constants), np.array(row.state)
        self._function = function() if isinstance(row, SensorRow) else fault_function()

    def addresses(self) -> tuple[int, int, int]:
        """Of the function, the state and the constants."""
        return self._function, self.state.ctypes.data, self.constants.ctypes.data

    def notes(self) -> tuple[str, ...]:
        """Nothing: what sensors and faults do stands in their parameters."""
        return ()


class SensorPart(RowPart):
    """The sensors of one object that integrates."""

    def __init__(self, parameters: Any, seed: int) -> None:
        super().__init__(SensorRow(parameters, seed))
