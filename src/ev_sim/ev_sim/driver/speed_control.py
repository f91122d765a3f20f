"""The driver's feet: follow a speed by drive torque, regeneration and brakes (PI speed control of Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary import copysign
from ev_msgs_py.parameters.declaration import parameter
from ev_sim.driver.limited_pid import limited_pid


@dataclass(frozen=True, slots=True)
class SpeedControlParameters:
    """PI control of the speed and what the pedals can ask for; all torques are sums over the wheels.

    The paper names the PI controller but gives neither gains nor limits. The gains suit a car of 1400 kg.
    """

    proportional_gain: float = parameter(
        2000.0, unit="N m s/m", low=0.0, high=1e6, about="torque per speed error", source="assumption"
    )
    integral_gain: float = parameter(
        1000.0, unit="N m/m", low=0.0, high=1e6, about="torque per integral of the speed error", source="assumption"
    )
    max_drive_torque: float = parameter(
        1500.0, unit="N m", low=0.0, high=1e6, about="limit when driving, forwards or backwards", source="assumption"
    )
    max_regenerative_torque: float = parameter(
        600.0,
        unit="N m",
        low=0.0,
        high=1e6,
        about="limit of the drives when they slow the car down; beyond it the friction brakes take over",
        source="assumption",
    )
    max_brake_torque: float = parameter(
        4000.0, unit="N m", low=0.0, high=1e6, about="limit of the friction brakes, about 1 g", source="assumption"
    )
    holding_brake_torque: float = parameter(
        500.0, unit="N m", low=0.0, high=1e6, about="brake torque while the driver wants to stand", source="assumption"
    )
    standstill_speed: float = parameter(
        0.05, unit="m/s", low=0.0, high=1.0, about="speed below which the car counts as standing", source="assumption"
    )


@compilable
def follow_speed(
    p: SpeedControlParameters, period: float, wanted_speed: float, speed: float, integral: float
) -> tuple[float, float, float]:
    """Drive torque (positive forwards), brake torque (never negative) and new integral part [N m]; speeds [m/s].

    A PI controller (Shchur 2019, fig. 3) gives the wanted torque. In the direction of travel it goes to the drives;
    against it, to the drives up to the regenerative limit, and the rest to the friction brakes. A driver who wants to
    stand, and does, lets go of the drives and holds the brake.
    """
    standing = abs(speed) <= p.standstill_speed
    if standing and wanted_speed == 0.0:
        return 0.0, p.holding_brake_torque, 0.0
    low, high = -p.max_drive_torque, p.max_drive_torque
    slowing = p.max_regenerative_torque + p.max_brake_torque
    if speed > p.standstill_speed:
        low = -slowing
    elif speed < -p.standstill_speed:
        high = slowing
    error = wanted_speed - speed
    direct, growth = p.proportional_gain * error, p.integral_gain * period * error
    torque, integral = limited_pid(direct, growth, integral, low, high)
    brake = abs(torque) - p.max_regenerative_torque
    if standing or torque * speed >= 0.0 or brake <= 0.0:
        return torque, 0.0, integral
    return copysign(p.max_regenerative_torque, torque), brake, integral
