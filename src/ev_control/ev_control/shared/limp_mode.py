"""Limp mode: a lost motor is found by its torque, and its partner of the axle gives the same.

How it works: a lost motor is found beside what it was commanded, and beside what its partner of the
axle gives. No motor reports that it is dead. It shows in the torque that acts, which the inverter
derives from its currents. More than was commanded is never plausible. Less is: battery, voltage,
power, heat and gear leave less, more than a controller knows of. But they are the same for both
motors of an axle. So a motor is lost if it gives less than its partner shows to be possible. Where
both give less, nothing is lost, and nothing turns the car.
"""

from dataclasses import dataclass
from math import inf
from operator import attrgetter
from typing import Any, NamedTuple

from ev_control.estimation.plausible import LARGEST_TORQUE
from ev_control.estimation.wheel_dynamics import filter_share
from ev_core.law import (
    NO_WHEELS,
    Car,
    Vehicle,
    Wheels,
    compilable,
    copysign,
    entry,
    group,
    per_wheel,
    setting,
)
from ev_core.vehicle.car import Need, each_driven, equal_motors
from ev_core.vehicle.motor import driving_torque, generating_torque
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueCommand, WheelTorqueRequest

PARTNERS = (1, 0, 3, 2)  # the other wheel of the axle, in the order of Wheels
# Share of the motor's maximum speed from which on no torque is expected of it.
NEARLY_FASTEST = 0.95


@dataclass(frozen=True, slots=True)
class LostMotorParameters:
    """Limits beyond which a torque is not plausible; all of it is assumed."""

    lag: float = setting(
        0.0,
        unit="s",
        low=0.0,
        high=1.0,
        about="of bus and sensor to the measured torque, beside `motor.torque_lag`",
    )
    tolerance: float = setting(
        20.0, unit="N m", low=0.1, high=1e4, about="deviation at the wheel that is allowed"
    )
    share: float = setting(
        0.2, unit="1", low=0.0, high=1.0, about="of the expected torque, allowed besides"
    )
    power: float = setting(
        0.7,
        unit="1",
        low=0.0,
        high=1.0,
        about="of a motor's peak power that a low voltage leaves of it",
    )
    time: float = setting(
        0.02,
        unit="s",
        low=0.0,
        high=10.0,
        about="of twice the allowed deviation until a motor counts as lost",
    )
    keep_difference: bool = setting(
        False,
        about="whether drives steer the car: the difference asked of a lost motor and its partner "
        "is given also where the partner's torque changes its sign by it",
    )
    recovery: float = setting(
        0.5,
        unit="s",
        low=0.0,
        high=100.0,
        about="of torques as commanded, not about zero, until it counts as sound",
    )


@dataclass(slots=True)
class LostMotors:
    """State of the four motors."""

    most: list[float] = per_wheel(
        unit="N m", about="torque at the wheel by the commands up to now, forwards at most"
    )
    least: list[float] = per_wheel(unit="N m", about="the same backwards, never positive")
    commanded: list[float] = per_wheel(
        unit="N m", about="the same of a slow drive that nothing limits, of either sign"
    )
    deviates: list[float] = per_wheel(
        unit="s", about="for how long it has not been plausible, less how long it has"
    )
    agrees: list[float] = per_wheel(
        unit="s", about="for how long it has been plausible, since it was lost"
    )
    lost: list[float] = per_wheel(unit="1", about="1 while the motor counts as lost")
    known: bool = entry(False, unit="1", about="whether there has been a command")


@compilable
def watch_torques(
    p: LostMotorParameters, car: Car, s: LostMotors, period: float, wheels: WheelStates
) -> None:
    """Compare the torques of the last period with the commands, and with those of the partners.

    A deviation counts by its size, at most twice what is allowed, and what is plausible takes back:
    so noise about the allowed deviation does not add up. Nor is one look enough, unless `time` is
    0, however long the period is. A motor without a partner is not judged.
    """
    if not s.known:
        return
    # A long period counts as one look of at most `time`: one look is not enough.
    look = min(period, p.time) if p.time > 0.0 else period
    for i in range(4):
        if not car.driven[i] or not car.driven[PARTNERS[i]]:
            continue
        due = due_torque(p, car, s, wheels, i)
        # More than 1: beyond what is allowed.
        excess = deviation(p, s, wheels, i, due)
        if not s.lost[i]:
            s.deviates[i] = max(s.deviates[i] + look * min(excess - 1.0, 1.0), 0.0)
            s.agrees[i] = 0.0
        elif excess > 1.0:
            s.agrees[i] = 0.0
        elif due > p.tolerance + p.share * due:  # else a dead motor looks like a sound one
            s.agrees[i] += period
    for i in range(4):  # behind all judgements, so that left and right are alike
        if s.deviates[i] > p.time:
            s.lost[i] = 1.0
            s.deviates[i] = 0.0
        elif s.agrees[i] > p.recovery:
            s.lost[i] = 0.0


