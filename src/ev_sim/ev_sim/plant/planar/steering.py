"""From the mean road-wheel angle to the angles of the two front wheels."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import cos, sin, sqrt, tan
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.memory import Step


@inlined
def steer(car: Car, step: Step, angle: float, apart: float) -> None:
    """Set the direction of the wheels from the mean road-wheel angle of the front ones [rad].

    Both rear wheels follow it by the vehicle's `rear_steering_ratio`, 0 for straight ones, and an actuator of their own
    may turn them `apart` from that [rad]. Source: Ge & Ni 2005, eq 3.
    """
    cos_left, sin_left, cos_right, sin_right = front_wheels(car, angle)
    step.cos_steer[0], step.sin_steer[0] = cos_left, sin_left
    step.cos_steer[1], step.sin_steer[1] = cos_right, sin_right
    rear = car.rear_steering_ratio * angle + apart
    step.cos_steer[2] = step.cos_steer[3] = cos(rear) if rear != 0.0 else 1.0
    step.sin_steer[2] = step.sin_steer[3] = sin(rear)


@inlined
def front_wheels(car: Car, angle: float) -> tuple[float, float, float, float]:
    """Cosine and sine of the left, cosine and sine of the right front wheel's angle.

    Mean angle delta [rad], left positive; Ackermann geometry, the first choice of the vehicle's `steering_geometry`, or
    both wheels parallel, the second. Written with tan(delta) in the numerator, so that straight ahead needs no case of
    its own. Source: Shchur 2019, eq. 8.
    """
    t = tan(angle)
    outward = t * (0.5 * car.front_track) * (1.0 - car.steering_geometry)
    left = car.wheelbase * t / (car.wheelbase - outward)
    right = car.wheelbase * t / (car.wheelbase + outward)
    cos_left = 1.0 / sqrt(1.0 + left * left)
    cos_right = 1.0 / sqrt(1.0 + right * right)
    return cos_left, left * cos_left, cos_right, right * cos_right
