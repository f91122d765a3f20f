"""The signals of a test bench: what is asked of its load machines, and its channels (docs/test_bench.md)."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ev_msgs_py.contract.field import Field, magnitude
from ev_msgs_py.contract.wheels import Wheels


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
