"""A driver who asks for a power while the cycle imposes the speed."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group
from ev_msgs_py.signals import WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.cycle_driver import CycleDriver, CycleDriverParameters
from ev_sim.driver.power_level import PowerLevel, PowerLevelParameters


@dataclass(frozen=True, slots=True)
class ImposedSpeedParameters(CycleDriverParameters):
    """The cycle and the power."""

    level: PowerLevelParameters = group(PowerLevelParameters)


@method("driver", "imposed_speed")
class ImposedSpeed(CycleDriver):
    """Ask for a power above the limit of packed snow in all windows of traction, whatever the speed.

    For a plant whose speed the cycle imposes (`plant.speed: imposed`), as a test bench does: dissertation, chapter 3,
    where the driver regulates a power above the limit of packed snow and the car yet follows the cycle.
    """

    parameters = ImposedSpeedParameters

    def __init__(self, parameters: ImposedSpeedParameters, vehicle: Vehicle, period: float) -> None:
        super().__init__(parameters, vehicle, period)
        self._level = PowerLevel(parameters.level, vehicle)

    def _drive(self, wanted: float, speed: float, wheels: WheelStates) -> float:
        return self._level.torque(speed, wheels)
