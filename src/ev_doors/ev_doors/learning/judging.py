"""Reward and end of an episode: a compiled function for many cars, the same text in plain Python.

How it works: a function that is marked as `compilable` names what it needs, `car`, `action` and
`own` first, then signals, as a law does. Reward and end make up one C function, which reads them in
the frame of a car, with its indices and divisors checked. Where one of them fails, plain Python
calls it again, which finds the line. Any other function takes the frame as a mapping by channel,
the action, and the action that stands for the own law: numbers of one car, or arrays of many.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, get_type_hints

import numpy as np

from ev_core.compiled.mistakes import of_compiler
from ev_core.compiled.part_source import made_of_frame
from ev_core.compiling.machine_code import Code, TakesInterpreter
from ev_core.methods.law import namespace
from ev_core.methods.law_error import (
    BY_AUTHORS,
    LawError,
    WrongResultError,
    beginning,
    raise_in_one_line,
)
from ev_core.parameters.record import numbers, record_type, shape_of_record
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.compilable import FUNCTIONS, compilable
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import Shape, shape_of
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.packages import OURS
from ev_msgs_py.refusal import ParameterError, quoted

Reward = Callable[..., Any]
GIVEN = ("car", "action", "own")
_TEXT = '''"""Reward and end of an episode: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy", boundscheck=True)
def step(now, next, state, constants):
    here = carray(now, {size}, FLOAT)
    there = carray(next, 2, FLOAT)
    choice = carray(state, (2, {actions}), FLOAT)
    action, own = choice[0], choice[1]
    car = carray(constants, 1, CAR)[0]
{given}
    status = 1
    try:
        there[0] = reward({reward})
        there[1] = ends({ends})
        status = 0
    except Exception:
        pass
    return status
