"""Methods of the role asr that break the contract, each in one way.

Not registered, so that no list shows them.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, entry, parameter
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.law import Law
from ev_core.methods.method_record import Method


@dataclass(frozen=True, slots=True)
class Gain:
    """Parameters of a gain."""

    gain: float = parameter(
        1.0, unit="1", low=0.0, high=10.0, about="torque over what is asked for"
    )


@dataclass(slots=True)
class Count:
    """State that counts the steps."""

    steps: float = entry(unit="1")


def configuration_of(factory: Any, parameters: Any = Gain) -> Configuration:
    """A method of a class or a law."""
    return Configuration(
        "asr",
        Method("asr", "toy", factory, (WheelTorqueRequest,), parameters),
        parameters(),
        CommonParameters(),
        None,
    )


def times(factor: float, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """The torques times a factor."""
    return WheelTorqueCommand(Wheels(*(factor * torque for torque in request.drive)), request.brake)


class Good:
    """Counts its steps and lets pass what is asked for: keeps the contract."""

    parameters = Gain
    mirrored = True

    def __init__(self, parameters: Gain, vehicle: Any, period: float) -> None:
        self.gain = parameters.gain
        self.state = [0.0]

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        self.state = [self.state[0] + 1.0]
        return self.answer(request)

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(self.gain, request)


class Drawing(Good):
    """Uses the random numbers of the process."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(random.random(), request)


class Seeding(Good):
    """The same, and seeds them for itself: right as long as it is alone."""

    def __init__(self, parameters: Gain, vehicle: Any, period: float) -> None:
        super().__init__(parameters, vehicle, period)
        random.seed(1)

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(random.random(), request)


class Sharing(Good):
    """Keeps what it learns where all of its objects see it, and forgets it when one is made."""

    shared: list[float]

    def __init__(self, parameters: Gain, vehicle: Any, period: float) -> None:
        super().__init__(parameters, vehicle, period)
        Sharing.shared = [0.0]

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        Sharing.shared[0] += request.drive[0]
        return times(Sharing.shared[0], request)


class Hiding(Good):
    """Has a filter that is not in the state."""

    def __init__(self, parameters: Gain, vehicle: Any, period: float) -> None:
        super().__init__(parameters, vehicle, period)
        self.before = 0.0

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        self.before += 0.1 * (request.drive[0] - self.before)
        return WheelTorqueCommand(Wheels.all(self.before), request.brake)


class Stirring(Good):
    """Its state is a text."""

    def __init__(self, parameters: Gain, vehicle: Any, period: float) -> None:
        super().__init__(parameters, vehicle, period)
        self.state = "at rest"

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(self.gain, request)


class Dividing(Good):
    """Divides by what can be zero."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(1.0 / request.drive[0], request)


class AnsweringNan(Good):
    """Answers NaN to a negative torque."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(math.nan if request.drive[0] < 0.0 else 1.0, request)


class Poisoned(Good):
    """NaN stays in its state once two huge torques were asked for, and the answers hide it."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        huge = request.drive[0] * 1e300
        self.state = [self.state[0] + (huge - huge)]
        return times(
            0.0 if math.isnan(self.state[0]) else 0.5,
            WheelTorqueRequest(Wheels.all(1.0), request.brake),
        )


class Overflowing(Good):
    """Takes whole numbers of all numbers."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(
            float(math.floor(request.drive[0] * 1e200) % 2),
            WheelTorqueRequest(Wheels.all(1.0), request.brake),
        )


class Leaning(Good):
    """Gives the left wheels more, and says that left and right are alike to it."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        drive = Wheels(*(t * k for t, k in zip(request.drive, (1.1, 1, 1, 1), strict=True)))
        return WheelTorqueCommand(drive, request.brake)


class Working(Good):
    """Passes requests on under pressed brakes, and does what is wrong while they are free."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(1.0 if max(request.brake) > 0.0 else math.nan, request)


class Pulling(Good):
    """Answers a negative brake torque, which drives."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return WheelTorqueCommand(request.drive, Wheels.all(-1.0))


class Sleeping(Good):
    """Works at a torque that no input has."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return self.work(request) if request.drive[0] > 1e5 else times(1.0, request)

    def work(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return times(0.5, request)


class Rounding(Good):
    """Adds wheel by wheel: a mirrored car gets another last bit."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        a, b, c, d = request.drive
        return WheelTorqueCommand(Wheels.all(a + b + c + d), request.brake)


class Rolling(Good):
    """Drops the brakes."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return WheelTorqueCommand(request.drive)


class Standing(Good):
    """Drops the drive."""

    def answer(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return WheelTorqueCommand(Wheels.all(0.0), request.brake)


def loading(parameters: Gain) -> Gain:
    """The parameters twice as large, each time."""
    return Gain(min(2.0 * parameters.gain, 10.0))


class Loading(Good):
    """Makes other parameters of its parameters whenever they are set."""

    load_files = staticmethod(loading)


@compilable
def wrapping(p: Gain, s: Count, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A whole number that Python holds, and compiled code does not."""
    s.steps += 1.0
    large = int(s.steps) * 4611686018427387904 * 4
    _, front_right, rear_left, rear_right = request.drive
    return WheelTorqueCommand(
        Wheels(float(large), front_right, rear_left, rear_right), request.brake
    )


WRAPPING = Law(wrapping, Gain, Count)

# What the error says of each of them.
FINDINGS: tuple[tuple[Any, str], ...] = (
    (Drawing, "the same inputs give other outputs the second time"),
    (Seeding, "another object of the method disturbs it"),
    (Sharing, "another object of the method disturbs it"),
    (Hiding, "the state does not hold all that lasts"),
    (Stirring, "the state is str"),
    (Dividing, "ZeroDivisionError"),
    (AnsweringNan, "WheelTorqueCommand.drive.front_left is nan"),
    (Working, "WheelTorqueCommand.drive.front_left is nan"),
    (Pulling, "WheelTorqueCommand.brake.front_left is -1.0, expected 0 or more"),
    (Poisoned, "absurd inputs leave NaN in the state"),
    (Overflowing, "OverflowError"),
    (Leaning, "left and right are not alike"),
    (Rounding, "left and right are not alike"),
    (Rolling, "WheelTorqueRequest.brake has no effect: the same torques with 300 N m as without"),
    (Standing, "WheelTorqueRequest.drive has no effect: the same torques with 300 N m as without"),
    (Loading, "parameters that are set to their own values are other ones"),
    (WRAPPING, "compiled and interpreted differ, step 0"),
)
