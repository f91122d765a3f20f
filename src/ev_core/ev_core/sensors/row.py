"""The sensors behind one object.

The quantities that they measure, and their settings and state as two rows of numbers. The
quantities are the fields of the signals, by the sensor that each of them names.
"""

import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass, make_dataclass
from functools import cache
from typing import Any

from ev_core.parameters.declaration import defaults, group
from ev_core.sensors import measuring
from ev_msgs_py.contract import frame, signals
from ev_msgs_py.contract import optional_signals as optional
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.wheels import WHEEL_NAMES

# In the order of the parameter reference, without signals that no sensor measures (commands, the
# recorder).
_OF_CIRCUITS = (
    optional.BenchShafts,
    optional.BenchElectrical,
    optional.BenchTemperatures,
    optional.BenchCoolant,
)

_MEASURED = (
    signals.WheelStates,
    signals.MotorStates,
    signals.InertialMeasurement,
    signals.BodyVelocity,
    signals.BodyPose,
    signals.BatteryCondition,
    signals.TireForces,
    optional.BodyRoll,
    optional.MotorElectrics,
    optional.MotorTemperatures,
    optional.CellCondition,
    signals.SteeringColumnState,
    optional.RearSteeringState,
    *_OF_CIRCUITS,
    optional.BatteryCoolant,
)

# An angle is carried by two numbers of a quaternion, a charge is a share of the capacity: how, and
# in which order.
_SPECIAL = {
    "body_roll": (measuring.HEADING, ("orientation_x", "orientation_w"), ""),
    "body_heading": (measuring.HEADING, ("orientation_z", "orientation_w"), ""),
    "battery_state_of_charge": (measuring.SHARE, ("state_of_charge", "charge"), "capacity"),
}


@dataclass(frozen=True)
class Quantity:
    """Fields of a signal that one sensor measures.

    Its parameters accept errors up to `largest`, in `unit`. `kind` is the form of what is measured
    in the fields: its numbers; two of a quaternion; or a share and the amount that this is of a
    further field, `whole`.
    """

    name: str
    signal: type
    fields: tuple[str, ...]
    kind: int = measuring.NUMBERS
    whole: str = ""

    @property
    def unit(self) -> str:
        """Unit of the numbers and of the sensor's errors."""
        if self.kind == measuring.HEADING:
            return "rad"  # of the angle, not of the parts of a quaternion
        return shape_of(self.signal).fields[self.fields[0]].unit

    @property
    def largest(self) -> float:
        """Largest error that the parameters accept, in the unit."""
        return shape_of(self.signal).fields[self.fields[0]].largest

    @property
    def parameters(self) -> type:
        """The parameter dataclass of its sensor."""
        return measuring.sensor_parameters(self.unit, self.largest)

    @property
    def places(self) -> tuple[int, ...]:
        """Places of its fields in the frame, and then those of the whole, number by number."""
        begin = frame.PLACES[self.signal].start
        places: list[int] = []
        for wanted in (*self.fields, self.whole):
            for i, channel in enumerate(shape_of(self.signal).channels):
                if channel.partition(".")[0] == wanted:
                    places.append(begin + i)
        return tuple(places)

    @property
    def count(self) -> int:
        """Count of the numbers that have errors."""
        return len(self.places) if self.kind == measuring.NUMBERS else 1

    def parts(self, driven: Collection[str]) -> list[range]:
        """Ranges of these numbers that exist with wheels `driven`.

        A test bench has circuits for their axles only.
        """
        if self.signal not in _OF_CIRCUITS:
            return [range(self.count)]
        found: list[range] = []
        # Two numbers for an axle, front and rear by turns.
        for begin in range(0, self.count, 2):
            axle = WHEEL_NAMES[begin % 4 : begin % 4 + 2]
            if any(wheel in driven for wheel in axle):
                found.append(range(begin, begin + 2))
        return found


def _quantities(signal: type) -> list[Quantity]:
    """Quantities that the sensors of a signal measure, in the order of its fields."""
    fields: dict[str, tuple[str, ...]] = {}
    for name, field in shape_of(signal).fields.items():
        if field.sensor:
            fields[field.sensor] = (*fields.get(field.sensor, ()), name)
    found: list[Quantity] = []
    for sensor, own in fields.items():
        kind, names, whole = _SPECIAL.get(sensor, (measuring.NUMBERS, own, ""))
        found.append(Quantity(sensor, signal, names, kind, whole))
    return found


