"""A node that is killed and started again: its part forgets everything when the fault ends."""

from __future__ import annotations

import copy
import ctypes
from collections.abc import Sequence
from typing import Any

from ev_msgs_py.compiling.foreign import FUNCTION
from ev_msgs_py.contract.frame import TIME
from ev_msgs_py.faults.fault import Fault


class Restart:
    """Puts a part back to its start at the instants at which it begins anew."""

    error: BaseException | None = None
    state = None  # nothing lasts but that of the part

    def __init__(self, part: Any, faults: Sequence[Fault], period: float) -> None:
        self._part, self._period = part, period
        self._first = copy.deepcopy(part.state)
        self._ends = {fault.periods(period)[1] for fault in faults if fault.kind == "restarted"}
        self._function = FUNCTION(self._called_back)

    def before(self, time: float) -> None:
        """Called before the part answers at a time [s]."""
        if self._ends and round(time / self._period) in self._ends:
            self._part.state = copy.deepcopy(self._first)

    def addresses(self) -> tuple[int, int, int]:
        """Of the function that compiled code calls before the part's."""
        return ctypes.cast(self._function, ctypes.c_void_p).value or 0, 0, 0

    def _called_back(self, here: int | None, _there: int, _state: int | None, _constants: int | None) -> int:
        self.before(ctypes.c_double.from_address((here or 0) + TIME * ctypes.sizeof(ctypes.c_double)).value)
        return 0

    def notes(self) -> tuple[str, ...]:
        """Nothing: it stands in the parameters."""
        return ()
