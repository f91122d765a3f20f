"""Signals that only some graphs have, such as those of drives in speed mode and the bench.

Each payload of the bus is two words of 32 bits, which a float64 holds exactly; -1: no frame. A
period has a place for each tick of 1 ms, of which the first ones are used; what comes less often
has one place.
"""

import math
from itertools import chain
from typing import Annotated, Any, NamedTuple

from ev_msgs_py.contract.fields import Field, leftward, magnitude
from ev_msgs_py.contract.wheels import Wheels

MOST_TICKS = 5  # of 1 ms, in a control period
_WARM = "battery_coolant_temperature"


def _halves(name: str, frame: str) -> list[tuple[str, Any]]:
    """The two fields of a payload."""
    low = Field("1", "bits 0 to 31 of the payload", f"{frame}.position")
    high = Field("1", "bits 32 to 63 of the payload", f"{frame}.velocity")
    return [(f"{name}_low", Annotated[float, low]), (f"{name}_high", Annotated[float, high])]


def _set_points(device: str) -> list[tuple[str, Any]]:
    found = []
    for tick in range(MOST_TICKS):
        found += _halves(f"{device}_{tick}", f"{device}_set_point_{tick}")
    return found


def _heartbeat(circuit: str) -> tuple[str, Any]:
    """Its one field, because so short a payload has no other half."""
    name = f"heartbeat_{circuit}"
    return name, _halves(name, name)[0][1]


def _feedback(device: str) -> list[tuple[str, Any]]:
    names = [f"{device}_motion_{tick}" for tick in range(MOST_TICKS)]
    names += [f"{device}_{kind}" for kind in ("electrical", "temperatures", "faults")]
    return list(chain.from_iterable(_halves(name, name) for name in names))


def _signal(name: str, *fields: list[tuple[str, Any]]) -> Any:
    return NamedTuple(name, list(chain.from_iterable(fields)))


_SET_POINTS: Any = _signal(
    "SetPointFrames",
    *map(_set_points, ("drive_11", "drive_12")),
    [_heartbeat("11"), _heartbeat("12")],
    *map(_set_points, ("load_11", "load_12")),
)
_FEEDBACK: Any = _signal(
    "FeedbackFrames", *map(_feedback, ("drive_11", "drive_12", "load_11", "load_12"))
)


class SetPointFrames(_SET_POINTS):  # type: ignore[misc]  # its fields are made above
    """Frames that the controller puts on the bus in the ticks from this instant on."""

    __slots__ = ()


class FeedbackFrames(_FEEDBACK):  # type: ignore[misc]  # its fields are made above
    """Frames that have arrived at the controller in the ticks before this instant."""

    __slots__ = ()


class BusStates(NamedTuple):
    """Load of the two channels, right circuit and left."""

    load_11: Annotated[
        float, Field("1", "share of the last period in which it was busy", "bus_11.position")
    ]
    latency_11: Annotated[
        float, Field("s", "longest from release to arrival in the last period", "bus_11.velocity")
    ]
    lost_11: Annotated[float, Field("1", "frames lost since the start", "bus_11.effort")]
    load_12: Annotated[
        float, Field("1", "share of the last period in which it was busy", "bus_12.position")
    ]
    latency_12: Annotated[
        float, Field("s", "longest from release to arrival in the last period", "bus_12.velocity")
    ]
    lost_12: Annotated[float, Field("1", "frames lost since the start", "bus_12.effort")]


def _temperature(about: str, place: str, sensor: str = "bench_temperature") -> Field:
    """A Field of a temperature, by default that of a thermocouple of a test bench."""
    return Field("degC", about, place, sensor, 100.0)


class WheelSpeedCommand(NamedTuple):
    """Speed set-points of drives, within the torque of the torque command."""

    speed: Annotated[Wheels, Field("rad/s", "of the wheel, forwards positive", "{wheel}.velocity")]


