"""Traction controls in tests: inputs of a law, mirrored and reversed cars, random drives."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
from hypothesis import strategies as st

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.methods.law import namespace
from ev_core.methods.method_record import create
from ev_core.methods.register import methods_of
from ev_core.parameters.declaration import number_tree
from ev_core.parameters.record import names
from ev_core.parameters.values import build
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.signals import (
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels

ROLE = "asr"
PERIOD = 0.005
_ALL = tuple(
    name for name in methods_of(ROLE) if name not in ("off", "limp_home", "limit", "blended_brakes")
)
# they command the speeds of wheels
SPEED_MODE = tuple(name for name in _ALL if find_method(ROLE, name).requires)
METHODS = tuple(name for name in _ALL if name not in SPEED_MODE)
LITERAL = ("held_torque", "least_squares_literal")
CONTROLS = tuple(name for name in METHODS if name not in LITERAL)  # those that take torque away
FRONT, REAR = ("front_left", "front_right"), ("rear_left", "rear_right")
CAR = Vehicle(
    mass=2170.0,
    wheel_radius=0.32,
    gear_ratio=7.4,
    wheel_inertia=1.658,
    motor=Motor(rotor_inertia=0.02, nominal_torque=250.0),
)
# rad/s, the set-point of a wheel that is not limited
FASTEST = CAR.motor.maximum_speed / CAR.gear_ratio
INERTIA = 1.658 + 7.4**2 * 0.02  # kg m^2, J of a driven wheel


def numbers_of(parameters: Any) -> SimpleNamespace:
    """Parameters as a law is given them."""
    return namespace(number_tree(parameters))


def car_of(vehicle: Vehicle) -> SimpleNamespace:
    """A vehicle as a law is given it."""
    return namespace(car_numbers(vehicle))


def on(driven: tuple[str, ...]) -> Vehicle:
    """The car with other driven wheels."""
    return dataclasses.replace(CAR, driven_wheels=driven)


def in_regulator(name: str, parameter: str) -> str:
    """The full name of a parameter that some laws have in the group `regulator`."""
    return (
        f"regulator.{parameter}"
        if hasattr(find_method(ROLE, name).parameters(), "regulator")
        else parameter
    )


def swapped(wheels: Wheels) -> Wheels:
    return Wheels(wheels[1], wheels[0], wheels[3], wheels[2])


@dataclasses.dataclass(frozen=True)
class Measured:
    """Inputs of a law in a step."""

    drive: Wheels = NO_WHEELS
    brake: Wheels = NO_WHEELS
    speed: Wheels = NO_WHEELS
    torque: Wheels = NO_WHEELS
    angle: float = 0.0
    yaw_rate: float = 0.0
    a_x: float = 0.0
    a_y: float = 0.0

    def mirrored(self) -> Measured:
        sides = {
            name: swapped(getattr(self, name)) for name in ("drive", "brake", "speed", "torque")
        }
        return Measured(
            **sides, angle=-self.angle, yaw_rate=-self.yaw_rate, a_x=self.a_x, a_y=-self.a_y
        )

    def reversed(self) -> Measured:
        """The same drive backwards.

        What turns, pushes or yaws changes its sign, what holds in the bend does not.
        """
        turned = {
            name: Wheels(*(-x for x in getattr(self, name)))
            for name in ("drive", "speed", "torque")
        }
        return Measured(
            **turned,
            brake=self.brake,
            angle=self.angle,
            yaw_rate=-self.yaw_rate,
            a_x=-self.a_x,
            a_y=self.a_y,
        )

    def signals(
        self,
    ) -> tuple[WheelTorqueRequest, SteeringColumnState, WheelStates, InertialMeasurement]:
        return (
            WheelTorqueRequest(self.drive, self.brake),
            SteeringColumnState(0.0, 0.0, 0.0, self.angle, 0.0),
            WheelStates(NO_WHEELS, self.speed, self.torque),
            InertialMeasurement(self.yaw_rate, self.a_x, self.a_y),
        )


class Control:
    """A traction control, interpreted."""

    def __init__(
        self, name: str, car: Vehicle = CAR, period: float = PERIOD, **changed: Any
    ) -> None:
        method = find_method(ROLE, name)
        self.law = create(method, build(method.parameters, changed), car, period)
        self.names = names(method.law.state())

    def step(self, m: Measured) -> Wheels:
        """The drive torques that it lets through [N m]."""
        return self.law.step(*m.signals()).drive

    def set_points(self, m: Measured) -> Wheels:
        """The wheel speeds that it sets drives in speed mode [rad/s]."""
        command, speeds = self.law.step(*m.signals())
        assert command == WheelTorqueCommand(m.drive, m.brake)
        return speeds.speed

    def state(self) -> dict[str, float]:
        return dict(zip(self.names, self.law.state, strict=True))

    def of_wheel(self, wheel: str = "front_left") -> dict[str, float]:
        """The state of one wheel."""
        begin = f"wheels.{wheel}."
        return {
            name.removeprefix(begin): value
            for name, value in self.state().items()
            if name.startswith(begin)
        }

    def limits(self) -> list[float]:
        state = self.state()
        return [state[f"wheels.{wheel}.limit"] for wheel in WHEEL_NAMES]


SPINNING = Measured(
    Wheels.front(1500.0, 1500.0),
    speed=Wheels(30.0, 30.0, 10.0, 10.0),
    torque=Wheels.front(1500.0, 1500.0),
    a_x=1.0,
)


def spinning_at(left: float, right: float) -> Measured:
    """Front wheels at these speeds [rad/s] over a car that rolls at 10 rad/s."""
    return dataclasses.replace(SPINNING, speed=Wheels(left, right, 10.0, 10.0))


def spun_up(name: str) -> Control:
    """A law behind a spin-up of both front wheels to 30 rad/s in 0.2 s, others at 10 rad/s."""
    law = Control(name)
    for speed in np.linspace(10.0, 30.0, 40).tolist():
        law.step(spinning_at(speed, speed))
    return law


# Random drives for hypothesis


def per_wheel(low: float, high: float) -> Any:
    return st.builds(Wheels, *[st.floats(low, high)] * 4)


drives = per_wheel(-3000.0, 3000.0) | st.floats(-3000.0, 3000.0).map(Wheels.all)
driven = st.builds(
    Measured,
    drive=drives,
    brake=st.sampled_from((NO_WHEELS, NO_WHEELS, NO_WHEELS, Wheels.all(100.0))),
    speed=per_wheel(-10.0, 100.0),
    torque=drives,
    angle=st.floats(-0.6, 0.6),
    yaw_rate=st.floats(-1.0, 1.0),
    a_x=st.floats(-8.0, 8.0),
    a_y=st.floats(-8.0, 8.0),
)
any_number = st.floats(allow_nan=False, allow_infinity=False)
any_wheels = st.builds(Wheels, *[any_number] * 4)
anything = st.builds(
    Measured,
    drive=any_wheels,
    brake=st.just(NO_WHEELS),
    speed=any_wheels,
    torque=any_wheels,
    angle=any_number,
    yaw_rate=any_number,
    a_x=any_number,
    a_y=any_number,
)
# A constant request and random motion for a while is what fills windows and starts interventions.
launches = st.tuples(drives, st.lists(driven, min_size=1, max_size=12)).map(
    lambda drawn: [dataclasses.replace(m, drive=drawn[0], brake=NO_WHEELS) for m in drawn[1] * 4]
)
sequences = launches | st.lists(driven, min_size=1, max_size=30)
cars = st.sampled_from([on(layout) for layout in (FRONT, REAR, WHEEL_NAMES)])


def configured(name: str, **changed: Any) -> Any:
    """The configuration of a control on the car of the tests, at their period."""
    vehicle = {
        "vehicle.mass": CAR.mass,
        "vehicle.wheel_radius": CAR.wheel_radius,
        "vehicle.gear_ratio": CAR.gear_ratio,
        "vehicle.wheel_inertia": CAR.wheel_inertia,
        "vehicle.motor.rotor_inertia": CAR.motor.rotor_inertia,
        "vehicle.motor.nominal_torque": CAR.motor.nominal_torque,
        "vehicle.driven_wheels": list(CAR.driven_wheels),
    }
    return configure(ROLE, {"method": name, "control_period": PERIOD, **vehicle, **changed})
