"""The motors of a vehicle, with inverter and gear."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from ev_msgs_py.parameters.declaration import ParameterError, group, parameter
from ev_msgs_py.vehicle.thermal import ThermalParameters
from ev_msgs_py.vehicle.winding import Winding


@dataclass(frozen=True, slots=True)
class Motor:
    """A torque-controlled motor with its inverter and gear; one for each driven wheel.

    The defaults are assumptions for a small city car's front drive with two motors.
    """

    peak_torque: float = parameter(
        250.0, unit="N m", low=0.0, high=1e5, about="at the shaft, for a short time", own=True
    )
    nominal_torque: float = parameter(150.0, unit="N m", low=1e-3, high=1e5, about="at the shaft, for ever", own=True)
    peak_power: float = parameter(
        40e3, unit="W", low=1.0, high=1e7, about="mechanical power for a short time", own=True
    )
    overload_time: float = parameter(
        60.0, unit="s", low=0.1, high=1e5, about="thermal time constant that ends the short time"
    )
    maximum_speed: float = parameter(
        1000.0, unit="rad/s", low=1.0, high=1e5, about="of the shaft; no drive torque beyond", own=True
    )
    generator_torque: float = parameter(
        150.0, unit="N m", low=0.0, high=1e5, about="largest torque when the motor feeds the battery", own=True
    )
    generator_power: float = parameter(
        25e3, unit="W", low=0.0, high=1e7, about="largest mechanical power that the motor takes", own=True
    )
    torque_lag: float = parameter(0.005, unit="s", low=1e-4, high=10.0, about="time constant of the torque control")
    rotor_inertia: float = parameter(0.0, unit="kg m^2", low=0.0, high=100.0, about="of one rotor, at the shaft")
    gear_efficiency: float = parameter(1.0, unit="1", low=0.5, high=1.0, about="of the gear, either way")
    copper_loss: float = parameter(
        0.05, unit="W/(N m)^2", low=0.0, high=1e3, about="loss per squared torque: winding resistance"
    )
    iron_loss: float = parameter(
        0.5, unit="W s/rad", low=0.0, high=1e3, about="loss per speed: hysteresis and bearings"
    )
    eddy_loss: float = parameter(
        5e-4, unit="W s^2/rad^2", low=0.0, high=10.0, about="loss per squared speed: eddy currents and windage"
    )
    inverter_loss: float = parameter(20.0, unit="W", low=0.0, high=1e4, about="inverter's loss without torque")
    inverter_torque_loss: float = parameter(
        1.0, unit="W/(N m)", low=0.0, high=100.0, about="inverter's loss per torque: switching and conduction"
    )
    map_speed: tuple[float, ...] = parameter(
        (), unit="rad/s", low=0.0, high=1e5, about="shaft speeds of an efficiency map; empty for the loss model"
    )
    map_torque: tuple[float, ...] = parameter(
        (), unit="N m", low=0.0, high=1e5, about="shaft torques of the efficiency map"
    )
    map_efficiency: tuple[float, ...] = parameter(
        (), unit="1", low=0.01, high=1.0, about="efficiency of motor and inverter, speed by speed (row by row)"
    )
    map_file: str = parameter(
        "",
        about="CSV file with the columns speed_radps or speed_rpm, torque_nm and efficiency, instead of the map; empty "
        "for none",
    )
    winding: Winding = group(Winding)
    thermal: ThermalParameters = group(ThermalParameters)

    def __post_init__(self) -> None:
        if len(self.map_efficiency) != len(self.map_speed) * len(self.map_torque):
            raise ParameterError("map_efficiency needs one element for each pair of map_speed and map_torque")
        for name in ("map_speed", "map_torque"):
            axis = getattr(self, name)
            if len(axis) == 1 or any(b <= a for a, b in pairwise(axis)):
                raise ParameterError(f"{name} needs at least two elements and must rise")
