"""Equal torques, and copies of mechanical differentials (dissertation, 2.4 and 3.1 to 3.4)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation.wheel_dynamics import filter_share
from ev_control.law import (
    AllocationParameters,
    BrakeSplitParameters,
    allocated,
    own_motors_to_allocate,
    split,
)
from ev_control.shared.limp_mode import PARTNERS
from ev_control.shared.torque_split import differential
from ev_core.law import (
    Car,
    Choice,
    any_driven,
    compilable,
    each_driven,
    equal_motors,
    group,
    parameter,
    per_wheel,
    tanh,
)
from ev_msgs_py.contract.signals import DriverCommand, Instant, WheelStates, WheelTorqueRequest
from ev_msgs_py.contract.wheels import (
    FRONT_LEFT,
    FRONT_RIGHT,
    NO_WHEELS,
    REAR_LEFT,
    REAR_RIGHT,
    Wheels,
)

# What becomes of a refusal for the other wheel of the axle.
_DROPPED = 0.0
_TAKEN = -1.0
_OFFERED = 1.0


class Mode(Choice):
    """Positions of the driver's switch."""

    ROAD = auto()
    OFF_ROAD = auto()


@dataclass(frozen=True, slots=True)
class EqualTorqueParameters:
    """Only the brakes leave a choice."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@differential("equal_torque", needs=(any_driven,))
@compilable
def equal_torque(p: EqualTorqueParameters, car: Car, driver: DriverCommand) -> WheelTorqueRequest:
    """Give every driven wheel the same share of the drive torque, for any layout."""
    return split(p.brake, car, driver, 0.0)


@differential("open_differential", needs=(any_driven, equal_motors))
@compilable
def open_differential(
    p: EqualTorqueParameters, car: Car, driver: DriverCommand
) -> WheelTorqueRequest:
    """Give left and right equal torques as behind a mechanical differential.

    M_left = M_right = M_axle/2 [N m] (dissertation, section 3.2), the torques of the axles alike,
    none above what one motor has. Other than `equal_torque` the drive is one whole: what one wheel
    of an axle does not deliver, because of its motor, the other one does not get either, as no gear
    could give it.
    """
    # The weaker motor of an axle would be the limit; here all are alike.
    equal, most = split(p.brake, car, driver, 0.0), car.motor.peak_torque * car.gear_ratio
    m = equal.drive
    drive = Wheels(
        min(max(m.front_left, -most), most),
        min(max(m.front_right, -most), most),
        min(max(m.rear_left, -most), most),
        min(max(m.rear_right, -most), most),
    )
    return WheelTorqueRequest(drive, equal.brake)


@compilable
def locking_share(ratio: float) -> float:
    """Locking torque over that of the axle [1], (K - 1)/(K + 1) for a ratio K of at least 1."""
    return (ratio - 1.0) / (ratio + 1.0)


@compilable
def locked(car: Car, drive: Wheels, front_share: float, rear_share: float) -> Wheels:
    """Drive torques [N m] after locking of every axle with two driven wheels, which keeps the sums.

    M_slow - M_fast = (K - 1)/(K + 1) |M_slow + M_fast|, so M_slow/M_fast = K in traction
    (dissertation, section 1.2: K is the locking coefficient). The shares of the axles are (K -
    1)/(K + 1) with the sign of w_left - w_right.
    """
    front, rear = 0.0, 0.0
    if car.driven[0] and car.driven[1]:
        front = abs(drive[0] + drive[1]) / 2.0 * front_share
    if car.driven[2] and car.driven[3]:
        rear = abs(drive[2] + drive[3]) / 2.0 * rear_share
    return Wheels(drive[0] - front, drive[1] + front, drive[2] - rear, drive[3] + rear)


@dataclass(frozen=True, slots=True)
class LimitedSlipParameters:
    """The locking coefficient, and over which speed difference it changes sides."""

    locking_ratio: float = parameter(
        1.5,
        unit="1",
        low=1.0,
        high=20.0,
        about="torque of the slower over that of the faster wheel, K",
        source="dissertation, section 3.3",
    )
    locking_speed: float = parameter(
        0.5,
        unit="rad/s",
        low=0.01,
        high=100.0,
        about="speed difference of the wheels at which 76 % of the locking torque acts",
        source="assumption: friction has no sign at rest",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@differential("limited_slip", needs=(each_driven, own_motors_to_allocate))
@compilable
def limited_slip(
    p: LimitedSlipParameters, car: Car, driver: DriverCommand, wheels: WheelStates
) -> WheelTorqueRequest:
    """Give the slower wheel of each driven axle K times the torque of the faster one.

    M_slow/M_fast = K = 1.5 (dissertation, section 3.3), smoothed by tanh of the difference of the
    wheel speeds [rad/s]; the sum of the torques [N m] is the driver's.
    """
    equal, speed = split(p.brake, car, driver, 0.0), wheels.velocity
    most = locking_share(p.locking_ratio)
    # Positive where the left wheel is faster: then `locked` moves torque to the right one.
    front = most * tanh((speed.front_left - speed.front_right) / p.locking_speed)
    rear = most * tanh((speed.rear_left - speed.rear_right) / p.locking_speed)
    drive = locked(car, equal.drive, front, rear)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))


@dataclass(frozen=True, slots=True)
class LimitedSlipVariableParameters:
    """The largest locking coefficient, and the speed difference that it needs."""

    largest_locking_ratio: float = parameter(
        1.5,
        unit="1",
        low=1.0,
        high=20.0,
        about="torque of the slower over that of the faster wheel at most, K",
        source="dissertation, section 3.4",
    )
    full_locking_speed: float = parameter(
        5.0,
        unit="rad/s",
        low=0.01,
        high=1000.0,
        about="speed difference of the wheels from which on the locking is the largest",
        source="assumption: the source has K from 1 to 1.5 with the speed difference, but not "
        "over which",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@differential("limited_slip_variable", needs=(each_driven, own_motors_to_allocate))
@compilable
def limited_slip_variable(
    p: LimitedSlipVariableParameters, car: Car, driver: DriverCommand, wheels: WheelStates
) -> WheelTorqueRequest:
    """Give the slower wheel of an axle up to K times the torque of the faster one, by their speeds.

    M_slow/M_fast = 1 + (K - 1) min(|d|/d_full, 1) with the difference d of the wheel speeds [rad/s]
    and K = 1.5 (dissertation, section 3.4); the sum of the torques [N m] is the driver's.
    """
    equal, speed = split(p.brake, car, driver, 0.0), wheels.velocity
    rise = p.largest_locking_ratio - 1.0
    apart_front = speed.front_left - speed.front_right
    apart_rear = speed.rear_left - speed.rear_right
    front = locking_share(1.0 + rise * min(abs(apart_front) / p.full_locking_speed, 1.0))
    rear = locking_share(1.0 + rise * min(abs(apart_rear) / p.full_locking_speed, 1.0))
    front = front if apart_front >= 0.0 else -front
    rear = rear if apart_rear >= 0.0 else -rear
    drive = locked(car, equal.drive, front, rear)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))


@dataclass(frozen=True, slots=True)
class AdaptiveParameters:
    """The driver's switch, whether refused torque is offered on, and how fast."""

    driving_mode: Mode = parameter(
        Mode.OFF_ROAD,
        about="road: the wheels of an axle get equal torques, so what one is refused the other "
        "does not get, either; off_road: each gets what it can take",
        source="dissertation, section 2.4; that refusals keep torques equal and chapter 3 is "
        "off_road is assumed",
    )
    switch_at: float = parameter(
        0.0,
        unit="s",
        low=0.0,
        high=1e9,
        about="when the driver turns the switch to the other mode; 0: never",
    )
    redistribute: bool = parameter(
        False,
        about="off_road: offer what one wheel is refused to the other wheel of its axle, instead "
        "of dropping it",
        source="assumption where it is on: the dissertation (sections 2.4, 2.7.5, 3.1) has "
        "nothing of it",
    )
    filter_time: float = parameter(
        0.05,
        unit="s",
        low=0.0,
        high=10.0,
        about="time constant of noticing a refusal, much longer than the drives'",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@dataclass(slots=True)
class AdaptiveState:
    """State of the requests and of what was refused of them."""

    share: list[float] = per_wheel(
        unit="N m", about="what each wheel was asked for, without what it was offered"
    )
    refused: list[float] = per_wheel(unit="N m", about="how much of it was refused")


class AdaptiveSeen(NamedTuple):
    """Signals that the law reads."""

    now: Instant
    driver: DriverCommand
    wheels: WheelStates


@differential("adaptive", needs=(each_driven, own_motors_to_allocate))
@compilable
def adaptive(
    p: AdaptiveParameters,
    car: Car,
    s: AdaptiveState,
    period: float,
    seen: AdaptiveSeen,
) -> WheelTorqueRequest:
    """Give equal torques, of which traction control lets pass what each wheel can take.

    Dissertation, sections 2.4 and 3.1: the base is equal torques, and the ASR holds each wheel at
    the limit of its grip on its own. Against a low resistance the torques of the wheels are
    equalised ("road"), against a high one their asymmetric regulation is switched on by force
    ("off-road"). How that is formed is open: here by the ASR. What it refuses is dropped, as
    nothing in the source offers it to the other wheel; the request is then that of `equal_torque`.

    Let R_i = M_share - M_i be what wheel i was refused, with the torque M_i that acts on it. In the
    mode `road` it is taken from the request of the other wheel of the axle, so that both get equal
    torques as soon as the refusal is noticed, with `filter_time`: as behind an open differential
    the worse wheel sets the traction. In the mode `off_road` with `redistribute` it is added to
    that request, and the other wheel's own ASR decides what it takes. So the wheels get no more
    than the driver asked for as soon as the refusal is noticed; while it fades, for `filter_time`,
    the sum of the requests is up to R_i higher. Nothing is taken or offered on while the driver
    brakes, and a changed direction begins again.
    """
    driver, wheels = seen.driver, seen.wheels
    equal = split(p.brake, car, driver, 0.0)
    is_turned = 0.0 < p.switch_at <= seen.now.time
    # After `switch_at` the switch stands the other way.
    is_road = (p.driving_mode == Mode.ROAD) != is_turned
    refusal = _TAKEN if is_road else _OFFERED if p.redistribute else _DROPPED
    front_left, front_right, rear_left, rear_right = equal.drive
    if refusal != _DROPPED and driver.drive_torque != 0.0 and driver.brake_torque == 0.0:
        acts, approach = wheels.effort, filter_share(period, p.filter_time)
        gear = car.motor.gear_efficiency if is_road else 1.0  # what the gear takes is no refusal
        # What one wheel was refused changes the request of the other: taken from it, or offered to
        # it.
        front_right += refusal * refused(
            car, s, FRONT_LEFT, equal.drive[0], acts[0] / gear, approach
        )
        front_left += refusal * refused(
            car, s, FRONT_RIGHT, equal.drive[1], acts[1] / gear, approach
        )
        rear_right += refusal * refused(car, s, REAR_LEFT, equal.drive[2], acts[2] / gear, approach)
        rear_left += refusal * refused(car, s, REAR_RIGHT, equal.drive[3], acts[3] / gear, approach)
    else:
        s.refused[:] = NO_WHEELS
    drive = Wheels(front_left, front_right, rear_left, rear_right)
    s.share[:] = drive if is_road else equal.drive
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))


@compilable
def refused(
    car: Car, s: AdaptiveState, wheel: int, share: float, effort: float, approach: float
) -> float:
    """Part of its share that a wheel did not take [N m]; `effort` is the torque that acts on it."""
    before = s.share[wheel]
    # Without a partner there is no wheel to offer it to; a changed sign is another manoeuvre.
    is_alone = not car.driven[wheel] or not car.driven[PARTNERS[wheel]]
    if is_alone or before * share <= 0.0:
        s.refused[wheel] = 0.0
        return 0.0
    ahead = 1.0 if before > 0.0 else -1.0
    # A refusal is never negative, and never more than the whole share.
    short = min(max(ahead * (before - effort), 0.0), ahead * before)
    s.refused[wheel] += approach * (short - s.refused[wheel])
    return ahead * s.refused[wheel]