@compilable
def deviation(
    p: LostMotorParameters, s: LostMotors, wheels: WheelStates, i: int, due: float
) -> float:
    """Deviation of a torque from what was commanded, or is due, over what is allowed [1].

    A dead motor may show both: by drag or noise it gives a little of the other sign, and all that
    is due is missing.
    """
    gives = measured(wheels, i)
    less = beyond = 0.0
    if due > 0.0:
        less = (due - copysign(1.0, s.commanded[i]) * gives) / (p.tolerance + p.share * due)
    if gives > s.most[i]:
        beyond = (gives - s.most[i]) / (p.tolerance + p.share * s.most[i])
    elif gives < s.least[i]:
        beyond = (s.least[i] - gives) / (p.tolerance - p.share * s.least[i])
    return max(beyond, less)


@compilable
def due_torque(
    p: LostMotorParameters, car: Car, s: LostMotors, wheels: WheelStates, i: int
) -> float:
    """Least torque [N m] that motor i gives if it is sound, in the direction of its command.

    That is its command, within what it can for ever at its speed, in the share that its partner
    gives of its own. Where the partner itself stays behind, no more than that is due: both may have
    met the same limit. Nothing is due from a motor that is not lost beside a partner that is lost,
    or has a command of the other kind; nor from any motor before it must have left the other
    direction.
    """
    j, ahead = PARTNERS[i], copysign(1.0, s.commanded[i])
    commanded = abs(s.commanded[i])
    partner = ahead * s.commanded[j]
    gives = max(ahead * measured(wheels, j), 0.0)
    outer, other = (s.most[i], -s.least[i]) if ahead > 0.0 else (-s.least[i], s.most[i])
    # The partner may still give more than its command now.
    outer_partner = s.most[j] if ahead > 0.0 else -s.least[j]
    # The bounds were widened by the gear and `commanded` was narrowed: both on the side of the
    # least.
    outer *= car.motor.gear_efficiency * car.motor.gear_efficiency
    outer_partner *= car.motor.gear_efficiency * car.motor.gear_efficiency
    due, most = commanded, lasting_torque(p, car, wheels.velocity[i], ahead)
    if not s.lost[j] and partner > p.tolerance:
        # A small torque shows little of a large one.
        due = min(commanded, 2.0 * partner) * min(gives / max(outer_partner, partner), 1.0)
        if gives + p.tolerance + p.share * partner < partner and not s.lost[i]:
            most = min(most, gives)
    elif not s.lost[i]:
        return 0.0
    # The share of its way that a slow drive has made, and with it of any lower limit.
    reached = commanded / outer if outer > 0.0 else 0.0  # by the lag, of whatever it goes for
    return max(min(due, reached * most) - other, 0.0)


@compilable
def lasting_torque(p: LostMotorParameters, car: Car, speed: float, ahead: float) -> float:
    """Torque [N m] that heat, voltage and gear leave of a motor at a wheel speed [rad/s]."""
    motor, turns = car.motor, abs(speed) * car.gear_ratio
    if turns > NEARLY_FASTEST * motor.maximum_speed:
        return 0.0
    lasting = min(motor.nominal_torque, motor.peak_torque)
    if ahead * speed < 0.0:
        shaft = generating_torque(motor, lasting, p.power, turns)
    else:
        shaft = driving_torque(motor, lasting, p.power, turns)
    return shaft * car.gear_ratio * motor.gear_efficiency


@compilable
def measured(wheels: WheelStates, i: int) -> float:
    """Torque of a motor [N m]; what no motor has, as broken sensors show it, counts as none."""
    return wheels.effort[i] if abs(wheels.effort[i]) < LARGEST_TORQUE else 0.0


