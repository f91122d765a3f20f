"""A driver who asks for a power while the cycle imposes the speed."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.parameters.declaration import group
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.layout import any_driven
from ev_sim.driver.cycle_driver import CycleDriverParameters, CycleDriverState, cycle_driver
from ev_sim.driver.power_level import PowerLevelParameters, torque_of_power


@dataclass(frozen=True, slots=True)
class ImposedSpeedParameters(CycleDriverParameters):
    """The cycle and the power."""

    level: PowerLevelParameters = group(PowerLevelParameters)


# A free car would run away from a foot that does not know its speed.
@cycle_driver("imposed_speed", ImposedSpeedParameters, needs=(any_driven,), requires={"plant.speed": "imposed"})
@compilable
def imposed_speed(
    p: ImposedSpeedParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """Ask for a power above the limit of packed snow in all windows of traction, whatever the speed.

    For a plant whose speed the cycle imposes (`plant.speed: imposed`), as a test bench does: dissertation, chapter 3,
    where the driver regulates a power above the limit of packed snow and the car yet follows the cycle.
    """
    return torque_of_power(p.level, car, speed, wheels)
