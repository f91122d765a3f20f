"""A configured method as the checks step it: frame by frame, and all its output as frames.

Its inputs are random but plausible signals, and launches: numbers at random alone never bring into
play what a law limits, estimates and counts over many steps.
"""

import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import method_part
from ev_core.methods.part import Part
from ev_msgs_py.contract import frame, signals
from ev_msgs_py.contract.fields import Field, shape_of
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels

_RADIUS = 0.32  # of the wheels [m]
_PRESSED = 0.15  # probability that the brake is pressed all the time
_RARE = 0.003  # probability in a step that the pedal is let go, or that a measurement is none
_TURNING = 0.02  # probability in a step that a wheel begins to grip or to spin
_BRAKE = 200.0  # N m
_RATE = 0.01  # share of the drive torque by which the pedal goes down in a step
# Largest magnitude by unit; a field that is never negative takes the magnitude.
_LARGEST = {
    "N m": 800.0,
    "rad": 0.6,
    "rad/s": 60.0,
    "m/s": 18.0,
    "m/s^2": 6.0,
    "N": 6000.0,
    "m": 50.0,
    "V": 400.0,
}
_BRAKES = ("brake", "brake_torque")
_REPEATED = 0.2  # probability that a number stays what it was
_ZERO = 0.2  # probability that a number is zero
_FREE = 0.5  # probability that the brake pedal is free for a while
_LONGEST = 40  # steps with numbers at random, behind which a launch may begin
_EXTREME = (0.0, 5e-324, 1e-300, 1e-30, 1e6, 1e20, 3e38, 1e150, 1e300, 1.7976931348623157e308)
_LARGEST_SINGLE = 3e38  # that single precision holds
_ABSURD = 0.3  # probability that a number is absurd


class Launch:
    """Signals of one launch of `steps` steps.

    Wheels slip at random rates, and what they give is that of a tyre.
    """

    def __init__(self, chance: random.Random, period: float) -> None:
        r = self._random = chance
        self._period = period
        self.steps = r.randint(40, 160)
        self._ahead = r.choice((1.0, 1.0, -1.0))
        self._asked = [self._ahead * r.uniform(200.0, 1800.0) for _ in range(4)]
        self._pedal = 0.0
        self._brake = Wheels.all(_BRAKE) if r.random() < _PRESSED else NO_WHEELS
        self._speed = r.choice((0.0, 0.0, r.uniform(0.0, 15.0)))  # of the car [m/s]
        self._pull = r.uniform(0.2, 4.0)  # [m/s^2]
        self._slip = [0.0] * 4
        spins = r.choice(((1.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 1.0), (1.0, 1.0, 1.0, 1.0)))
        self._growth = [spin * r.uniform(0.1, 1.5) for spin in spins]  # [1/s]
        self._angle, self._yaw_rate = (
            r.choice((0.0, r.uniform(-0.4, 0.4))),
            r.choice((0.0, r.uniform(-0.6, 0.6))),
        )

    def next(self) -> Mapping[type, Any]:
        """Signals of the next step by type, those that a launch determines."""
        r = self._random
        self._speed += self._pull * self._period
        if r.random() < _TURNING:
            self._growth[r.randrange(4)] *= -1.0
        grown = zip(self._slip, self._growth, strict=True)
        self._slip = [min(max(slip + growth * self._period, 0.0), 0.9) for slip, growth in grown]
        rolling = self._ahead * self._speed / _RADIUS
        speed = Wheels(*(rolling / (1.0 - slip) + r.gauss(0.0, 0.03) for slip in self._slip))
        share = [math.sqrt(slip / 0.1 + 0.01) / (1.0 + slip / 0.1) for slip in self._slip]
        torque = Wheels(*(asked * each for asked, each in zip(self._asked, share, strict=True)))
        self._pedal = 0.0 if r.random() < _RARE else min(self._pedal + _RATE, 1.0)
        if r.random() < _RARE:
            speed = Wheels.all(1e5)  # no measurement of a road vehicle
        drive = Wheels(*(self._pedal * asked for asked in self._asked))
        sent = (
            signals.DriverCommand(sum(drive), sum(self._brake), 0.0),
            signals.WheelTorqueRequest(drive, self._brake),
            signals.WheelTorqueCommand(drive, self._brake),
            signals.SteeringColumnState(0.0, 0.0, 0.0, self._angle, 0.0),
            signals.WheelStates(NO_WHEELS, speed, torque),
            signals.InertialMeasurement(
                self._yaw_rate, self._ahead * self._pull + r.gauss(0.0, 0.05), r.gauss(0.0, 1.0)
            ),
            signals.BodyVelocity(self._ahead * self._speed, 0.0, self._yaw_rate),
        )
        return {type(signal): signal for signal in sent}