class RearSteeringState(NamedTuple):
    """The steered rear wheels, the motor that turns them, and what it takes."""

    angle: Annotated[
        float,
        leftward("rad", "of both rear wheels", "rear_wheels.position", "rear_wheel_angle", 1.0),
    ]
    rate: Annotated[
        float,
        leftward("rad/s", "of both rear wheels", "rear_wheels.velocity", "rear_wheel_rate", 10.0),
    ]
    motor_speed: Annotated[
        float,
        leftward(
            "rad/s",
            "of the shaft of the steering motor",
            "steering_motor.velocity",
            "steering_motor_speed",
            1e3,
        ),
    ]
    motor_torque: Annotated[
        float,
        leftward(
            "N m",
            "at the shaft of the steering motor",
            "steering_motor.effort",
            "steering_motor_torque",
            100.0,
        ),
    ]
    power: Annotated[
        float,
        Field(
            "W", "from the supply, mean over the last period", "supply.effort", "supply_power", 1e5
        ),
    ]


class BodyRoll(NamedTuple):
    """Roll of the body on its suspension against the road: x and w of the quaternion, and rate."""

    orientation_x: Annotated[
        float,
        leftward("1", "sine of half the angle, to the right", "orientation.x", "body_roll", 10.0),
    ]
    orientation_w: Annotated[
        float, Field("1", "cosine of half the angle", "orientation.w", "body_roll", 10.0)
    ]
    rate: Annotated[
        float, leftward("rad/s", "to the right", "angular_velocity.x", "body_roll_rate", 10.0)
    ]

    @property
    def angle(self) -> float:
        """Roll angle [rad], to the right, as in a bend to the left."""
        return 2 * math.atan2(self.orientation_x, self.orientation_w)


class MotorElectrics(NamedTuple):
    """Phase current and voltage, rms, and power of the motor of each wheel; zero without one.

    Through and across, as in bond graphs: what drives is the effort, what flows the velocity.
    """

    current: Annotated[
        Wheels, Field("A", "of a phase, rms", "{wheel}_phase.velocity", "motor_current", 1e3)
    ]
    voltage: Annotated[
        Wheels, Field("V", "phase to neutral, rms", "{wheel}_phase.effort", "motor_voltage", 1e3)
    ]
    power: Annotated[
        Wheels, Field("W", "from the DC link", "{wheel}_dc_link.effort", "motor_power", 1e6)
    ]


class MotorTemperatures(NamedTuple):
    """Temperatures of motor, inverter and coolant of each wheel, as efforts; zero without one."""

    winding: Annotated[
        Wheels, _temperature("of the winding", "{wheel}_winding.effort", "winding_temperature")
    ]
    inverter: Annotated[
        Wheels,
        _temperature("of the power stage", "{wheel}_inverter.effort", "inverter_temperature"),
    ]
    coolant_inlet: Annotated[
        Wheels, _temperature("into both", "{wheel}_coolant_inlet.effort", "coolant_temperature")
    ]
    coolant_outlet: Annotated[
        Wheels, _temperature("out of both", "{wheel}_coolant_outlet.effort", "coolant_temperature")
    ]
    coolant_flow: Annotated[
        Wheels,
        Field("l/min", "through both", "{wheel}_coolant_inlet.velocity", "coolant_flow", 100.0),
    ]


class CellCondition(NamedTuple):
    """One cell of the traction battery, in the single precision that BatteryState carries."""

    voltage: Annotated[
        float,
        magnitude("V", "at its terminals", "voltage", "cell_voltage", 1.0, single_precision=True),
    ]
    temperature: Annotated[
        float,
        Field(
            "degC", "of the cells", "temperature", "cell_temperature", 100.0, single_precision=True
        ),
    ]


class LoadCommand(NamedTuple):
    """Demand of the virtual car, or a constant, on the load machines of a test bench."""

    mode: Annotated[
        Wheels, Field("1", "1: the torque is controlled, 2: the speed is", "{wheel}.position")
    ]
    speed: Annotated[Wheels, Field("rad/s", "of the shaft, forwards positive", "{wheel}.velocity")]
    torque: Annotated[
        Wheels,
        Field("N m", "of road and brake on the shaft, positive against forwards", "{wheel}.effort"),
    ]


