"""Equal torques, and what one wheel is refused goes to the other one: method 1 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_control.first_order_filter import filter_share
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import DriverCommand, WheelStates, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels

_OTHER = (1, 0, 3, 2)  # wheel of the same axle


@dataclass(frozen=True, slots=True)
class AdaptiveParameters:
    """Whether refused torque is offered on, and how fast."""

    terrain: str = parameter(
        "off_road",
        choices=("road", "off_road"),
        about="road: equal torques whatever happens; off_road: refused torque is offered to the other wheel",
        source="dissertation, section 2.4",
    )
    filter_time: float = parameter(
        0.05,
        unit="s",
        low=0.0,
        high=10.0,
        about="time constant with which a refusal is noticed; much longer than the drives need to follow",
        source="assumption",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class AdaptiveState:
    """What each wheel was asked for as its own share, and how much of it was refused [N m]."""

    share: Wheels = NO_WHEELS
    refused: Wheels = NO_WHEELS


@method("electronic_differential", "adaptive")
class Adaptive:
    """Give equal torques, and offer what one wheel of an axle does not take to the other wheel.

    Dissertation, sections 2.4 and 3.1: the base is equal torques; where the ASR holds a wheel at the limit of its
    grip, the rest of its share R_i = M_share - M_i, with the torque M_i that acts on it, is added to the request of the
    other wheel, whose own ASR decides what it takes. So the wheels get no more than the driver asked for as soon as
    the refusal is noticed; while it fades, for `filter_time`, the sum of the requests is up to R_i higher. Without ASR
    this is `equal_torque`. Nothing is offered on while the driver brakes, and a changed direction begins anew.
    ValueError if the vehicle has no driven wheel.
    """

    parameters = AdaptiveParameters

    def __init__(self, parameters: AdaptiveParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)
        self._forced = parameters.terrain == "off_road"
        self._approach = filter_share(period, parameters.filter_time)
        driven = [name in vehicle.driven_wheels for name in WHEEL_NAMES]
        self._wheels = [i for i, other in enumerate(_OTHER) if driven[i] and driven[other]]
        self.state = AdaptiveState()

    def step(self, driver: DriverCommand, wheels: WheelStates) -> WheelTorqueRequest:
        """Wheel torques [N m]: the equal share, and what the other wheel of the axle was refused."""
        s, equal = self.state, self._split.request(driver)
        before, s.share = s.share, equal.drive
        if not self._forced or driver.drive_torque == 0.0 or driver.brake_torque != 0.0:
            s.refused = NO_WHEELS
            return equal
        refused, offered = [0.0, 0.0, 0.0, 0.0], list(equal.drive)
        for i in self._wheels:
            share = before[i]
            if share * equal.drive[i] <= 0.0:
                continue
            ahead = 1.0 if share > 0.0 else -1.0
            short = min(max(ahead * (share - wheels.effort[i]), 0.0), ahead * share)
            refused[i] = s.refused[i] + self._approach * (short - s.refused[i])
            offered[_OTHER[i]] += ahead * refused[i]
        s.refused = Wheels(*refused)
        return WheelTorqueRequest(Wheels(*offered), equal.brake)