'''


def is_law(function: Any) -> bool:
    """Return whether a reward or an end is written as a law, to be compiled."""
    return function in FUNCTIONS


def _is_ours(function: Callable[..., Any]) -> bool:
    return function.__module__.partition(".")[0] in OURS


@compilable
def nothing() -> float:
    """No reward: another function gives it."""
    return 0.0


def _asked(what: str, function: Callable[..., Any]) -> dict[str, type | None]:
    """Names of the arguments with their signals, None for those of GIVEN."""
    hints = get_type_hints(function)
    found: dict[str, type | None] = {}
    for name in inspect.signature(function).parameters:
        if name not in GIVEN and hints.get(name) not in frame.PLACES:
            raise ParameterError(
                f"{what} {function.__name__} asks for {name}: {quoted(hints.get(name))}, expected"
                f" {', '.join(GIVEN)}, or a signal by its annotation"
            )
        found[name] = None if name in GIVEN else hints[name]
    return found


class _Written(NamedTuple):
    """A reward or an end as errors of laws name it."""

    role: str
    name: str
    documented: Callable[..., Any]


class InPython:
    """A reward or an end in plain Python: a function of frame, action and own action.

    An end that is no law takes the frame alone.
    """

    def __init__(self, what: str, function: Callable[..., Any], vehicle: Vehicle) -> None:
        self._what, self._function, self._is_law = what, function, is_law(function)
        self._takes_frame_alone = what == "ends"
        self._car = namespace(car_numbers(vehicle))
        self._given: list[str] = []
        # Looked up once: it is called in every step.
        self._reads: dict[str, tuple[Shape, tuple[str, ...]]] = {}
        for name, signal in _asked(what, function).items() if self._is_law else ():
            if signal is None:
                self._given.append(name)
            else:
                self._reads[name] = shape_of(signal), TOPICS[signal].channels

    def __call__(self, here: Mapping[str, Any], action: Any, own: Any) -> Any:
        """The number, or one for each car; LawError in one line for a mistake of a law."""
        if not self._is_law:
            rest = () if self._takes_frame_alone else (action, own)
            return self._function(here, *rest)
        known = {"car": self._car, "action": action, "own": own}
        given = {name: known[name] for name in self._given}
        for name, (shape, channels) in self._reads.items():
            given[name] = shape.signal_of([here.get(channel, 0.0) for channel in channels])
        try:
            # Numbers of an action are numpy's, which divide by zero with no more than a warning.
            with np.errstate(divide="raise", invalid="raise"):
                found = self._function(**given)
            if not isinstance(found, (bool, int, float, np.number, np.bool_)):
                raise WrongResultError(self._function, found, "a number")
        except BY_AUTHORS as error:
            raise_in_one_line(_Written(self._what, "", self._function), error)
        return found


class Judge:
    """The compiled function of reward and end; one that is plain Python gives 0 there."""

    def __init__(self, reward: Reward, ends: Reward, actions: int) -> None:
        self._names: dict[str, Any] = {"FLOAT": np.float64, "Wheels": Wheels}
        self._laws: dict[str, Callable[..., Any]] = {}
        calls: dict[str, str] = {}
        # Made outside the `try`, of which the compiler follows each operation by recursion.
        given: list[str] = []
        for what, function in (("reward", reward), ("ends", ends)):
            self._names[what] = nothing
            if is_law(function):
                self._names[what] = self._laws[what] = function
            arguments: list[str] = []
            for name, signal in _asked(what, self._names[what]).items():
                if signal is not None:
                    given.append(f"    signal_{len(given)} = {made_of_frame(signal, self._names)}")
                    name = f"signal_{len(given) - 1}"
                arguments.append(name)
            calls[what] = ", ".join(arguments)
        self._text = _TEXT.format(size=frame.SIZE, actions=actions, given="\n".join(given), **calls)
        self._actions = actions
        self._addresses: dict[Any, int] = {}

    @property
    def may_never_end(self) -> bool:
        """True if one of the functions is a law of others."""
        return not all(map(_is_ours, self._laws.values()))

    def of(self, vehicle: Vehicle) -> tuple[int, np.ndarray]:
        """The address of the function for a car, and the numbers of the car that it takes."""
        tree = car_numbers(vehicle)
        # Cars differ in the lengths of their tables.
        shape = shape_of_record(tree)
        if shape not in self._addresses:
            self._addresses[shape] = self._address(record_type(tree), vehicle)
        return self._addresses[shape], np.array(numbers(tree))

    def _address(self, car: np.dtype, vehicle: Vehicle) -> int:
        try:
            return Code("judge", self._text, {**self._names, "CAR": car}).address()
        except (ParameterError, OSError, MemoryError):
            raise
        except Exception as error:  # the compiler raises errors of many kinds
            # Plain Python has the better line. Ones, for a law may divide by what it reads.
            ones = np.ones(frame.SIZE), np.ones((2, self._actions))
            self._refuse_in_python(vehicle, *ones)
            first, names = self._named()
            file, line, reason = of_compiler(first, error)
            if isinstance(error, TakesInterpreter):
                reason = "it needs Python, as print does, expected numbers alone"
            raise LawError(
                f"{file}, line {line}: {names}: {reason} (docs/compiled_laws.md)"
            ) from error

    def _named(self) -> tuple[Callable[..., Any], str]:
        """One of the functions, and the names of all that may be wrong: of others before ours."""
        laws = [function for function in self._laws.values() if not _is_ours(function)]
        laws = laws or list(self._laws.values())
        return laws[0], " or ".join(function.__name__ for function in laws)

    def error(self, vehicle: Vehicle, here: np.ndarray, choices: np.ndarray) -> LawError:
        """Error of a call for a car that has just failed, with its frame and its two actions."""
        try:
            self._refuse_in_python(vehicle, here, choices)
        except LawError as error:
            return error
        first, names = self._named()
        file, line = beginning(first)
        return LawError(
            f"{file}, line {line}: {names}: its compiled form fails where plain Python does not;"
            " run it without @compilable"
        )

    def _refuse_in_python(self, vehicle: Vehicle, here: np.ndarray, choices: np.ndarray) -> None:
        """LawError if one of the functions fails in plain Python."""
        by_channel = {name: float(here[place]) for name, place in frame.channels().items()}
        for what, function in self._laws.items():
            InPython(what, function, vehicle)(by_channel, choices[0].copy(), choices[1].copy())