class BenchShafts(NamedTuple):
    """Circuits of a test bench: set-point, machine under test, transducer, load machine."""

    set_point: Annotated[
        Wheels, Field("N m", "that the inverter follows now", "{wheel}_set_point.effort")
    ]
    machine_torque: Annotated[
        Wheels, Field("N m", "of the machine under test, mean", "{wheel}_machine.effort")
    ]
    torque: Annotated[
        Wheels,
        Field(
            "N m",
            "that the transducer measures, mean over the last period",
            "{wheel}_transducer.effort",
            "bench_torque",
            1e3,
        ),
    ]
    speed: Annotated[
        Wheels,
        Field(
            "rad/s",
            "that the transducer measures",
            "{wheel}_transducer.velocity",
            "bench_speed",
            1e3,
        ),
    ]
    load_torque: Annotated[
        Wheels, Field("N m", "of the load machine, forwards positive, mean", "{wheel}_load.effort")
    ]
    load_speed: Annotated[
        Wheels,
        Field("rad/s", "of the load machine", "{wheel}_load.velocity", "bench_load_speed", 1e3),
    ]


class BenchElectrical(NamedTuple):
    """DC side of a bench's inverters, as means over the last period; currents from the supply."""

    voltage: Annotated[
        Wheels,
        magnitude("V", "of the machine under test", "{wheel}_voltage.effort", "bench_voltage", 1e3),
    ]
    load_voltage: Annotated[
        Wheels,
        magnitude("V", "of the load machine", "{wheel}_load_voltage.effort", "bench_voltage", 1e3),
    ]
    current: Annotated[
        Wheels,
        Field("A", "of the machine under test", "{wheel}_current.effort", "bench_current", 1e3),
    ]
    load_current: Annotated[
        Wheels,
        Field("A", "of the load machine", "{wheel}_load_current.effort", "bench_current", 1e3),
    ]


class BenchTemperatures(NamedTuple):
    """Thermocouples of a test bench: coolant of each machine, and the rotor under test."""

    coolant_in: Annotated[
        Wheels, _temperature("of the machine under test, inlet", "{wheel}_coolant_in.effort")
    ]
    coolant_out: Annotated[
        Wheels, _temperature("of the machine under test, outlet", "{wheel}_coolant_out.effort")
    ]
    load_coolant_in: Annotated[
        Wheels, _temperature("of the load machine, inlet", "{wheel}_load_coolant_in.effort")
    ]
    load_coolant_out: Annotated[
        Wheels, _temperature("of the load machine, outlet", "{wheel}_load_coolant_out.effort")
    ]
    rotor: Annotated[Wheels, _temperature("of the machine under test", "{wheel}_rotor.effort")]


def _flow(about: str, place: str, sensor: str = "bench_coolant_flow") -> Field:
    return Field("l/min", about, place, sensor, largest=100.0)


class BenchCoolant(NamedTuple):
    """Flow sensors in the coolant loops of a test bench; motor and inverter share a loop."""

    flow: Annotated[Wheels, _flow("of the machine under test", "{wheel}_coolant.velocity")]
    load_flow: Annotated[Wheels, _flow("of the load machine", "{wheel}_load_coolant.velocity")]


class BatteryCoolant(NamedTuple):
    """Sensors of the coolant loop of a test bench's battery."""

    flow: Annotated[
        float,
        _flow("through the battery", "battery_coolant_in.velocity", "battery_coolant_flow"),
    ]
    coolant_in: Annotated[
        float, _temperature("into the battery", "battery_coolant_in.effort", _WARM)
    ]
    coolant_out: Annotated[
        float, _temperature("out of the battery", "battery_coolant_out.effort", _WARM)
    ]


class BenchEnergy(NamedTuple):
    """Energy flows of a test bench since the start, true, without sensors."""

    battery: Annotated[
        float, Field("J", "given at the battery's terminals to the machines", "battery.effort")
    ]
    mains: Annotated[float, Field("J", "taken from the mains by the load machines", "mains.effort")]
    resistor: Annotated[
        float, Field("J", "that the load machines gave to the load resistor", "resistor.effort")
    ]
    machines: Annotated[
        float, Field("J", "heat of the machines under test and their inverters", "machines.effort")
    ]
    loads: Annotated[
        float, Field("J", "heat of the load machines and their inverters", "loads.effort")
    ]
    shafts: Annotated[
        float, Field("J", "heat of damping and friction of the shafts", "shafts.effort")
    ]
    stored: Annotated[float, Field("J", "in rotating and twisted shafts, now", "stored.effort")]