QUANTITIES = tuple(quantity for signal in _MEASURED for quantity in _quantities(signal))


@cache
def sensors_for(signals: tuple[type, ...]) -> type:
    """The parameter dataclass with one group for each quantity of these signals, by its name."""
    groups = [
        (q.name, q.parameters, group(q.parameters)) for q in QUANTITIES if q.signal in signals
    ]
    return make_dataclass("Sensors", groups, frozen=True, slots=True)


class Row:
    """Sensors or faults behind one object.

    Rows of their settings, `width` behind a `head`, and of their state. Those with the same
    settings at `key` remember the same numbers; their place in the state is the one at `memory`.
    """

    constants: list[float]
    head: int
    width: int
    key: tuple[int, ...]
    memory: int
    _size = 0

    def start(self) -> None:
        """Go back to the beginning, before the first period."""
        self.state = [0.0] * self._size

    def go_on_from(self, other: Any) -> None:
        """Take over the memory of the same sensors or faults.

        Others begin with the present numbers.
        """
        before = dict(other.memories())
        for name, place in self.memories():
            if name in before:
                self.state[place] = other.state[before[name]]

    def memories(self) -> Iterator[tuple[tuple[float, ...], slice]]:
        """Name of each one, and the slice of its numbers in the state."""
        places = range(self.head, len(self.constants), self.width)
        # The memory of each one ends where that of the next begins.
        begins = [int(self.constants[n + self.memory]) for n in places]
        for n, begin, end in zip(places, begins, [*begins[1:], len(self.state)], strict=False):
            yield tuple(self.constants[n + k] for k in self.key), slice(begin, end)


class SensorRow(Row):
    """Those of some sensors that are not ideal; `parameters` are as `sensors_for` declares them.

    With fewer wheels `driven` a test bench has fewer channels. `constants` and `state` are rows of
    numbers as `measuring` has them, the state all that lasts.
    """

    head = measuring.SENSORS_HEAD
    width = measuring.SENSOR_WIDTH
    memory = measuring.MEMORY
    key = (measuring.SENSOR_NAME, measuring.FIRST, measuring.COUNT, measuring.DELAY)

    def __init__(self, parameters: Any, seed: int, driven: Collection[str] = WHEEL_NAMES) -> None:
        self.constants = [0.0] * measuring.SENSORS_HEAD
        self._size = 1  # the first number of the state is the period
        for quantity, errors in imperfect(parameters):
            for part in quantity.parts(driven):
                self.constants += self._numbers_of(quantity, errors, seed, part)
        total = len(self.constants)
        self.constants[: measuring.SENSORS_HEAD] = (
            float(total),
            float(self._size),
            float((total - measuring.SENSORS_HEAD) // measuring.SENSOR_WIDTH),
        )
        self.start()

    def _numbers_of(self, quantity: Quantity, errors: Any, seed: int, part: range) -> list[float]:
        places = quantity.places
        if quantity.kind == measuring.NUMBERS:
            places = places[part.start : part.start + 1]  # the others follow the first one
        memory = self._size
        # Whether it has begun; then for each number its output, and what is on its way.
        self._size += 1 + len(part) * (1 + errors.delay)
        # In the order of the settings in `measuring`.
        settings = (
            quantity.kind,
            *places,
            *[0] * (3 - len(places)),
            len(part),
            shape_of(quantity.signal).has_single,
            memory,
            errors.offset,
            errors.least_noise,
            errors.quantisation,
            errors.delay,
            errors.dropout,
            seed,
            zlib.crc32(quantity.name.encode()),
            errors.gain,
            errors.lowest,
            errors.highest,
            errors.distribution,
            errors.noise_of_reading,
            part.start // 2,
        )
        return [float(value) for value in settings]

    def go_on_from(self, other: Any) -> None:
        """Go on in the period where others were.

        A sensor that has another delay or was not there begins with it.
        """
        self.state[0] = other.state[0]
        super().go_on_from(other)

    def step(self, frame: measuring.Numbers) -> None:
        """Put what the sensors show into a frame of true numbers.

        Once per period, the first time at the start.
        """
        measuring.measure(frame, self.state, self.constants)


def imperfect(parameters: Any) -> Iterator[tuple[Quantity, Any]]:
    """The quantities with sensor errors, and these errors."""
    for quantity in QUANTITIES:
        errors = getattr(parameters, quantity.name, None)
        kind: Any = type(errors)
        if errors is not None and errors != defaults(kind):
            yield quantity, errors