class RandomInputs:
    """Signals of some types for one step after the other, `period` seconds apart.

    For a while all numbers are at random, with the brake pedal pressed or free. Then comes a
    launch, as long as what limits, estimates and counts needs in order to come into play.
    """

    launches = True

    def __init__(self, reads: Sequence[type], seed: int, period: float) -> None:
        self._reads = tuple(reads)
        self._random = random.Random(seed)
        self._period = period
        self._steps = 0
        self._left = 0
        self._launch: Launch | None = None
        self._last: dict[type, Any] = {}

    def next(self) -> tuple[Any, ...]:
        """The signals of the next step, in the order of the types."""
        if self._left == 0:
            self._begin()
        self._left -= 1
        now = signals.Instant(self._steps * self._period)
        self._steps += 1
        moving: Mapping[type, Any] = self._launch.next() if self._launch else {}
        return tuple(
            now if kind is signals.Instant else moving.get(kind) or self._signal(kind)
            for kind in self._reads
        )

    def _begin(self) -> None:
        launches = self.launches and self._launch is None
        self._launch = Launch(self._random, self._period) if launches and self._steps else None
        self._left = self._launch.steps if self._launch else self._random.randint(1, _LONGEST)
        self._is_free = self._random.random() < _FREE

    def _signal(self, kind: type) -> Any:
        shape = shape_of(kind)
        last = self._last.get(kind, (0.0,) * shape.size)
        values = []
        for channel, before in zip(shape.channels, last, strict=True):
            name = channel.partition(".")[0]
            is_released = self._is_free and name in _BRAKES
            values.append(0.0 if is_released else self._number(shape.fields[name], before))
        self._last[kind] = tuple(values)
        return shape.signal_of(tuple(values))

    def _number(self, field: Field, before: float) -> float:
        chance = self._random.random()
        if chance < _REPEATED:
            return before
        if chance < _REPEATED + _ZERO:
            return 0.0
        value = self._random.uniform(-1.0, 1.0) * _LARGEST.get(field.unit, 1.0)
        return abs(value) if field.never_negative else value


class ExtremeInputs(RandomInputs):
    """Random signals without launches, with numbers that no car has.

    They are tiny, or up to the largest of a message.
    """

    launches = False

    def _number(self, field: Field, before: float) -> float:
        plausible = super()._number(field, before)
        if self._random.random() >= _ABSURD:
            return plausible
        value = self._random.choice(_EXTREME)
        if field.single_precision:
            value = min(value, _LARGEST_SINGLE)
        return value if field.never_negative else self._random.choice((-1.0, 1.0)) * value


class Inputs(Protocol):
    """Signals for one step after the other."""

    def next(self) -> tuple[Any, ...]:
        """The signals of the next step, in the order in which the method reads them."""


# Makes inputs from the signals that are read, a seed and the control period [s].
MakesInputs = Callable[[Sequence[type], int, float], Inputs]


@dataclass(frozen=True)
class Subject:
    """The subject of a check: a configured method, in plain Python or compiled, and its inputs."""

    configuration: Configuration
    compiled: bool
    steps: int
    inputs: MakesInputs = RandomInputs

    @property
    def form(self) -> str:
        """The way in which it runs, in words."""
        return "compiled" if self.compiled else "in plain Python"

    def part(self) -> Part:
        """A new part, at rest; heavy laws are compiled in any case."""
        part: Part = method_part(self.configuration, self.compiled)
        return part

    def frames(self, seed: int) -> np.ndarray:
        """Frames of the inputs, step by step: (steps, frame.SIZE)."""
        method, period = self.configuration.method, self.configuration.common.control_period
        return _frames(self.inputs, method.reads, seed, period, self.steps)


@lru_cache(maxsize=8)  # each check asks for the same ones
def _frames(
    make_inputs: MakesInputs, reads: tuple[type, ...], seed: int, period: float, steps: int
) -> np.ndarray:
    inputs, frames = make_inputs(reads, seed, period), np.zeros((steps, frame.SIZE))
    for here in frames:
        for kind, signal in zip(reads, inputs.next(), strict=True):
            if kind is Instant:
                here[frame.TIME] = signal.time
            else:
                here[frame.PLACES[kind]] = shape_of(kind).flat(signal)
    frames.flags.writeable = False
    return frames


def stepped(part: Part, here: np.ndarray) -> np.ndarray:
    """All output of a part in one step, as a frame: (frame.SIZE,)."""
    given, there = here.copy(), np.zeros(frame.SIZE)
    part.step(Frame.of(given), Frame.of(there))
    return there


def outputs(part: Part, frames: np.ndarray) -> np.ndarray:
    """All output of a part in one step after the other: (steps, frame.SIZE)."""
    return np.array([stepped(part, here) for here in frames])


def difference(subject: Subject, one: np.ndarray, other: np.ndarray) -> str:
    """The first place where two runs differ in their bits, with both values.

    Empty if there is none. The numbers of a state follow those of a frame.
    """
    found = np.argwhere(one.view(np.int64) != other.view(np.int64))
    if not len(found):
        return ""
    step, place = found[0]
    written: dict[int, str] = {}
    for kind in subject.configuration.method.writes:
        for channel, number in zip(shape_of(kind).channels, frame.places(kind), strict=True):
            written[number] = f"{kind.__name__}.{channel}"
    otherwise = (
        f"number {place - frame.SIZE} of the state"
        if place >= frame.SIZE
        else "what it does not write"
    )
    return (
        f"step {step}: {written.get(place, otherwise)} is {one[step, place]!s} and "
        f"{other[step, place]!s}"
    )
