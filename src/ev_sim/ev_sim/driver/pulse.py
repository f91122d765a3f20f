"""A driver who knows two positions of the accelerator."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.layout import any_driven
from ev_sim.driver.cycle_driver import CycleDriverParameters, CycleDriverState, cycle_driver
from ev_sim.driver.power_level import PowerLevelParameters, torque_of_power


@dataclass(frozen=True, slots=True)
class PulseParameters(CycleDriverParameters):
    """The cycle, the power, and when the foot goes down and up."""

    level: PowerLevelParameters = group(PowerLevelParameters)
    band: float = parameter(
        0.3,
        unit="m/s",
        low=0.0,
        high=10.0,
        about="the foot goes down this far below the cycle and up this far above it",
        source="assumption",
    )


@cycle_driver("pulse", PulseParameters, needs=(any_driven,))
@compilable
def pulse(
    p: PulseParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """Follow a speed cycle with an accelerator that is either released or at a power above the limit of packed snow.

    The foot stays where it is within the band around the cycle.
    """
    if speed <= wanted - p.band:
        s.pressed = 1.0
    elif speed >= wanted + p.band:
        s.pressed = 0.0
    return torque_of_power(p.level, car, speed, wheels) if s.pressed == 1.0 else 0.0
