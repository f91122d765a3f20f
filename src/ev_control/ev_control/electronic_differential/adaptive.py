"""Equal torques, of which each wheel takes what its traction control lets it: method 1 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.wheel_dynamics import filter_share
from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_control.shared.torque_split import differential
from ev_core.law import Car, DriverCommand, WheelStates, WheelTorqueRequest, compilable, each_driven, per_wheel
from ev_core.parameters.declaration import group, parameter
from ev_msgs_py.contract.wheels import FRONT_LEFT, FRONT_RIGHT, NO_WHEELS, REAR_LEFT, REAR_RIGHT, Wheels


@dataclass(frozen=True, slots=True)
class AdaptiveParameters:
    """Whether refused torque is offered on, and how fast."""

    redistribute: bool = parameter(
        False,
        about="offer what one wheel is refused to the other wheel of its axle, instead of dropping it",
        source="assumption where it is on: the dissertation (sections 2.4, 2.7.5, 3.1) has nothing of it",
    )
    filter_time: float = parameter(
        0.05, unit="s", low=0.0, high=10.0, about="time constant of noticing a refusal, much longer than the drives'"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@dataclass(slots=True)
class AdaptiveState:
    """What lasts between steps."""

    share: list[float] = per_wheel(unit="N m", about="what each wheel was asked for as its own share")
    refused: list[float] = per_wheel(unit="N m", about="how much of it was refused")


@differential("adaptive", AdaptiveParameters, state=AdaptiveState, needs=(each_driven, own_motors_to_allocate))
@compilable
def adaptive(
    p: AdaptiveParameters, car: Car, s: AdaptiveState, period: float, driver: DriverCommand, wheels: WheelStates
) -> WheelTorqueRequest:
    """Give equal torques, of which the traction control of each wheel lets pass what that wheel can take.

    Dissertation, sections 2.4 and 3.1: the base is equal torques, and the ASR holds each wheel at the limit of its grip
    on its own. What it refuses is dropped, as nothing in the source offers it to the other wheel; the request is then
    that of `equal_torque`. How the "asymmetric regulation" of section 2.4 is formed is open: here by the ASR.

    With `redistribute` the rest of a refused share R_i = M_share - M_i, with the torque M_i that acts on the wheel, is
    added to the request of the other wheel of the axle, whose own ASR decides what it takes. So the wheels get no more
    than the driver asked for as soon as the refusal is noticed; while it fades, for `filter_time`, the sum of the
    requests is up to R_i higher. Nothing is offered on while the driver brakes, and a changed direction begins anew.
    """
    equal = split(p.brake, car, driver, 0.0)
    offers = p.redistribute and driver.drive_torque != 0.0 and driver.brake_torque == 0.0
    front_left, front_right, rear_left, rear_right = equal.drive
    if offers:
        approach = filter_share(period, p.filter_time)
        front_right += refused(car, s, FRONT_LEFT, FRONT_RIGHT, equal.drive[0], wheels.effort[0], approach)
        front_left += refused(car, s, FRONT_RIGHT, FRONT_LEFT, equal.drive[1], wheels.effort[1], approach)
        rear_right += refused(car, s, REAR_LEFT, REAR_RIGHT, equal.drive[2], wheels.effort[2], approach)
        rear_left += refused(car, s, REAR_RIGHT, REAR_LEFT, equal.drive[3], wheels.effort[3], approach)
    else:
        s.refused[:] = NO_WHEELS
    s.share[:] = equal.drive
    drive = Wheels(front_left, front_right, rear_left, rear_right)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))


@compilable
def refused(car: Car, s: AdaptiveState, wheel: int, other: int, share: float, effort: float, approach: float) -> float:
    """What a wheel did not take of its share, for the other one [N m]; `effort` is the torque that acts on it."""
    before = s.share[wheel]
    if car.driven[wheel] == 0.0 or car.driven[other] == 0.0 or before * share <= 0.0:
        s.refused[wheel] = 0.0
        return 0.0
    ahead = 1.0 if before > 0.0 else -1.0
    short = min(max(ahead * (before - effort), 0.0), ahead * before)
    s.refused[wheel] += approach * (short - s.refused[wheel])
    return ahead * s.refused[wheel]
