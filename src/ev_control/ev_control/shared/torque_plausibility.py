"""Which motors are lost: beside what they were told, and beside what their partners of the axle give.

No motor tells that it is dead. It shows in the torque that acts, which the inverter derives from its currents. A torque
that was not told is never plausible. Less than was told is: battery, voltage, power, heat and gear leave less, more than
a controller knows of. But they are the same for both motors of an axle. So a motor is lost if it gives less than its
partner shows to be possible. Where both give less, nothing is lost, and nothing turns the car.
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.plausible import LARGEST_TORQUE
from ev_control.shared.first_order_filter import filter_share
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry, per_wheel
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueCommand
from ev_msgs_py.elementary import copysign
from ev_msgs_py.parameters.declaration import parameter
from ev_msgs_py.vehicle.car import Car

PARTNERS = (1, 0, 3, 2)  # the other wheel of the axle, in the order of Wheels
TURNING = 1.0  # [rad/s], wheel speeds far below it are alike
NEARLY_FASTEST = 0.95  # share of the motor's maximum speed from which on no torque is expected of it


@dataclass(frozen=True, slots=True)
class PlausibilityParameters:
    """When a torque is not plausible; all of it is assumed."""

    lag: float = parameter(
        0.0,
        unit="s",
        low=0.0,
        high=1.0,
        about="of bus and sensor between command and measured torque, beside the car's `motor.torque_lag`",
    )
    tolerance: float = parameter(20.0, unit="N m", low=0.1, high=1e4, about="deviation at the wheel that is allowed")
    share: float = parameter(0.2, unit="1", low=0.0, high=1.0, about="of the expected torque, allowed besides")
    time: float = parameter(
        0.02, unit="s", low=0.0, high=10.0, about="of twice the allowed deviation until a motor counts as lost"
    )
    keep_difference: bool = parameter(
        False,
        about="whether drives steer the car: the difference that was asked of a lost motor and its partner is given also "
        "where the partner's torque changes its sign by it",
    )
    recovery: float = parameter(
        0.5, unit="s", low=0.0, high=100.0, about="of torques as told, not about zero, until it counts as sound"
    )


@dataclass(slots=True)
class PlausibilityState:
    """What is known of the four motors."""

    least: list[float] = per_wheel(unit="N m", about="torque at the wheel by the commands up to now, at least")
    most: list[float] = per_wheel(unit="N m", about="the same, at most")
    deviates: list[float] = per_wheel(unit="s", about="for how long it has not been plausible, less how long it has")
    agrees: list[float] = per_wheel(unit="s", about="for how long it has been plausible, since it was lost")
    lost: list[float] = per_wheel(unit="1", about="1 while the motor counts as lost")
    known: float = entry(unit="1", about="whether there has been a command")


@compilable
def watch_torques(
    p: PlausibilityParameters, car: Car, s: PlausibilityState, period: float, wheels: WheelStates
) -> None:
    """Compare the torques of the last period with what was told, and with those of the partners.

    A deviation counts by its size, at most twice what is allowed, and what is plausible takes back: so noise about the
    allowed deviation does not add up. A motor without a partner is not judged.
    """
    if s.known == 0.0:
        return
    for i in range(4):
        if car.driven[i] == 0.0 or car.driven[PARTNERS[i]] == 0.0:
            continue
        due = due_torque(p, car, s, wheels, i)
        excess = deviation(p, s, wheels, i, due)
        if s.lost[i] == 0.0:
            s.deviates[i] = max(s.deviates[i] + period * min(excess - 1.0, 1.0), 0.0)
            s.agrees[i] = 0.0
        elif excess > 1.0:
            s.agrees[i] = 0.0
        elif abs(due) > p.tolerance + p.share * abs(due):  # else a dead motor looks like a sound one
            s.agrees[i] += period
    for i in range(4):  # behind all judgements, so that left and right are alike
        if s.deviates[i] > p.time:
            s.lost[i], s.deviates[i] = 1.0, 0.0
        elif s.agrees[i] > p.recovery:
            s.lost[i] = 0.0


@compilable
def deviation(p: PlausibilityParameters, s: PlausibilityState, wheels: WheelStates, i: int, due: float) -> float:
    """How much more than was told, or less than is due [N m], a motor gives, over what is allowed [1]."""
    gives, most, least = measured(wheels, i), max(s.most[i], 0.0), min(s.least[i], 0.0)
    if gives > most:
        return (gives - most) / (p.tolerance + p.share * most)
    if gives < least:
        return (least - gives) / (p.tolerance - p.share * least)
    return (abs(due) - copysign(1.0, due) * gives) / (p.tolerance + p.share * abs(due))


@compilable
def due_torque(p: PlausibilityParameters, car: Car, s: PlausibilityState, wheels: WheelStates, i: int) -> float:
    """What motor i gives at least if it is sound [N m].

    Of a motor that is not lost: the share of what it was told that its partner gives of its own, and no more than that
    gives, at its speed and power; nothing where the partner is lost or told nothing of the kind. A lost motor must give
    what it was told, in that share if the partner shows one. Of none more than what it can give for ever.
    """
    ahead = 1.0 if s.least[i] > 0.0 else -1.0 if s.most[i] < 0.0 else 0.0
    j, turns = PARTNERS[i], abs(wheels.velocity[i])
    if ahead == 0.0 or turns * car.gear_ratio > NEARLY_FASTEST * car.motor.maximum_speed:
        return 0.0
    told, told_partner = least_of(s, i, ahead), least_of(s, j, ahead)
    gives = max(ahead * measured(wheels, j), 0.0)
    shows = s.lost[j] == 0.0 and told_partner > p.tolerance
    due = min(told, car.motor.nominal_torque * car.gear_ratio)
    if shows:
        due = min(due, told * (gives / told_partner))
    if s.lost[i] == 0.0:
        slower = min((abs(wheels.velocity[j]) + TURNING) / (turns + TURNING), 1.0)
        due = min(due, gives * slower) if shows else 0.0
    return ahead * due


@compilable
def least_of(s: PlausibilityState, i: int, ahead: float) -> float:
    """The torque that motor i was told at least [N m], counted positive in the direction `ahead`."""
    return s.least[i] if ahead > 0.0 else -s.most[i]


@compilable
def measured(wheels: WheelStates, i: int) -> float:
    """The torque of a motor [N m]; one that nobody can measure, as broken sensors show, counts as none."""
    return wheels.effort[i] if abs(wheels.effort[i]) < LARGEST_TORQUE else 0.0


@compilable
def expect(
    p: PlausibilityParameters,
    car: Car,
    s: PlausibilityState,
    period: float,
    command: WheelTorqueCommand,
    wheels: WheelStates,
) -> None:
    """Go on with what is told: the bounds widen at once, as a quick drive, and close by the lag, as a slow one.

    They leave room for the gear either way, and for what motors serve of the brake torque where brakes are blended.
    """
    share, efficiency = filter_share(period, car.motor.torque_lag + p.lag), car.motor.gear_efficiency
    for i in range(4):
        drive = command.drive[i]
        braked = drive - copysign(car.blend_brakes * command.brake[i], wheels.velocity[i])
        low, high = min(drive, braked), max(drive, braked)
        low = low * efficiency if low > 0.0 else low / efficiency
        high = high / efficiency if high > 0.0 else high * efficiency
        if s.known == 0.0:
            s.least[i] = s.most[i] = measured(wheels, i)
        s.least[i] = min(low, s.least[i] + share * (low - s.least[i]))
        s.most[i] = max(high, s.most[i] + share * (high - s.most[i]))
    s.known = 1.0
