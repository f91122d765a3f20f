"""Hands that keep the car on its path while the feet drive a cycle."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry, part
from ev_msgs_py.contract.signals import BodyPose, SteeringColumnState
from ev_msgs_py.parameters.declaration import group
from ev_msgs_py.vehicle.car import Car
from ev_sim.driver.path import Path, PathParameters
from ev_sim.driver.pure_pursuit import PurePursuitParameters, pure_pursuit
from ev_sim.driver.road_edge import RoadEdgeState, watch_edge
from ev_sim.driver.steering import AngleControlParameters, AngleControlState, turn_to_angle

# Below it [m/s] a car does not drive anywhere, it rocks on its tyres or is pressed against its brakes: the eyes stay
# where they were, instead of following the sign of a velocity that is next to nothing.
STANDING = 0.05


@dataclass(frozen=True, slots=True)
class HandParameters:
    """How the driver turns the steering wheel; more firmly than who parks, to answer within tenths of a second."""

    angle_control: AngleControlParameters = group(
        AngleControlParameters,
        max_rate=15.0,
        max_hand_torque=20.0,
        proportional_gain=3.0,
        integral_gain=6.0,
        derivative_gain=0.3,
    )


@dataclass(frozen=True)  # without slots, to be a second base of other parameters
class LaneKeepingParameters:
    """The path (along the x axis by default), how far ahead the driver looks, and how the hands turn."""

    path: PathParameters = group(PathParameters)
    pursuit: PurePursuitParameters = group(PurePursuitParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class LaneKeepingState:
    """Where hands and eyes are."""

    hands: AngleControlState = part(AngleControlState)
    leg: float = entry(unit="1", about="place of the leg of the path that is reached")
    edge: RoadEdgeState = part(RoadEdgeState)
    direction: float = entry(1.0, unit="1", about="to which the eyes look: 1 ahead, -1 back")


@compilable
def keep_lane(
    p: LaneKeepingParameters,
    car: Car,
    path: Path,
    s: LaneKeepingState,
    period: float,
    time: float,
    pose: BodyPose,
    speed: float,
    column: SteeringColumnState,
) -> float:
    """Hand torque [N m] that leads the car along its path by pure pursuit, at a speed along it [m/s] and a time [s]."""
    if abs(speed) > STANDING:
        s.direction = 1.0 if speed > 0.0 else -1.0
    angle, leg = pure_pursuit(p.pursuit, car, path, pose, s.direction * abs(speed), int(s.leg))
    s.leg = float(leg)
    watch_edge(path, p.path.width, s.edge, time, pose, leg)
    return turn_to_angle(p.hands.angle_control, s.hands, period, car.steering_ratio * angle, column)
