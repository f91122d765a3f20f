"""The driver's feet: follow a speed by drive torque, regeneration and brakes (PI speed control of Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import GRAVITY, Car, compilable, copysign, entry, parameter


@compilable
def limited_pid(direct: float, growth: float, integral: float, low: float, high: float) -> tuple[float, float]:
    """Output within low..high and the new integral part, all in units of the output.

    The output is `direct`, the proportional and derivative action, plus the integral part with its `growth` in this
    period. The integral part holds while the output is limited, unless the error leads it back (clamping).
    """
    grown = integral + growth
    wanted = direct + grown
    if wanted > high:
        return high, min(grown, integral)
    if wanted < low:
        return low, max(grown, integral)
    return wanted, grown


@dataclass(frozen=True, slots=True)
class SpeedControlParameters:
    """PI control of the speed and what the pedals can ask for; all torques are sums over the wheels.

    The paper names the PI controller but gives neither gains nor limits. The gains suit a car of 1400 kg.
    """

    proportional_gain: float = parameter(2000.0, unit="N m s/m", low=0.0, high=1e6, about="torque per speed error")
    integral_gain: float = parameter(
        1000.0, unit="N m/m", low=0.0, high=1e6, about="torque per integral of the speed error"
    )
    max_drive_torque: float = parameter(
        1500.0, unit="N m", low=0.0, high=1e6, about="limit when driving, forwards or backwards"
    )
    max_regenerative_torque: float = parameter(
        600.0,
        unit="N m",
        low=0.0,
        high=1e6,
        about="limit of the drives when they slow the car down; beyond it the friction brakes take over",
    )
    max_brake_torque: float = parameter(
        4000.0, unit="N m", low=0.0, high=1e6, about="limit of the friction brakes that slow down, about 1 g"
    )
    holding_share: float = parameter(
        2.0,
        unit="1",
        low=0.0,
        high=100.0,
        about="brake torque while the driver wants to stand, over weight times wheel radius, which is what all wheels "
        "together need on a slope of 90 deg: 2, so that the axle with the smaller share of the brakes holds, too",
    )
    standstill_speed: float = parameter(
        0.05, unit="m/s", low=0.0, high=1.0, about="speed below which the car counts as standing"
    )


@dataclass(slots=True)
class SpeedControlState:
    """What the feet remember."""

    integral: float = entry(unit="N m", about="integral part of the speed control")
    holds: float = entry(unit="", about="1 while the car is held by the brake")


@compilable
def follow_speed(
    p: SpeedControlParameters, car: Car, s: SpeedControlState, period: float, wanted_speed: float, speed: float
) -> tuple[float, float]:
    """Drive torque (positive forwards) and brake torque (never negative) [N m]; speeds [m/s].

    A PI controller (Shchur 2019, fig. 3) gives the wanted torque. In the direction of travel it goes to the drives;
    against it, to the drives up to the regenerative limit, and the rest to the friction brakes. A driver who wants to
    stand, and does, lets go of the drives and holds the brake, as hard as the steepest slope asks, and however far its
    tyres slide until they hold. An engine slows nothing down, and what is asked of it against its gear moves the
    selector: there all goes to the brakes.
    """
    standing = abs(speed) <= p.standstill_speed
    s.holds = 1.0 if wanted_speed == 0.0 and (standing or s.holds == 1.0) else 0.0
    if s.holds == 1.0:
        s.integral = 0.0
        return 0.0, p.holding_share * car.mass * GRAVITY * car.wheel_radius
    low, high = -p.max_drive_torque, p.max_drive_torque
    regenerative = p.max_regenerative_torque * (1.0 - car.engine_driven)
    slowing = regenerative + p.max_brake_torque
    if speed > p.standstill_speed:
        low = -slowing
    elif speed < -p.standstill_speed:
        high = slowing
    error = wanted_speed - speed
    direct, growth = p.proportional_gain * error, p.integral_gain * period * error
    torque, s.integral = limited_pid(direct, growth, s.integral, low, high)
    brake = abs(torque) - regenerative
    if standing or torque * speed >= 0.0 or brake <= 0.0:
        return torque, 0.0
    return copysign(regenerative, torque), brake
