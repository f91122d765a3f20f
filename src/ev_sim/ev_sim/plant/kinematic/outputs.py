"""What the kinematic plant shows of its state."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, InertialMeasurement, MotorStates, WheelStates
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.elementary import cos, sin
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.kinematic.state import KinematicPlantState

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
            yaw_rate,
            s.acceleration * along - centripetal * across,
            s.acceleration * across + centripetal * along,
        ),
        BodyVelocity(s.speed * along, s.speed * across, yaw_rate),
        BodyPose(s.x, s.y, sin(s.heading / 2), cos(s.heading / 2)),
    )


@compilable
def shaft_speed(car: Car, wheel: int, wheel_speed: float) -> float:
    """Speed of the motor of a wheel at its shaft [rad/s]; 0 where there is none."""
    return car.gear_ratio * wheel_speed if car.driven[wheel] == 1.0 else 0.0
