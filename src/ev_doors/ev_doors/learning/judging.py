"""Reward and end of an episode: a compiled function for many cars, the same text in plain Python.

How it works: a function that is marked as `compilable` names what it needs, `car`, `action` and
`own` first, then signals, as a law does. Reward and end make up one C function, which reads them in
the frame of a car. Any other function takes the frame as a mapping by channel, the action, and the
action that stands for the own law: numbers of one car, or arrays of many.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, get_type_hints

import numpy as np

from ev_core.compiled.part_source import made_of_frame
from ev_core.compiling.machine_code import Code
from ev_core.methods.law import namespace
from ev_core.parameters.record import numbers, record_type, shape_of_record
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.compilable import FUNCTIONS, compilable
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import Shape, shape_of
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError, quoted

Reward = Callable[..., Any]
GIVEN = ("car", "action", "own")
_TEXT = '''"""Reward and end of an episode: generated, do not edit."""

from numba import carray, cfunc, types

P = types.voidptr


@cfunc(types.int32(P, P, P, P), error_model="numpy")
def step(now, next, state, constants):
    here = carray(now, {size}, FLOAT)
    there = carray(next, 2, FLOAT)
    choice = carray(state, (2, {actions}), FLOAT)
    action, own = choice[0], choice[1]
    car = carray(constants, 1, CAR)[0]
    there[0] = reward({reward})
    there[1] = ends({ends})
    return 0
'''


def is_law(function: Any) -> bool:
    """Return whether a reward or an end is written as a law, to be compiled."""
    return function in FUNCTIONS


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


class InPython:
    """A reward or an end in plain Python: a function of frame, action and own action.

    An end that is no law takes the frame alone.
    """

    def __init__(self, what: str, function: Callable[..., Any], vehicle: Vehicle) -> None:
        self._function, self._is_law = function, is_law(function)
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
        """The number, or one for each car."""
        if not self._is_law:
            rest = () if self._takes_frame_alone else (action, own)
            return self._function(here, *rest)
        known = {"car": self._car, "action": action, "own": own}
        given = {name: known[name] for name in self._given}
        for name, (shape, channels) in self._reads.items():
            given[name] = shape.signal_of([here.get(channel, 0.0) for channel in channels])
        return self._function(**given)


class Judge:
    """The compiled function of reward and end; one that is plain Python gives 0 there."""

    def __init__(self, reward: Reward, ends: Reward, actions: int) -> None:
        self._names: dict[str, Any] = {"FLOAT": np.float64, "Wheels": Wheels}
        calls: dict[str, str] = {}
        for what, function in (("reward", reward), ("ends", ends)):
            self._names[what] = function if is_law(function) else nothing
            arguments: list[str] = []
            for name, signal in _asked(what, self._names[what]).items():
                arguments.append(name if signal is None else made_of_frame(signal, self._names))
            calls[what] = ", ".join(arguments)
        self._text = _TEXT.format(size=frame.SIZE, actions=actions, **calls)
        self._addresses: dict[Any, int] = {}

    def of(self, vehicle: Vehicle) -> tuple[int, np.ndarray]:
        """The address of the function for a car, and the numbers of the car that it takes."""
        tree = car_numbers(vehicle)
        # Cars differ in the lengths of their tables.
        shape = shape_of_record(tree)
        if shape not in self._addresses:
            self._addresses[shape] = self._address(record_type(tree))
        return self._addresses[shape], np.array(numbers(tree))

    def _address(self, car: np.dtype) -> int:
        try:
            return Code("judge", self._text, {**self._names, "CAR": car}).address()
        except (ParameterError, OSError, MemoryError):
            raise
        except Exception as error:  # the compiler raises errors of many kinds
            names = f"{self._names['reward'].__name__} or {self._names['ends'].__name__}"
            lines = [line for line in str(error).splitlines() if line and "nopython" not in line]
            reason = lines[0] if lines else type(error).__name__
            raise ParameterError(
                f"{names} cannot be compiled: {reason}; expected what a law may do"
                " (docs/compiled_laws.md)"
            ) from error
