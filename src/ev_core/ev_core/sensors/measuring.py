"""Sensors in the frame: their output takes the place of the true numbers, once per control period.

A row of numbers has the settings of the sensors behind one object, another one what lasts between
periods:

    constants  total  size of the state  sensors
               then for each sensor the numbers from KIND to FIRST
    state      period
               then for each sensor whether it has begun, its output, what is on its way
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import auto
from functools import cache
from typing import Protocol

import numpy as np

from ev_core.elementary import atan2, cos, isfinite, remainder, sin
from ev_core.parameters.declaration import Choice, setting
from ev_core.sensors.random_numbers import TAU, WORD, normals, philox, uniform
from ev_msgs_py.compilable import compilable
from ev_msgs_py.refusal import ParameterError

_NO_RANGE = 1e30
# How the frame carries what is measured: as numbers one after the other; as two numbers of a
# quaternion about one axis; as a share and the amount that it is of the whole.
NUMBERS, HEADING, SHARE = range(3)
# The settings of a sensor. Three places: of the first number, or of z and w, or of share, amount
# and whole; MEMORY is that of its own numbers in the state, FIRST how many pairs of its numbers are
# measured in front of these.
SENSOR_WIDTH = 20
(
    KIND,
    PLACE,
    SECOND,
    THIRD,
    COUNT,
    ROUNDS,
    MEMORY,
    BIAS,
    NOISE,
    QUANTISATION,
    DELAY,
    DROPOUT,
    SEED,
    SENSOR_NAME,
) = range(14)
GAIN, LOWEST, HIGHEST, DISTRIBUTION, NOISE_OF_READING, FIRST = range(14, SENSOR_WIDTH)
SENSORS_HEAD = 3
# The last word of the counter is the purpose of a random number.
FOR_NOISE, FOR_DROPOUT = range(2)


class Distribution(Choice):
    """Distributions of a random error."""

    GAUSSIAN = auto()
    UNIFORM = auto()


@cache
def sensor_parameters(unit: str, largest: float) -> type:
    """The parameter dataclass of a sensor for numbers in `unit` and errors up to `largest`.

    By default it is ideal.
    """

    @dataclass(frozen=True, slots=True)
    class SensorParameters:
        """Errors of one sensor, in the order in which they come about."""

        gain: float = setting(
            1.0, unit="1", low=0.5, high=2.0, about="what is shown over what is true"
        )
        bias: float = setting(0.0, unit=unit, low=-largest, high=largest, about="constant error")
        noise: float = setting(
            0.0,
            unit=unit,
            low=0.0,
            high=largest,
            about="size of the random error, new in every period: `distribution`",
        )
        bias_of_range: float = setting(
            0.0,
            unit="1",
            low=-1.0,
            high=1.0,
            about="constant error over the range from lowest to highest, on top",
        )
        noise_of_reading: float = setting(
            0.0,
            unit="1",
            low=0.0,
            high=1.0,
            about="random error over the true value, on top of `noise`",
        )
        noise_of_range: float = setting(
            0.0,
            unit="1",
            low=0.0,
            high=1.0,
            about="random error over lowest to highest, on top of `noise`",
        )
        distribution: Distribution = setting(
            Distribution.GAUSSIAN,
            about="of the random error; gaussian: its standard deviation is `noise`; uniform: "
            "`noise` is its bound",
        )
        lowest: float = setting(
            -_NO_RANGE,
            unit=unit,
            low=-_NO_RANGE,
            high=_NO_RANGE,
            about="smallest value that it can show",
        )
        highest: float = setting(
            _NO_RANGE,
            unit=unit,
            low=-_NO_RANGE,
            high=_NO_RANGE,
            about="largest value that it can show",
        )
        quantisation: float = setting(
            0.0,
            unit=unit,
            low=0.0,
            high=largest,
            about="distance between the values that it can show; 0: shows all",
        )
        delay: int = setting(
            0, unit="1", low=0, high=1000, about="age of the value, in whole control periods"
        )
        dropout: float = setting(
            0.0,
            unit="1",
            low=0.0,
            high=1.0,
            about="probability that a period brings no value and the last one stays",
        )

        def __post_init__(self) -> None:
            if self.lowest > self.highest:
                raise ParameterError(
                    f"lowest is {self.lowest:g}, expected at most highest, {self.highest:g}"
                )
            for name in ("bias_of_range", "noise_of_range"):
                if getattr(self, name) != 0.0 and max(-self.lowest, self.highest) >= _NO_RANGE:
                    raise ParameterError(f"{name} needs a range: lowest and highest")

        @property
        def offset(self) -> float:
            """Constant error in all."""
            # Without a range its width is so large that a share of 0 would not be 0.
            if not self.bias_of_range:
                return self.bias
            return self.bias + self.bias_of_range * (self.highest - self.lowest)

        @property
        def least_noise(self) -> float:
            """Size of the random error of a true value of 0."""
            if not self.noise_of_range:
                return self.noise
            return self.noise + self.noise_of_range * (self.highest - self.lowest)

    return SensorParameters


class Numbers(Protocol):
    """A row of numbers that are changed in place: a list, an array, the memory of a frame."""

    def __getitem__(self, place: int, /) -> float: ...

    def __setitem__(self, place: int, number: float, /) -> None: ...


@compilable
def measure(frame: Numbers, state: Numbers, sensors: Sequence[float]) -> None:
    """Let all sensors show what they make of the true numbers in a frame."""
    period = int(state[0])
    for n in range(int(sensors[2])):
        begin = SENSORS_HEAD + n * SENSOR_WIDTH
        show(frame, state, sensors[begin : begin + SENSOR_WIDTH], period)
    state[0] += 1.0


@compilable
def show(frame: Numbers, state: Numbers, c: Sequence[float], period: int) -> None:
    """One sensor with all its numbers.

    Gain, bias, noise, range, quantisation, delay and drop-out act in this order.
    """
    count, begun, delay = int(c[COUNT]), int(c[MEMORY]), int(c[DELAY])
    shown, is_first = begun + 1, state[begun] == 0.0
    is_lost = not is_first and is_dropped(c, period)
    spare = 0.0
    for i in range(count):
        # Random numbers come in pairs: one for this number, the spare one for the next.
        normal = spare
        if c[NOISE] + c[NOISE_OF_READING] > 0.0 and i % 2 == 0:
            w0, w1, w2, w3 = words(c, period, int(c[FIRST]) + i // 2, FOR_NOISE)
            if c[DISTRIBUTION] == Distribution.UNIFORM:
                normal, spare = 2.0 * uniform(w0, w1) - 1.0, 2.0 * uniform(w2, w3) - 1.0
            else:
                normal, spare = normals(w0, w1, w2, w3)
        value = sampled(true_number(frame, c, i), normal, c)
        if delay > 0:
            # A line of `delay` values: the one from so many periods ago gives way to the newest.
            line = shown + count + i
            if is_first:
                # As if the first value had always been there.
                for age in range(delay):
                    state[line + age * count] = value
            here = line + (period % delay) * count
            newest, value = value, state[here]
            state[here] = newest
        if not is_lost:
            state[shown + i] = value
        write(frame, c, i, state[shown + i])
    state[begun] = 1.0


@compilable
def words(c: Sequence[float], period: int, block: int, purpose: int) -> tuple[int, int, int, int]:
    """Four random words of a sensor in a period; the key is the seed and the name."""
    return philox(period & WORD, period >> 32, block, purpose, int(c[SEED]), int(c[SENSOR_NAME]))


@compilable
def is_dropped(c: Sequence[float], period: int) -> bool:
    """Return whether the value of a period is lost, with the probability `dropout`."""
    if c[DROPOUT] == 0.0:
        return False
    w0, w1, _, _ = words(c, period, 0, FOR_DROPOUT)
    return uniform(w0, w1) < c[DROPOUT]


@compilable
def sampled(true: float, normal: float, c: Sequence[float]) -> float:
    """A number with systematic and random errors, at the nearest value that can be shown."""
    size = c[NOISE]
    # A share of 0 of an infinite number would be no number.
    if c[NOISE_OF_READING] > 0.0:
        size += c[NOISE_OF_READING] * abs(true)
    value = c[GAIN] * true + c[BIAS] + size * normal
    # Passed on as it is: the part names a number that is not finite.
    if not isfinite(value):
        return value
    value = min(max(value, c[LOWEST]), c[HIGHEST])
    if c[QUANTISATION] == 0.0:
        return value
    value -= remainder(value, c[QUANTISATION])
    # Where the nearest step lies beyond the range, it shows the one before.
    if value > c[HIGHEST]:
        value -= c[QUANTISATION]
        value -= remainder(value, c[QUANTISATION])
    elif value < c[LOWEST]:
        value += c[QUANTISATION]
        value -= remainder(value, c[QUANTISATION])
    return min(max(value, c[LOWEST]), c[HIGHEST])


@compilable
def true_number(frame: Numbers, c: Sequence[float], i: int) -> float:
    """Number i of those that are measured; a heading lies in -pi..pi [rad]."""
    place = int(c[PLACE])
    if c[KIND] == HEADING:
        return remainder(2.0 * atan2(frame[place], frame[int(c[SECOND])]), TAU)
    return frame[place + i]


@compilable
def write(frame: Numbers, c: Sequence[float], i: int, number: float) -> None:
    """Put number i into the frame, as its message carries it."""
    place, second = int(c[PLACE]), int(c[SECOND])
    if c[KIND] == HEADING:
        frame[place], frame[second] = sin(0.5 * number), cos(0.5 * number)
    else:
        frame[place + i] = carried(number, c[ROUNDS])
        if c[KIND] == SHARE:
            frame[second] = carried(frame[place] * frame[int(c[THIRD])], c[ROUNDS])


@compilable
def carried(number: float, rounds: float) -> float:
    """The number in the precision of its message, which is single where that `rounds`."""
    return float(np.float32(number)) if rounds == 1.0 else number
