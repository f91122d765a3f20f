"""A driver who knows two positions of the accelerator."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.cycle_driver import CycleDriver, CycleDriverParameters
from ev_sim.driver.power_level import PowerLevel, PowerLevelParameters


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


@method("driver", "pulse")
class Pulse(CycleDriver):
    """Follow a speed cycle with an accelerator that is either released or at a power above the limit of packed snow."""

    parameters = PulseParameters

    def __init__(self, parameters: PulseParameters, vehicle: Vehicle, period: float) -> None:
        super().__init__(parameters, vehicle, period)
        self._level, self._band = PowerLevel(parameters.level, vehicle), parameters.band

    def _drive(self, wanted: float, speed: float, wheels: WheelStates) -> float:
        s = self.state
        if speed <= wanted - self._band:
            s.pressed = True
        elif speed >= wanted + self._band:
            s.pressed = False
        return self._level.torque(speed, wheels) if s.pressed else 0.0
