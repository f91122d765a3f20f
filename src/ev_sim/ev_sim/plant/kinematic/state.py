"""What the kinematic plant is told, what it keeps from step to step, how it starts, and what it shows."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, Wheels, compilable, cos, each_wheel, entry, part, setting, sin
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, InertialMeasurement, MotorStates, WheelStates
from ev_sim.drives.brushless_motor import DriveState
from ev_sim.drives.drive import DriveParameters
from ev_sim.plant.commands import GuardState, guard_notes


@dataclass(frozen=True, slots=True)
class KinematicPlantParameters(DriveParameters):
    """Drives, supply and integration of the kinematic plant; the car itself is the vehicle description."""

    bus_voltage: float = setting(
        480.0,
        unit="V",
        low=1.0,
        high=2000.0,
        about="constant voltage of the bus; assumed, the paper's second turn needs more than the 381 V of the EMF",
    )
    sub_step: float = setting(
        1e-3, unit="s", low=1e-6, high=1e-3, about="longest step of the motion, over which the drives see one speed"
    )
    initial_speed: float = setting(0.0, unit="m/s", low=-100.0, high=100.0, about="speed at the start")


@dataclass(slots=True)
class RollingWheelState:
    """A wheel that rolls without slip."""

    position: float = entry(unit="rad", about="turned angle")
    speed_ratio: float = entry(1.0, unit="1", about="speed of the wheel over that of the centre of mass, V_j/V")
    mean_torque: float = entry(unit="N m", about="of the drive at the wheel, over the last control period")


@dataclass(slots=True)
class KinematicPlantState:
    """The car on its path, its wheels and drives, and the commands that were accepted last."""

    speed: float = entry(unit="m/s", about="V, of the centre of mass along its path, backwards negative")
    acceleration: float = entry(unit="m/s^2", about="along the path, mean over the last control period")
    path_curvature: float = entry(unit="1/m", about="1/R, positive to the left")
    course_offset: float = entry(unit="rad", about="from the car's x axis to the path, left positive")
    x: float = entry(unit="m", about="of the centre of mass in odom")
    y: float = entry(unit="m", about="of the centre of mass in odom")
    heading: float = entry(unit="rad", about="of the car in odom")
    wheels: list[RollingWheelState] = each_wheel(RollingWheelState)
    drives: list[DriveState] = each_wheel(DriveState)
    guard: GuardState = part(GuardState)


def rolling_straight(p: KinematicPlantParameters) -> KinematicPlantState:
    """The car at its initial speed."""
    return KinematicPlantState(speed=p.initial_speed)


def notes(s: KinematicPlantState) -> tuple[str, ...]:
    """Commands that were not taken as they came."""
    return guard_notes(s.guard)


SIGNALS = (WheelStates, MotorStates, InertialMeasurement, BodyVelocity, BodyPose)


@compilable
def outputs(car: Car, s: KinematicPlantState) -> tuple:
    """The signals of this instant; wheel torques and acceleration are means over the control period before it.

    The means are what moved the car, chopping and commutation ripple included; the motors' torque is the one of
    this instant, so it shows the ripple. Of the road-wheel angle the plant knows what was held until now.
    """
    yaw_rate = s.speed * s.path_curvature
    along, across = cos(s.course_offset), sin(s.course_offset)
    centripetal = s.speed * yaw_rate
    one, two, three, four = s.wheels[0], s.wheels[1], s.wheels[2], s.wheels[3]
    velocity = Wheels(
        one.speed_ratio * s.speed / car.wheel_radius,
        two.speed_ratio * s.speed / car.wheel_radius,
        three.speed_ratio * s.speed / car.wheel_radius,
        four.speed_ratio * s.speed / car.wheel_radius,
    )
    return (
        WheelStates(
            Wheels(one.position, two.position, three.position, four.position),
            velocity,
            Wheels(one.mean_torque, two.mean_torque, three.mean_torque, four.mean_torque),
        ),
        MotorStates(
            Wheels(
                shaft_speed(car, 0, velocity[0]),
                shaft_speed(car, 1, velocity[1]),
                shaft_speed(car, 2, velocity[2]),
                shaft_speed(car, 3, velocity[3]),
            ),
            Wheels(s.drives[0].torque, s.drives[1].torque, s.drives[2].torque, s.drives[3].torque),
        ),
        InertialMeasurement(
            yaw_rate, s.acceleration * along - centripetal * across, s.acceleration * across + centripetal * along
        ),
        BodyVelocity(s.speed * along, s.speed * across, yaw_rate),
        BodyPose(s.x, s.y, sin(s.heading / 2), cos(s.heading / 2)),
    )


@compilable
def shaft_speed(car: Car, wheel: int, wheel_speed: float) -> float:
    """Speed of the motor of a wheel at its shaft [rad/s]; 0 where there is none."""
    return car.gear_ratio * wheel_speed if car.driven[wheel] == 1.0 else 0.0
