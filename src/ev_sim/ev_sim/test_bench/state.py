"""What lasts between two periods of the test bench."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.parameters.record import each_wheel, entry, part, series
from ev_sim.inverter.state import Inverter

LINE = 64  # set-points that are kept, one for each control period


@dataclass(slots=True)
class SetPointState:
    """A set-point on its way into an inverter."""

    line: list[float] = series(LINE, unit="", about="set-points of the last periods, in a ring")
    now: float = entry(unit="", about="what the inverter follows")


@dataclass(slots=True)
class CircuitState:
    """Two machines with their inverters on one shaft."""

    torque_path: SetPointState = part(SetPointState)
    load_torque_path: SetPointState = part(SetPointState)
    load_speed_path: SetPointState = part(SetPointState)
    machine: Inverter = part(Inverter)
    load: Inverter = part(Inverter)
    twist: float = entry(unit="rad", about="of the shaft, positive where the machine under test is ahead")
    speed: float = entry(unit="rad/s", about="of the machine under test, forwards positive")
    load_speed: float = entry(unit="rad/s", about="of the load machine")
    mean_torque: float = entry(unit="N m", about="of the machine under test, over the last period")
    mean_load_torque: float = entry(unit="N m", about="of the load machine, over the last period")
    mean_shaft_torque: float = entry(unit="N m", about="in the shaft, over the last period")
    power: float = entry(unit="W", about="into the inverter under test, over the last period")
    load_power: float = entry(unit="W", about="into the load inverter, over the last period")
    battery: float = entry(unit="J", about="given to the machine under test and its inverter")
    mains: float = entry(unit="J", about="taken from the mains")
    resistor: float = entry(unit="J", about="given to the load resistor")
    machine_heat: float = entry(unit="J", about="of the machine under test and its inverter")
    load_heat: float = entry(unit="J", about="of the load machine and its inverter")
    shaft_heat: float = entry(unit="J", about="of damping and friction")


@dataclass(slots=True)
class CircuitsState:
    """All circuits."""

    circuits: list[CircuitState] = each_wheel(CircuitState)
    periods: float = entry(unit="1", about="number of periods so far")
    voltage: float = entry(unit="V", about="of the battery, over the last period")
