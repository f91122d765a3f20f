"""Measured wheel torques over time in the place of an electronic differential, chosen by the path of this file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import WHEEL_NAMES, ParameterError, Vehicle, compilable, group, method, setting
from ev_msgs_py.contract.signals import Instant, WheelTorqueRequest
from ev_msgs_py.contract.wheels import Wheels
from ev_sim.profiles.profile import (
    Profile,
    check_points,
    interpolation_parameter,
    profile_of,
    value_at,
)


@dataclass(frozen=True, slots=True)
class DriveTorqueParameters:
    """Drive torques at the given times, by wheel."""

    front_left: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=-1e6, high=1e6, about="at these times"
    )
    front_right: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=-1e6, high=1e6, about="at these times"
    )
    rear_left: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=-1e6, high=1e6, about="at these times"
    )
    rear_right: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=-1e6, high=1e6, about="at these times"
    )


@dataclass(frozen=True, slots=True)
class BrakeTorqueParameters:
    """Brake torques at the given times, by wheel."""

    front_left: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=0.0, high=1e6, about="at these times"
    )
    front_right: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=0.0, high=1e6, about="at these times"
    )
    rear_left: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=0.0, high=1e6, about="at these times"
    )
    rear_right: tuple[float, ...] = setting(
        (0.0,), unit="N m", low=0.0, high=1e6, about="at these times"
    )


@dataclass(frozen=True, slots=True)
class ImposedTorqueParameters:
    """Drive and brake torque of each wheel over time."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    drive: DriveTorqueParameters = group(DriveTorqueParameters)
    brake: BrakeTorqueParameters = group(BrakeTorqueParameters)
    interpolation: str = interpolation_parameter("linear")

    def __post_init__(self) -> None:
        for name in ("drive", "brake"):
            for wheel in WHEEL_NAMES:
                check_points(
                    "time", self.time, f"{name}.{wheel}", getattr(getattr(self, name), wheel)
                )


class WheelProfiles(NamedTuple):
    """A torque of each wheel over time [N m]."""

    front_left: Profile
    front_right: Profile
    rear_left: Profile
    rear_right: Profile


class ImposedTorques(NamedTuple):
    """Torques asked for at the wheels."""

    drive: WheelProfiles
    brake: WheelProfiles


def torques(parameters: ImposedTorqueParameters, vehicle: Vehicle, period: float) -> ImposedTorques:
    """The given torques over time.

    Raises ParameterError for a drive torque at a wheel that is not driven.
    """
    for wheel in WHEEL_NAMES:
        # A brake acts at every wheel, a drive only where there is a motor.
        if any(getattr(parameters.drive, wheel)) and wheel not in vehicle.driven_wheels:
            driven = ", ".join(vehicle.driven_wheels) or "no wheel"
            raise ParameterError(
                f"drive.{wheel}: a torque there is refused, {vehicle.name} drives {driven}"
            )

    def profiles(of: DriveTorqueParameters | BrakeTorqueParameters) -> WheelProfiles:
        each = (
            profile_of(parameters.time, getattr(of, wheel), parameters.interpolation)
            for wheel in WHEEL_NAMES
        )
        return WheelProfiles(*each)

    return ImposedTorques(profiles(parameters.drive), profiles(parameters.brake))


@compilable
def at_wheels(of: WheelProfiles, t: float) -> Wheels:
    """The torques of all wheels at the time t [s]."""
    return Wheels(
        value_at(of.front_left, t),
        value_at(of.front_right, t),
        value_at(of.rear_left, t),
        value_at(of.rear_right, t),
    )


@method(
    "electronic_differential",
    "imposed",
    parameters=ImposedTorqueParameters,
    prepare=torques,
    mirrored=True,
)
@compilable
def imposed(c: ImposedTorques, now: Instant) -> WheelTorqueRequest:
    """Ask each wheel for its drive and brake torque over time, whatever the driver does, as measured ones are."""
    return WheelTorqueRequest(at_wheels(c.drive, now.time), at_wheels(c.brake, now.time))
