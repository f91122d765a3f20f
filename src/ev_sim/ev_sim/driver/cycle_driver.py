"""What the three drivers of an urban cycle have in common: the cycle, its windows, brakes, and the lane."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any

from ev_msgs_py.parameters import group
from ev_msgs_py.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState, WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.cycle_modes import TRACTION, CycleModes, CycleModesParameters
from ev_sim.driver.lane_keeping import LaneKeeping, LaneKeepingParameters, LaneKeepingState
from ev_sim.driver.profile_file import with_speed_profile_from_file
from ev_sim.driver.speed_control import (
    SpeedControl,
    SpeedControlParameters,
    SpeedProfileParameters,
    refuse_unread_file,
)


@dataclass(frozen=True, slots=True)
class CycleDriverParameters(LaneKeepingParameters):
    """The cycle, its windows, and how the driver slows down and steers."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    modes: CycleModesParameters = group(CycleModesParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)


@dataclass(slots=True)
class CycleDriverState:
    """Integral part of the speed control [N m], whether the pedal is pressed, and the state of the hands."""

    speed_integral: float = 0.0
    pressed: bool = False
    hands: LaneKeepingState = field(default_factory=LaneKeepingState)


class CycleDriver(ABC):
    """Drives in the traction windows as its kind does, and in the others just follows the cycle.

    There a car that is to slow down is braked by its drives as far as `speed_control.max_regenerative_torque`, then by
    its brakes, and driven where the road slows it down more than it should (snow does); one that is to stand is held.
    ParameterError if the parameters name a profile file that has not been read.
    """

    parameters = CycleDriverParameters

    load_files = staticmethod(with_speed_profile_from_file)

    def __init__(self, parameters: Any, vehicle: Vehicle, period: float) -> None:
        refuse_unread_file(parameters.speed_profile)
        self._profile = parameters.speed_profile.profile()
        self._modes = CycleModes(parameters.modes, self._profile, period)
        self._control = SpeedControl(parameters.speed_control, period)
        self._hands = LaneKeeping(parameters, vehicle, period)
        self.state = CycleDriverState()

    def step(
        self, now: Instant, body: BodyVelocity, pose: BodyPose, column: SteeringColumnState, wheels: WheelStates
    ) -> DriverCommand:
        """Pedals by the window of the cycle, hand torque by the place of the car beside its path."""
        s, speed = self.state, body.along_path
        hand_torque = self._hands.step(pose, speed, column, s.hands)
        mode, wanted = self._modes.at(now.time), self._profile.at(now.time)
        if mode == TRACTION:
            return DriverCommand(self._drive(wanted, speed, wheels), 0.0, hand_torque)
        s.pressed = False
        drive, brake, s.speed_integral = self._control.step(wanted, speed, s.speed_integral)
        return DriverCommand(drive, brake, hand_torque)

    @abstractmethod
    def _drive(self, wanted: float, speed: float, wheels: WheelStates) -> float:
        """Drive torque, all wheels together [N m], in a window of traction; wanted and present speed [m/s]."""
