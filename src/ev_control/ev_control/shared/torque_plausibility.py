"""Does a wheel get the torque that it was told? What a controller can see of a lost motor, and what it does then.

No motor tells that it is dead. It shows in the torque that acts, which the inverter derives from its currents: beside
what was commanded, at once or through the longest lag of the drive, and within what the motor can, it stays away for
longer than any transient. Where the motor gives again what is asked for, it counts as sound again.
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.shared.first_order_filter import filter_share
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry, per_wheel
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.parameters.declaration import parameter
from ev_msgs_py.vehicle.car import Car


@dataclass(frozen=True, slots=True)
class PlausibilityParameters:
    """When a torque is not plausible; all of it is assumed."""

    lag: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="longest time constant of the drives, between command and torque"
    )
    tolerance: float = parameter(20.0, unit="N m", low=0.1, high=1e4, about="deviation at the wheel that is allowed")
    share: float = parameter(0.2, unit="1", low=0.0, high=1.0, about="of the expected torque, allowed besides")
    time: float = parameter(0.02, unit="s", low=0.0, high=10.0, about="of deviation until a motor counts as lost")
    keep_difference: bool = parameter(
        True, about="whether the partner of a lost motor also gives the difference that was asked of the two"
    )
    recovery: float = parameter(
        0.5, unit="s", low=0.0, high=100.0, about="of torques as expected, not about zero, until it counts as sound"
    )


@dataclass(slots=True)
class PlausibilityState:
    """What is known of the four motors."""

    commanded: list[float] = per_wheel(unit="N m", about="torque at the wheel by the last command, of a quick drive")
    expected: list[float] = per_wheel(
        unit="N m", about="torque at the wheel by the commands up to now, of a slow drive"
    )
    deviates: list[float] = per_wheel(unit="s", about="for how long it has not been as expected")
    agrees: list[float] = per_wheel(unit="s", about="for how long it has, since it was lost")
    lost: list[float] = per_wheel(unit="1", about="1 while the motor counts as lost")
    known: float = entry(unit="1", about="whether there has been a command")


@compilable
def watch_torques(
    p: PlausibilityParameters, car: Car, s: PlausibilityState, period: float, wheels: WheelStates
) -> None:
    """Compare the torques of the last period with those that were expected of it."""
    for i in range(4):
        if car.driven[i] == 0.0 or s.known == 0.0:
            continue
        least, most = min(s.expected[i], s.commanded[i]), max(s.expected[i], s.commanded[i])
        allowed = p.tolerance + p.share * max(abs(least), abs(most))
        if not least - allowed <= wheels.effort[i] <= most + allowed:
            s.deviates[i] += period
            s.agrees[i] = 0.0
            if s.deviates[i] > p.time:
                s.lost[i] = 1.0
        elif least > allowed or most < -allowed:  # about zero a dead motor looks like a sound one
            s.deviates[i] = 0.0
            s.agrees[i] += period
            if s.agrees[i] > p.recovery:
                s.lost[i] = 0.0


@compilable
def expect(
    p: PlausibilityParameters,
    car: Car,
    s: PlausibilityState,
    period: float,
    command: WheelTorqueCommand,
    wheels: WheelStates,
) -> None:
    """Go on with what is expected by the command of this period, within peak torque and power of the motors."""
    share, motor = filter_share(period, p.lag), car.motor
    for i in range(4):
        turns = max(abs(wheels.velocity[i]) * car.gear_ratio, 1e-3)
        most = min(motor.peak_torque, motor.peak_power / turns) * car.gear_ratio
        reached = min(max(command.drive[i], -most), most)
        s.commanded[i] = reached
        s.expected[i] += share * (reached - s.expected[i])
    s.known = 1.0


@compilable
def mirrored(p: PlausibilityParameters, s: PlausibilityState, drive: Wheels, wheels: WheelStates) -> Wheels:
    """Drive torques [N m] with which a lost motor does not turn the car: its partner of the axle gives what it gives.

    Never more than was asked for, and never of the other sign, so a motor that is stuck is mirrored up to the request.
    With `keep_difference` the difference of the two that was asked for is added, whatever sign comes of it.
    """
    effort = wheels.effort
    return Wheels(
        as_partner(p, s.lost[1], drive[0], drive[1], effort[1]),
        as_partner(p, s.lost[0], drive[1], drive[0], effort[0]),
        as_partner(p, s.lost[3], drive[2], drive[3], effort[3]),
        as_partner(p, s.lost[2], drive[3], drive[2], effort[2]),
    )


@compilable
def as_partner(p: PlausibilityParameters, lost: float, asked: float, of_lost: float, measured: float) -> float:
    """What a wheel may give [N m] whose partner, if it is lost, gives the measured torque in place of `of_lost`."""
    if lost == 0.0:
        return asked
    if p.keep_difference == 1.0:
        return measured + (asked - of_lost)
    return min(max(measured, 0.0), asked) if asked >= 0.0 else max(min(measured, 0.0), asked)
