"""What sensors measure: the fields of the signals, by the sensor that each of them names."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, make_dataclass
from functools import cache

from ev_core.parameters.declaration import group
from ev_core.sensors.measuring import HEADING, NUMBERS, SHARE
from ev_core.sensors.sensor import sensor_parameters
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.optional_signals import (
    BenchElectrical,
    BenchShafts,
    BenchTemperatures,
    CellCondition,
    MotorElectrics,
    MotorTemperatures,
    RearSteeringState,
)
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    SteeringColumnState,
    TireForces,
    WheelStates,
)
from ev_msgs_py.contract.wheels import WHEEL_NAMES

# In the order of the parameter reference. What nobody measures (commands, the recorder) is not among them.
_OF_CIRCUITS = (BenchShafts, BenchElectrical, BenchTemperatures)


_MEASURED = (
    WheelStates,
    MotorStates,
    InertialMeasurement,
    BodyVelocity,
    BodyPose,
    BatteryCondition,
    TireForces,
    MotorElectrics,
    MotorTemperatures,
    CellCondition,
    SteeringColumnState,
    RearSteeringState,
    *_OF_CIRCUITS,
)


# A heading is carried by two numbers of a quaternion, a charge is a share of the capacity: how, and in which order.
_SPECIAL = {
    "body_heading": (HEADING, ("orientation_z", "orientation_w"), ""),
    "battery_state_of_charge": (SHARE, ("state_of_charge", "charge"), "capacity"),
}


@dataclass(frozen=True)
class Quantity:
    """Fields of a signal that one sensor measures; its parameters accept errors up to `largest`, in `unit`.

    `kind` says how the fields carry what is measured: as its numbers; as z and w of a quaternion; or as a share and the
    amount that this is of a further field, `whole`.
    """

    name: str
    signal: type
    fields: tuple[str, ...]
    kind: int = NUMBERS
    whole: str = ""

    @property
    def unit(self) -> str:
        """Unit of the numbers and of the sensor's errors."""
        return "rad" if self.kind == HEADING else shape_of(self.signal).fields[self.fields[0]].unit

    @property
    def largest(self) -> float:
        """Largest error that the parameters accept, in the unit."""
        return shape_of(self.signal).fields[self.fields[0]].largest

    @property
    def parameters(self) -> type:
        """The parameter dataclass of its sensor."""
        return sensor_parameters(self.unit, self.largest)

    @property
    def places(self) -> tuple[int, ...]:
        """Where its fields stand in the frame, and then the whole; numbers stand one after the other."""
        channels = shape_of(self.signal).channels
        fields = (*self.fields, self.whole)
        begin = frame.PLACES[self.signal].start
        return tuple(begin + i for f in fields for i, name in enumerate(channels) if name.partition(".")[0] == f)

    @property
    def count(self) -> int:
        """How many numbers have errors."""
        return len(self.places) if self.kind == NUMBERS else 1

    def parts(self, driven: Collection[str]) -> list[range]:
        """Which of these numbers there are with wheels `driven`: a test bench has circuits for their axles only."""
        if self.signal not in _OF_CIRCUITS:
            return [range(self.count)]
        axles = [any(wheel in driven for wheel in WHEEL_NAMES[i : i + 2]) for i in (0, 2)]
        return [range(i, i + 2) for i in range(0, self.count, 2) if axles[i // 2 % 2]]


def _quantities(signal: type) -> list[Quantity]:
    """What the sensors of a signal measure, in the order of its fields."""
    fields: dict[str, tuple[str, ...]] = {}
    for name, field in shape_of(signal).fields.items():
        if field.sensor:
            fields[field.sensor] = (*fields.get(field.sensor, ()), name)
    kinds = {sensor: _SPECIAL.get(sensor, (NUMBERS, names, "")) for sensor, names in fields.items()}
    return [Quantity(sensor, signal, names, kind, whole) for sensor, (kind, names, whole) in kinds.items()]


QUANTITIES = tuple(quantity for signal in _MEASURED for quantity in _quantities(signal))


@cache
def sensors_for(signals: tuple[type, ...]) -> type:
    """The parameter dataclass with one group for each quantity of these signals, by its name."""
    groups = [(q.name, q.parameters, group(q.parameters)) for q in QUANTITIES if q.signal in signals]
    return make_dataclass("Sensors", groups, frozen=True, slots=True)
