"""Electronic differentials as tests drive them.

All that a law may measure, mirrored cars, the cars of the sources.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from hypothesis import strategies as st

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create, refuse_layout
from ev_core.parameters.declaration import Choice
from ev_core.parameters.record import names
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    Instant,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels

ROLE = "electronic_differential"
FRONT, REAR = ("front_left", "front_right"), ("rear_left", "rear_right")
SHCHUR = Vehicle()
GE_NI = Vehicle(
    name="ge_ni2005",
    mass=2500.0,
    wheelbase=1.72,
    front_track=1.12,
    rear_track=1.12,
    centre_of_mass_to_rear_axle=0.82,
    wheel_radius=0.32,
    driven_wheels=REAR,
)
ZHILEYKIN = Vehicle(
    name="zhileykin_4x4",
    mass=2400.0,
    wheelbase=2.7,
    front_track=1.55,
    rear_track=1.55,
    centre_of_mass_to_rear_axle=1.35,
    wheel_radius=0.35,
    yaw_inertia=4200.0,
    driven_wheels=WHEEL_NAMES,
)
DISSERTATION = Vehicle(
    name="dissertation_class_b",
    mass=2170.0,
    wheelbase=2.699,
    front_track=1.544,
    rear_track=1.551,
    centre_of_mass_to_rear_axle=1.37649,
    wheel_radius=0.32,
    gear_ratio=7.4,
    centre_of_mass_height=0.55,
    front_roll_share=0.51,
    wheel_inertia=1.658,
    motor=Motor(peak_torque=360.0, rotor_inertia=0.02),
)
GRAVITY = 9.81  # m/s^2
# Load of each front wheel of the dissertation's car at rest [N].
FRONT_LOAD = 2170.0 * GRAVITY * 1.37649 / 2.699 / 2
CENTRED = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)
ASPHALT = Wheels.all(0.8)  # friction [1]
LOADS = Wheels.all(5000.0)  # [N]


def on(car: Vehicle, driven: tuple[str, ...]) -> Vehicle:
    """The same car with other driven wheels."""
    return dataclasses.replace(car, driven_wheels=driven)


@dataclasses.dataclass(frozen=True)
class Motion:
    """Everything that a law may measure, in SI units."""

    torque: float = 0.0
    brake: float = 0.0
    column: SteeringColumnState = CENTRED
    speeds: Wheels = NO_WHEELS
    efforts: Wheels = NO_WHEELS
    u: float = 5.0
    v: float = 0.0
    r: float = 0.0
    a_x: float = 0.0
    a_y: float = 0.0
    friction: Wheels = ASPHALT
    load: Wheels = LOADS
    time: float = 0.0

    def steered(self, road_wheel_angle: float) -> Motion:
        """The same with road wheels turned by an angle [rad], at rest."""
        return dataclasses.replace(
            self, column=SteeringColumnState(16 * road_wheel_angle, 0, 0, road_wheel_angle, 0)
        )

    def mirrored(self) -> Motion:
        """Left and right swapped."""
        swapped = {
            name: Wheels(value.front_right, value.front_left, value.rear_right, value.rear_left)
            for name, value in vars(self).items()
            if isinstance(value, Wheels)
        }
        column = SteeringColumnState(*(-value for value in self.column))
        return dataclasses.replace(
            self, **swapped, column=column, v=-self.v, r=-self.r, a_y=-self.a_y
        )

    def signals(self) -> dict[type, Any]:
        """The signals by their types."""
        values = (
            Instant(self.time),
            DriverCommand(self.torque, self.brake, self.column.hand_torque),
            self.column,
            WheelStates(NO_WHEELS, self.speeds, self.efforts),
            InertialMeasurement(self.r, self.a_x, self.a_y),
            BodyVelocity(self.u, self.v, self.r),
            TireForces(NO_WHEELS, NO_WHEELS, self.load, NO_WHEELS, NO_WHEELS, self.friction),
        )
        return {type(signal): signal for signal in values}


class Differential:
    """A new object of an electronic differential; ParameterError if the car does not suit."""

    def __init__(
        self, name: str, car: Vehicle = SHCHUR, period: float = 0.01, **changed: Any
    ) -> None:
        self.method = find_method(ROLE, name)
        defaults = self.method.parameters()
        for parameter, value in changed.items():
            if isinstance(kind := getattr(defaults, parameter), Choice) and isinstance(value, str):
                changed[parameter] = type(kind).of(value)
        self.parameters = dataclasses.replace(defaults, **changed)
        refuse_layout(self.method, self.parameters, car)
        self.object = create(self.method, self.parameters, car, period)

    def step(self, motion: Motion) -> WheelTorqueRequest:
        """The torques that it asks for."""
        signals = motion.signals()
        return self.object.step(*(signals[kind] for kind in self.method.reads))

    @property
    def state(self) -> dict[str, float]:
        """All that lasts between steps, by name."""
        return dict(zip(names(self.method.law.state()), self.object.state, strict=True))


def wheels(low: float, high: float) -> st.SearchStrategy[Wheels]:
    return st.builds(Wheels, *[st.floats(low, high)] * 4)


columns = st.builds(
    SteeringColumnState,
    st.floats(-16.0, 16.0),
    st.floats(-50.0, 50.0),
    st.floats(-20.0, 20.0),
    st.floats(-0.5, 0.5),
    st.floats(-5.0, 5.0),
)
motions = st.builds(
    Motion,
    torque=st.floats(-3000.0, 3000.0),
    brake=st.sampled_from((0.0, 0.0, 500.0)),
    column=columns,
    speeds=wheels(-10.0, 100.0),
    efforts=wheels(-500.0, 2000.0),
    u=st.floats(-5.0, 30.0),
    v=st.floats(-5.0, 5.0),
    r=st.floats(-1.0, 1.0),
    a_x=st.floats(-5.0, 5.0),
    a_y=st.floats(-5.0, 5.0),
    friction=wheels(0.05, 1.2),
    load=wheels(100.0, 9000.0),
)
sequences = st.lists(motions, min_size=1, max_size=8)