@compilable
def expect(
    p: LostMotorParameters,
    car: Car,
    s: LostMotors,
    period: float,
    command: WheelTorqueCommand,
    wheels: WheelStates,
) -> None:
    """Go on with the command: bounds widen at once, as of a quick drive, and close by the lag.

    Limits may leave anything between rest and the command, so the bounds close towards rest. All
    leave room for the gear either way, and for what motors serve of the brake torque where brakes
    are blended.
    """
    efficiency = car.motor.gear_efficiency
    lag = car.motor.torque_lag + p.lag + period / 2.0  # the last for means over periods
    share = filter_share(period, lag)
    for i in range(4):
        drive = command.drive[i]
        # With blended brakes the motor also takes a part of the brake torque.
        braked = drive - copysign(car.blend_brakes * command.brake[i], wheels.velocity[i])
        low, high = min(drive, braked), max(drive, braked)
        # Before the first command motors may already give something, as after a restart on the
        # move.
        if not s.known:
            s.most[i] = max(measured(wheels, i), 0.0)
            s.least[i] = min(measured(wheels, i), 0.0)
        forwards, backwards = max(high, 0.0) / efficiency, min(low, 0.0) / efficiency
        s.most[i] = max(forwards, s.most[i] + share * (forwards - s.most[i]))
        s.least[i] = min(backwards, s.least[i] + share * (backwards - s.least[i]))
        # What is sure: the end that is nearer to none, and none where both ends have different
        # signs.
        goal = efficiency * (max(low, 0.0) + min(high, 0.0))
        # A torque that changes its sign passes zero, so it starts from rest.
        from_rest = s.commanded[i] if s.commanded[i] * goal > 0.0 else 0.0
        s.commanded[i] = (
            goal if abs(goal) < abs(from_rest) else from_rest + share * (goal - from_rest)
        )
    s.known = True


@dataclass(frozen=True, slots=True)
class LimpModeParameters:
    """Switch of the search for lost motors, and limits beyond which a motor counts as one."""

    watch: bool = setting(
        False, about="whether a lost motor is found by its torque, and its partner mirrors it"
    )
    plausibility: LostMotorParameters = group(LostMotorParameters)


def limp_mode_for(group: str) -> Need:
    """Need of equal motors at all wheels, where the parameters of a group ask for the limp mode."""

    def lacks(parameters: Any, vehicle: Vehicle) -> str:
        if not attrgetter(group)(parameters).watch:
            return ""
        lacking = each_driven(parameters, vehicle) or equal_motors(parameters, vehicle)
        return f"{lacking} for {group}.watch" if lacking else ""

    return lacks


class Limited(NamedTuple):
    """Torques as they were asked for, as traction control limits them, and as they act."""

    request: WheelTorqueRequest
    drive: Wheels  # limited drive torques [N m]
    wheels: WheelStates


@compilable
def without_yaw(
    p: LostMotorParameters, car: Car, s: LostMotors, period: float, asked: Limited
) -> WheelTorqueCommand:
    """Limited torques; where a motor is lost, its partner gives what the lost one gives.

    A lost motor leaves one of the axle's two torques to choose: with it the car keeps either its
    drive or the difference of left and right. It keeps the difference that was asked for, which is
    what turns the car; what traction control took away was not asked for. For each wheel the
    command is

    - the limited torque, to the bit, unless the motor of its partner is lost and its own is not,
    - else of the same sign and not larger, whatever the lost motor gives: never backwards, never
      beyond traction control, never against the brake,
    - less by what the lost motor gives beyond its own request: in sum not more than was asked for.

    `keep_difference` is for cars that their drives steer: without brake torque the difference of
    the requests may be given whatever its sign is and however small the request, within traction
    control.

    A lost motor gets what was asked of it, so that it shows when it comes back: its partner then
    gives the same at once, and after `recovery` of torques that are not about zero it counts as
    sound.
    """
    watch_torques(p, car, s, period, asked.wheels)
    drive = Wheels(
        as_partner(p, car, s, asked, 0),
        as_partner(p, car, s, asked, 1),
        as_partner(p, car, s, asked, 2),
        as_partner(p, car, s, asked, 3),
    )
    command = WheelTorqueCommand(drive, asked.request.brake)
    expect(p, car, s, period, command, asked.wheels)
    return command


@compilable
def as_partner(p: LostMotorParameters, car: Car, s: LostMotors, torques: Limited, i: int) -> float:
    """Torque of wheel i [N m]: its limited one, or what its lost partner gives."""
    j = PARTNERS[i]
    limited, request = torques.drive[i], torques.request
    if not s.lost[j] or s.lost[i]:
        return limited
    ahead = copysign(1.0, limited)
    gives = ahead * measured(torques.wheels, j)
    asked = ahead * request.drive[i]
    of_lost = ahead * request.drive[j]
    # The difference of the axle turns the car; the partner gives it from what the lost motor has.
    difference, limit = asked - of_lost, abs(limited)
    least, most = 0.0, max(limit - max(gives - max(of_lost, 0.0), 0.0), 0.0)
    if p.keep_difference and request.brake == NO_WHEELS:
        reach = limit if limit < abs(asked) else inf
        least = min(max(difference, -reach), least)
        most = max(min(difference, reach), most)
    # Both are to act alike, so the command makes up for the gear. Its loss depends on which way
    # the power flows.
    efficiency = car.motor.gear_efficiency
    drives = gives * (ahead * torques.wheels.velocity[j]) >= 0.0
    alike = gives / efficiency if drives else gives * efficiency
    return ahead * min(max(alike + difference, least), most)
