"""Shchur's traction model: a point mass on wheels that roll without slip (Shchur 2019, eqs 8 to 13)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import parameter
from ev_msgs_py.signals import (
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels
from ev_sim.compiled import compiled
from ev_sim.drives.drive import DriveParameters, advance_drive, drive_record, drives_at_rest
from ev_sim.drives.records import record_of
from ev_sim.plant.ackermann import course_offset, path_curvature, wheel_speed_ratios
from ev_sim.plant.commands import CommandGuard
from ev_sim.plant.dry_friction import move_with_dry_friction

GRAVITY = 9.81  # [m/s^2]

CAR_STATE = np.dtype(
    [
        ("speed", np.float64),  # V, of the centre of mass along its path, backwards negative [m/s]
        ("acceleration", np.float64),  # along the path, mean over the last control period [m/s^2]
        ("path_curvature", np.float64),  # 1/R, positive to the left [1/m]
        ("course_offset", np.float64),  # from the car's x axis to the path, left positive [rad]
        ("x", np.float64),  # of the centre of mass in odom [m]
        ("y", np.float64),  # [m]
        ("heading", np.float64),  # [rad]
    ]
)

WHEEL_STATE = np.dtype(
    [
        ("has_motor", np.int64),  # 1 where a motor drives the wheel
        ("position", np.float64),  # turned angle [rad]
        ("speed_ratio", np.float64),  # V_j/V
        ("mean_torque", np.float64),  # of the drive at the wheel, over the last control period [N m]
    ]
)

WHEEL_TORQUES = np.dtype([("drive", np.float64), ("brake", np.float64)])


@dataclass(frozen=True, slots=True)
class KinematicPlantParameters(DriveParameters):
    """Drives, supply and integration of the kinematic plant; the car itself is the vehicle description."""

    bus_voltage: float = parameter(
        480.0,
        unit="V",
        low=1.0,
        high=2000.0,
        about="constant voltage of the bus; assumed, the paper's second turn needs more than the 381 V of the EMF",
    )
    sub_step: float = parameter(
        1e-3, unit="s", low=1e-6, high=1e-3, about="longest step of the motion, over which the drives see one speed"
    )
    initial_speed: float = parameter(0.0, unit="m/s", low=-100.0, high=100.0, about="speed at the start")


@dataclass(slots=True)
class KinematicPlantState:
    """Car, wheels and drives as arrays that are integrated in place: (1,) CAR_STATE, (4,) WHEEL_STATE, DRIVE_STATE."""

    car: np.ndarray
    wheels: np.ndarray
    drives: np.ndarray


@method("plant", "kinematic")
class KinematicPlant:
    """Point mass, wheels that roll without slip on Ackermann's radii, resistance and brakes as dry friction.

    m V' = sum(M_j)/r_k - 0.5 rho c_d A V |V| - (k_r m g + sum(brake torques)/r_k) sgn(V), eq 13 with its traction
    equation; V_j = V R_j/R by eqs 8 to 11. As in the paper V is the speed of the centre of mass along its path, whose
    x and y components BodyVelocity carries, and the inertia of wheels, motors and yaw is left out. The road-wheel
    angle is held over a control period, so the car then moves on a circular arc, which is integrated exactly.
    """

    parameters = KinematicPlantParameters
    writes = (WheelStates, MotorStates, InertialMeasurement, BodyVelocity, BodyPose)

    __slots__ = (
        "_drive_parameters",
        "_gear_ratio",
        "_parameters",
        "_period",
        "_radius",
        "_torques",
        "_vehicle",
        "guard",
        "state",
    )

    def __init__(self, parameters: KinematicPlantParameters, vehicle: Vehicle, period: float) -> None:
        self._parameters = record_of(parameters)
        self._drive_parameters = drive_record(parameters)
        self._vehicle = record_of(vehicle)
        self._period = period
        # The paper's steering has no stop, its column swings beyond a right angle; eqs 8 to 11 hold at any angle.
        self.guard = CommandGuard(vehicle, parameters.motor.torque_limit, angle_limit=math.inf)
        self._radius, self._gear_ratio = vehicle.wheel_radius, vehicle.gear_ratio
        car = np.zeros(1, CAR_STATE)
        car["speed"] = parameters.initial_speed
        wheels = np.zeros(len(WHEEL_NAMES), WHEEL_STATE)
        wheels["has_motor"] = [name in vehicle.driven_wheels for name in WHEEL_NAMES]
        wheels["speed_ratio"] = 1.0
        self.state = KinematicPlantState(car, wheels, drives_at_rest(len(WHEEL_NAMES)))
        self._torques = np.zeros(len(WHEEL_NAMES), WHEEL_TORQUES)

    def outputs(self) -> tuple[WheelStates, MotorStates, InertialMeasurement, BodyVelocity, BodyPose]:
        """The signals of this instant; wheel torques and acceleration are means over the control period before it.

        The means are what moved the car, chopping and commutation ripple included; the motors' torque is the one of
        this instant, so it shows the ripple. Of the road-wheel angle the plant knows what was held until now.
        """
        speed, acceleration, curvature, offset, x, y, heading = self.state.car[0].item()
        yaw_rate = speed * curvature
        along, across = math.cos(offset), math.sin(offset)
        centripetal = speed * yaw_rate

        wheels = self.state.wheels
        wheel_speeds = [ratio * speed / self._radius for ratio in wheels["speed_ratio"].tolist()]
        shaft_speeds = [
            self._gear_ratio * wheel_speed if has_motor else 0.0
            for wheel_speed, has_motor in zip(wheel_speeds, wheels["has_motor"].tolist(), strict=True)
        ]
        return (
            WheelStates(
                position=Wheels(*wheels["position"].tolist()),
                velocity=Wheels(*wheel_speeds),
                effort=Wheels(*wheels["mean_torque"].tolist()),
            ),
            MotorStates(velocity=Wheels(*shaft_speeds), effort=Wheels(*self.state.drives["torque"].tolist())),
            InertialMeasurement(
                yaw_rate=yaw_rate,
                longitudinal_acceleration=acceleration * along - centripetal * across,
                lateral_acceleration=acceleration * across + centripetal * along,
            ),
            BodyVelocity(longitudinal=speed * along, lateral=speed * across, yaw_rate=yaw_rate),
            BodyPose.at(x, y, heading),
        )

    def advance(self, command: WheelTorqueCommand, column: SteeringColumnState) -> None:
        """Move on by one control period, torques and road-wheel angle held as the guard accepts them."""
        self._torques["drive"], self._torques["brake"] = self.guard.torques(command)
        _advance(
            self.state.car,
            self.state.wheels,
            self.state.drives,
            self._torques,
            self._parameters,
            self._drive_parameters,
            self._vehicle,
            self.guard.angle(column),
            self._period,
        )

    def reports(self) -> tuple[str, ...]:
        """Commands that were not taken as they came, counted by powers of ten."""
        return self.guard.reports()

    @property
    def diagnostics(self) -> dict[str, float]:
        """Counts of commands that were not taken as they came."""
        return self.guard.diagnostics


@compiled
def _advance(cars, wheels, drives, torques, plants, drive_parameters, vehicles, road_wheel_angle, period):
    """Integrate the state arrays in place over one control period; parameters come as arrays of one record."""
    car, plant, vehicle = cars[0], plants[0], vehicles[0]
    _steer(car, wheels, vehicle, road_wheel_angle)

    rolling_resistance = vehicle.rolling_resistance * vehicle.mass * GRAVITY
    friction = rolling_resistance + _sum_of_wheels(torques.brake) / vehicle.wheel_radius
    drag = 0.5 * vehicle.air_density * vehicle.drag_coefficient * vehicle.frontal_area
    sub_steps = max(1, math.ceil(period / plant.sub_step - 1e-9))
    step = period / sub_steps
    speed_before = car.speed
    distance = 0.0
    wheels.mean_torque[:] = 0.0
    for _ in range(sub_steps):
        drive_torque = _advance_drives(
            car, wheels, drives, torques, drive_parameters[0], plant.bus_voltage, vehicle, step
        )
        force = drive_torque / vehicle.wheel_radius - drag * car.speed * abs(car.speed)
        car.speed, moved = move_with_dry_friction(car.speed, force, friction, vehicle.mass, step)
        distance += moved
    wheels.mean_torque[:] /= sub_steps
    wheels.position[:] += wheels.speed_ratio * (distance / vehicle.wheel_radius)
    car.acceleration = (car.speed - speed_before) / period
    _move_on_arc(car, distance)


@compiled
def _steer(car, wheels, vehicle, road_wheel_angle):
    """Set the path of the centre of mass and the speed ratios of the wheels (eqs 8 to 11)."""
    base, behind = vehicle.wheelbase, vehicle.centre_of_mass_to_rear_axle
    car.path_curvature = path_curvature(road_wheel_angle, base, behind)
    car.course_offset = course_offset(road_wheel_angle, base, behind)
    ratios = wheel_speed_ratios(road_wheel_angle, base, vehicle.front_track, vehicle.rear_track, behind)
    for i in range(len(wheels)):
        wheels[i].speed_ratio = ratios[i]


@compiled
def _advance_drives(car, wheels, drives, torques, drive_parameters, bus_voltage, vehicle, step):
    """Advance all drives over one step; the sum of their torques at the wheels [N m], mean over the step."""
    wheel_torques = np.zeros(len(wheels))
    for i in range(len(wheels)):
        if wheels[i].has_motor:
            shaft_speed = vehicle.gear_ratio * wheels[i].speed_ratio * car.speed / vehicle.wheel_radius
            reference = torques[i].drive / vehicle.gear_ratio
            advance_drive(drives[i], drive_parameters, reference, shaft_speed, bus_voltage, step)
            wheel_torques[i] = vehicle.gear_ratio * drives[i].mean_torque
            wheels[i].mean_torque += wheel_torques[i]
    return _sum_of_wheels(wheel_torques)


@compiled
def _sum_of_wheels(values):
    """Sum axle by axle, so that mirrored cars stay mirrored to the last bit."""
    return (values[0] + values[1]) + (values[2] + values[3])


@compiled
def _move_on_arc(car, distance):
    """Move along a circular arc: the chord, at the mean of the courses at its ends."""
    half_turn = car.path_curvature * distance / 2.0
    chord = distance * (math.sin(half_turn) / half_turn if half_turn != 0.0 else 1.0)
    course = car.heading + half_turn + car.course_offset
    car.x += chord * math.cos(course)
    car.y += chord * math.sin(course)
    car.heading += 2.0 * half_turn
