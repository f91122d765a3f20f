"""A compiled law, and the sensors and faults behind it, as the compiled loop calls them.

How it works: a part has a C function, a row of numbers for its state, and one for its constants.
The function is that of all objects of the law; the rows are the object's own. Where the compiled
step of a law of others fails, plain Python takes the same step again, which names the line.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np

from ev_core.compiled.interruptible import interruptible
from ev_core.compiled.part_source import constants_row, is_checked, law_of, part_source
from ev_core.compiling.code_store import key_of
from ev_core.compiling.fingerprint import Reach
from ev_core.compiling.machine_code import FUNCTION, Code, function_address
from ev_core.faults import row
from ev_core.faults.row import FaultRow
from ev_core.methods.law import Given
from ev_core.methods.law_error import LawError, beginning, in_law, named, notes_of
from ev_core.methods.method_record import Method, create
from ev_core.methods.part import PythonPart
from ev_core.parameters.record import fill, numbers
from ev_core.sensors import measuring
from ev_core.sensors.row import SensorRow
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.refusal import ParameterError

_LONGEST = 100  # characters of a name that becomes that of files in the cache
_RULES = ("mistakes", "lists_of_state", "unassigned")  # modules that refuse laws
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


def code_of(method: Method, given: Given) -> Code:
    """Source text that is compiled of a method."""
    text, names = part_source(method, given)
    if is_checked(method):
        # The text is the key of the kept code: with other rules it is looked at again.
        text = f"{text}# {_rules()}\n"
    return Code(_name(method), text, names)


@cache
def _rules() -> str:
    """Digits that change with the rules for laws.

    A law that older rules have accepted is checked again.
    """
    texts = (Path(__file__).with_name(f"{name}.py").read_bytes() for name in _RULES)
    return hashlib.sha256(b"".join(texts)).hexdigest()[:16]


def given_to(method: Method, parameters: Any, vehicle: Any, period: float) -> Given:
    """Values for the functions of a method; LawError if its author's text fails there."""
    with in_law(method):
        return Given(law_of(method), parameters, vehicle, period)


def code_key(method: Method, parameters: Any, vehicle: Any, period: float) -> str:
    """The name under which the machine code of a method is kept."""
    return key_of(*code_of(method, given_to(method, parameters, vehicle, period)))


class NeedsPython(ParameterError):
    """A law does something that only plain Python can do, such as to print."""


@contextmanager
def in_one_line(
    method: Method, parameters: Any, vehicle: Any, period: float
) -> Iterator[Callable[[Reach], None]]:
    """Turn the errors of a law that cannot be compiled into one line, LawError.

    The block calls the function that it is given with all that the law reaches, so that the text is
    checked first.
    """
    reached: list[FunctionType] = []

    def look_at(reach: Reach) -> None:
        from ev_core.compiled import mistakes

        reached.extend(reach.functions.values())
        # The text first: a step of a law that never ends would never end either.
        found = mistakes.wrong_text(method, reach.functions.values())
        if not found:
            found = mistakes.wrong_answer(method, parameters, vehicle, period)
        if found:
            raise LawError(found)

    try:
        yield look_at
    except (ParameterError, OSError, MemoryError):
        raise
    except Exception as error:  # the compiler raises errors of many kinds
        from ev_core.compiled.mistakes import mistake, needs_python

        if text := needs_python(method, reached, error):
            raise NeedsPython(text) from error
        raise LawError(mistake(method, parameters, vehicle, period, error)) from error


def is_kept(method: Method, parameters: Any, vehicle: Any, period: float) -> bool:
    """Return whether the machine code of a method is on disk, so that it need not be compiled."""
    return code_of(method, given_to(method, parameters, vehicle, period)).is_kept()


def _name(method: Method) -> str:
    # The name of a law file is a path.
    return f"{Path(method.name).stem[:_LONGEST]}_{method.role}"


