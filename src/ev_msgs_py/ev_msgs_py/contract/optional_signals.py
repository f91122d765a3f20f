"""Signals that only some graphs have: drives in speed mode, actuators, motors and cells, the test bench."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ev_msgs_py.contract.fields import Field, leftward, magnitude
from ev_msgs_py.contract.wheels import Wheels


class WheelSpeedCommand(NamedTuple):
    """Set-points of drives in speed mode; the torque command is the largest torque that they may use to get there."""

    speed: Annotated[Wheels, Field("rad/s", "of the wheel, forwards positive", "{wheel}.velocity")]


class RearSteeringState(NamedTuple):
    """The steered rear wheels, the motor that turns them, and what it takes."""

    angle: Annotated[
        float,
        leftward("rad", "of both rear wheels", "rear_wheels.position", sensor="rear_wheel_angle", largest=1.0),
    ]
    rate: Annotated[
        float,
        leftward("rad/s", "of both rear wheels", "rear_wheels.velocity", sensor="rear_wheel_rate", largest=10.0),
    ]
    motor_speed: Annotated[
        float,
        leftward(
            "rad/s", "of the shaft of the steering motor", "steering_motor.velocity",
            sensor="steering_motor_speed", largest=1e3,
        ),
    ]  # fmt: skip
    motor_torque: Annotated[
        float,
        leftward(
            "N m", "at the shaft of the steering motor", "steering_motor.effort",
            sensor="steering_motor_torque", largest=100.0,
        ),
    ]  # fmt: skip
    power: Annotated[
        float,
        Field("W", "from the supply, mean over the last period", "supply.effort", sensor="supply_power", largest=1e5),
    ]


class MotorElectrics(NamedTuple):
    """Phase current and voltage of the motor of each wheel, rms, and its power; zero where there is none.

    Through and across, as in bond graphs: what drives is the effort, what flows the velocity.
    """

    current: Annotated[
        Wheels, Field("A", "of a phase, rms", "{wheel}_phase.velocity", sensor="motor_current", largest=1e3)
    ]
    voltage: Annotated[
        Wheels, Field("V", "phase to neutral, rms", "{wheel}_phase.effort", sensor="motor_voltage", largest=1e3)
    ]
    power: Annotated[
        Wheels, Field("W", "from the DC link", "{wheel}_dc_link.effort", sensor="motor_power", largest=1e6)
    ]


class MotorTemperatures(NamedTuple):
    """Temperatures of motor, inverter and coolant of each wheel, as efforts; zero where there is no motor."""

    winding: Annotated[
        Wheels, Field("degC", "of the winding", "{wheel}_winding.effort", sensor="winding_temperature", largest=100.0)
    ]
    inverter: Annotated[
        Wheels,
        Field("degC", "of the power stage", "{wheel}_inverter.effort", sensor="inverter_temperature", largest=100.0),
    ]
    coolant_inlet: Annotated[
        Wheels, Field("degC", "into both", "{wheel}_coolant_inlet.effort", sensor="coolant_temperature", largest=100.0)
    ]
    coolant_outlet: Annotated[
        Wheels,
        Field("degC", "out of both", "{wheel}_coolant_outlet.effort", sensor="coolant_temperature", largest=100.0),
    ]
    coolant_flow: Annotated[
        Wheels,
        Field("l/min", "through both", "{wheel}_coolant_inlet.velocity", sensor="coolant_flow", largest=100.0),
    ]


class CellCondition(NamedTuple):
    """One cell of the traction battery, in the single precision that BatteryState carries."""

    voltage: Annotated[
        float, magnitude("V", "at its terminals", "voltage", single_precision=True, sensor="cell_voltage", largest=1.0)
    ]
    temperature: Annotated[
        float,
        Field("degC", "of the cells", "temperature", single_precision=True, sensor="cell_temperature", largest=100.0),
    ]


def _thermocouple(about: str, place: str) -> Field:
    return Field("degC", about, place, sensor="bench_temperature", largest=100.0)


class LoadCommand(NamedTuple):
    """What the virtual car asks of the load machines of a test bench, at the shafts behind the gear."""

    mode: Annotated[Wheels, Field("1", "1: the torque is controlled, 2: the speed is", "{wheel}.position")]
    speed: Annotated[Wheels, Field("rad/s", "of the shaft, forwards positive", "{wheel}.velocity")]
    torque: Annotated[
        Wheels, Field("N m", "of road and brake on the shaft, positive against forwards", "{wheel}.effort")
    ]


class BenchShafts(NamedTuple):
    """Each circuit of a test bench: set-point, machine under test, transducer in the shaft, load machine."""

    set_point: Annotated[Wheels, Field("N m", "that the inverter follows now", "{wheel}_set_point.effort")]
    machine_torque: Annotated[Wheels, Field("N m", "of the machine under test, mean", "{wheel}_machine.effort")]
    torque: Annotated[
        Wheels,
        Field(
            "N m", "that the transducer measures, mean over the last period", "{wheel}_transducer.effort",
            sensor="bench_torque", largest=1e3,
        ),
    ]  # fmt: skip
    speed: Annotated[
        Wheels,
        Field(
            "rad/s", "that the transducer measures", "{wheel}_transducer.velocity", sensor="bench_speed", largest=1e3
        ),
    ]
    load_torque: Annotated[Wheels, Field("N m", "of the load machine, forwards positive, mean", "{wheel}_load.effort")]
    load_speed: Annotated[
        Wheels,
        Field("rad/s", "of the load machine", "{wheel}_load.velocity", sensor="bench_load_speed", largest=1e3),
    ]


class BenchElectrical(NamedTuple):
    """DC side of the inverters of a test bench, as means over the last period; currents from the supply."""

    voltage: Annotated[
        Wheels,
        magnitude("V", "of the machine under test", "{wheel}_voltage.effort", sensor="bench_voltage", largest=1e3),
    ]
    load_voltage: Annotated[
        Wheels,
        magnitude("V", "of the load machine", "{wheel}_load_voltage.effort", sensor="bench_voltage", largest=1e3),
    ]
    current: Annotated[
        Wheels,
        Field("A", "of the machine under test", "{wheel}_current.effort", sensor="bench_current", largest=1e3),
    ]
    load_current: Annotated[
        Wheels,
        Field("A", "of the load machine", "{wheel}_load_current.effort", sensor="bench_current", largest=1e3),
    ]


class BenchTemperatures(NamedTuple):
    """What the thermocouples of a test bench show: coolant of each machine, and the rotor under test."""

    coolant_in: Annotated[Wheels, _thermocouple("of the machine under test, inlet", "{wheel}_coolant_in.effort")]
    coolant_out: Annotated[Wheels, _thermocouple("of the machine under test, outlet", "{wheel}_coolant_out.effort")]
    load_coolant_in: Annotated[Wheels, _thermocouple("of the load machine, inlet", "{wheel}_load_coolant_in.effort")]
    load_coolant_out: Annotated[Wheels, _thermocouple("of the load machine, outlet", "{wheel}_load_coolant_out.effort")]
    rotor: Annotated[Wheels, _thermocouple("of the machine under test", "{wheel}_rotor.effort")]


class BenchEnergy(NamedTuple):
    """Where the energy of a test bench came from and went to since the start, truth without sensors."""

    battery: Annotated[float, Field("J", "given at the battery's terminals to the machines", "battery.effort")]
    mains: Annotated[float, Field("J", "taken from the mains by the load machines", "mains.effort")]
    resistor: Annotated[float, Field("J", "that the load machines gave to the load resistor", "resistor.effort")]
    machines: Annotated[float, Field("J", "heat of the machines under test and their inverters", "machines.effort")]
    loads: Annotated[float, Field("J", "heat of the load machines and their inverters", "loads.effort")]
    shafts: Annotated[float, Field("J", "heat of damping and friction of the shafts", "shafts.effort")]
    stored: Annotated[float, Field("J", "in rotating and twisted shafts, now", "stored.effort")]