class CompiledPart:
    """Plays a role by the compiled form of its law.

    The state is a row of numbers, advanced in place. One `like` another, with other numbers, has
    its function, which is not looked for again.
    """

    function: int
    is_checked: bool  # whether it is no law of ours, so that it may fail, or never end

    def __init__(
        self,
        method: Method,
        parameters: Any,
        vehicle: Any,
        period: float,
        like: CompiledPart | None = None,
    ) -> None:
        self._made_of = (method, parameters, vehicle, period)
        self._method = method
        self.given = given_to(method, parameters, vehicle, period)
        with in_law(method, law_of(method).prepare):
            self.constants = constants_row(self.given.trees, self.given.values["c"], period)
            row = numbers(self.given.values["s"])
        with in_one_line(method, parameters, vehicle, period) as look_at:
            self._code = code_of(method, self.given)
            # Equal names are one object where the layout is the same: no digest is needed then.
            if like is not None and like._code.names is self._code.names:
                self.function = like.function
            else:
                self.function = function_address(*self._code, look_at)
        # One number at least, so that there is an address also where nothing lasts.
        memory = np.array(row or [0.0])
        self._state = memory[: len(row)]
        notes = law_of(method).notes
        self._notes = self.given.bound(notes) if notes else None
        self._writes = [(shape_of(signal), frame.PLACES[signal]) for signal in method.writes]
        self._begin, self._end = frame.span(method.writes)
        self._call = FUNCTION(self.function)
        self.is_checked = is_checked(method)
        self._memory = (memory.ctypes.data, self.constants.ctypes.data)

    @property
    def state(self) -> np.ndarray:
        """The numbers of the state; may be set to those of another part of the law."""
        return self._state

    @state.setter
    def state(self, row: Any) -> None:
        if len(row) != len(self._state):
            raise ParameterError(
                f"a state of {len(row)} numbers is refused, expected are {len(self._state)}"
            )
        self._state[:] = row

    def start(self, there: Frame) -> None:
        """Write the initial outputs."""
        if self._fails(None, there):
            raise self.raised(None)
        self.refuse_not_finite(there)

    def step(self, here: Frame, there: Frame) -> None:
        """One compiled step."""
        if self._fails(here, there):
            raise self.raised(here.numbers)
        self.refuse_not_finite(there)

    def _fails(self, here: Frame | None, there: Frame) -> bool:
        given = (here and here.address, there.address, *self._memory)
        status: int
        if self.is_checked:
            status = interruptible(lambda: self._call(*given), (self, here, there))
        else:
            status = self._call(*given)
        return status != 0

    def raised(
        self, numbers: Sequence[float] | None, state: np.ndarray | None = None
    ) -> ValueError:
        """Error of the step that has just failed: plain Python takes it again, from the same state.

        `numbers` are those of the frame that it read, None at the start; the state is that of the
        part, or the one that it was stepped with.
        """
        method = self._method
        plain = PythonPart(method, create(*self._made_of))
        try:
            if numbers is None:
                plain.start(Frame())
            else:
                here = Frame()
                here.numbers[: len(numbers)] = frame.numbers_of(numbers)
                before = self._state if state is None else state
                plain.state = before[: len(plain.state)].tolist()
                plain.step(here, Frame())
        except (LawError, SignalError) as error:
            return error
        what = "its compiled form fails where plain Python does not; run it without @compilable"
        function = law_of(method).function
        file, line = beginning(function)
        return LawError(f"{file}, line {line}: {method.role} law {named(function)}: {what}")

    def refuse_not_finite(self, there: Frame) -> None:
        """SignalError if a number that it wrote is not finite."""
        numbers = there.numbers
        # One sum for all: where it is not finite, a number is not, or the sum overflows.
        if not math.isfinite(sum(numbers[self._begin : self._end])):
            for shape, place in self._writes:
                shape.refuse_not_finite(numbers[place])

    def addresses(self) -> tuple[int, int, int]:
        """Addresses of the function, the state and the constants."""
        return self.function, *self._memory

    def notes(self) -> tuple[str, ...]:
        """The law's declaration of its state."""
        if not self._notes:
            return ()
        fill(self.given.values["s"], self._state.tolist())
        with in_law(self._method):
            return notes_of(self._notes)


def _code(name: str, head: int, change: Callable[..., None]) -> Code:
    return Code(
        name, _TEXT.format(head=head, size=frame.SIZE), {"FLOAT": np.float64, "change": change}
    )


# The one function of all sensors, and that of all faults of signals, by what makes their rows.
ROW_CODE: dict[type, Code] = {
    SensorRow: _code("sensors", measuring.SENSORS_HEAD, measuring.measure),
    FaultRow: _code("faults", row.FAULTS_HEAD, row.strike),
}


@cache
def row_function(kind: type) -> int:
    """The address of the function of all rows of a kind."""
    return ROW_CODE[kind].address()


class RowPart:
    """The outputs of a row of sensors or of faults, behind one object.

    `state` are its numbers, advanced in place.
    """

    def __init__(self, row: SensorRow | FaultRow) -> None:
        self.constants = np.array(row.constants)
        self.state = np.array(row.state)
        kind: type = type(row)
        self._function = row_function(kind)

    def addresses(self) -> tuple[int, int, int]:
        """Addresses of the function, the state and the constants."""
        return self._function, self.state.ctypes.data, self.constants.ctypes.data

    def notes(self) -> tuple[str, ...]:
        """Nothing: what sensors and faults do stands in their parameters."""
        return ()
