"""A driver who looks ahead: the rate of the angle that he intends, by optimal preview, and a speed for each bend."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, atan2, compilable, entry, exp, group, part, speed_along_path
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_sim.driver import path as paths
from ev_sim.driver.followers import LOOKING_ROUND, AngleControlState, HandParameters, turn_to_angle
from ev_sim.driver.pedals import FeetParameters, FeetProfiles, FeetState, driver_method, feet_profiles, work_pedals
from ev_sim.driver.preview_gains import GAIN_SPEEDS, POINT_STEP, STATES, PreviewGains, PreviewParameters, preview_gains
from ev_sim.profiles.profile import number_until
from ev_sim.understeer import axle_cornering_stiffnesses, axle_masses, understeer_gradient

_SIZE = len(STATES)
_TURNS_ALONG = 0.5  # ratio of rear to front angle from which on a car goes aside more than it turns: nothing to learn


@dataclass(slots=True)
class PreviewState:
    """What the driver intends, what his arms do, and where his eyes are."""

    intended: float = entry(unit="rad", about="road-wheel angle that he intends")
    arms: float = entry(unit="rad", about="road-wheel angle that his arms turn to")
    besides: float = entry(unit="rad", about="road-wheel angle that the car takes beyond its linear model")
    sliding: float = entry(unit="rad", about="sideslip angle that the car has beyond it")
    leg: float = entry(unit="1", about="place of the leg of the path that is reached")
    direction: float = entry(1.0, unit="1", about="to which the eyes look: 1 ahead, -1 back")


class SteadyCircle(NamedTuple):
    """The linear car on a steady circle, one way: delta = (length/V + gradient |V|) r, v = (arm - lag |V| V) r.

    Lengths in m and the others in s^2/m; `settling` m/(C_1 + C_2) [s^2/m] times the speed is the time in which it gets
    there.
    """

    length: float
    gradient: float
    arm: float
    lag: float
    settling: float


class Preview(NamedTuple):
    """Gains, the share of a step that the arms make in a period, and the linear car forwards and in reverse."""

    gains: PreviewGains
    share: float
    forwards: SteadyCircle
    reverse: SteadyCircle


def preview_of(p: PreviewParameters, vehicle: Vehicle, period: float) -> Preview:
    """What the driver knows of his car, for a period [s]."""
    circles = steady_circle(vehicle, 1.0), steady_circle(vehicle, -1.0)
    return Preview(preview_gains(p, vehicle), 1.0 - exp(-period / p.lag), *circles)


def steady_circle(vehicle: Vehicle, ahead: float) -> SteadyCircle:
    """The linear car that goes forwards, `ahead` 1, or in reverse, -1."""
    learns = vehicle.rear_steering_ratio < _TURNS_ALONG
    steered = 1.0 - min(vehicle.rear_steering_ratio, _TURNS_ALONG)
    length, gradient = vehicle.wheelbase / steered, understeer_gradient(vehicle, ahead=ahead) / steered
    front, rear = axle_cornering_stiffnesses(vehicle, ahead=ahead)
    return SteadyCircle(
        length,
        gradient,
        vehicle.centre_of_mass_to_rear_axle + vehicle.rear_steering_ratio * length,
        axle_masses(vehicle)[1] / rear - vehicle.rear_steering_ratio * gradient,
        vehicle.mass / (front + rear) if learns else math.inf,
    )


@compilable
def look_ahead(
    p: PreviewParameters, c: Preview, path: paths.Path, s: PreviewState, period: float, pose: BodyPose,
    body: BodyVelocity, speed: float, wheels: float,
) -> float:  # fmt: skip
    """Road-wheel angle [rad] to which the arms turn, at a speed, negative in reverse [m/s]; that of `wheels` is felt.

    rate = -K x + sum of g_i turn_i, x as in `STATES` beside the chord from the nearest point of the path to the
    first one ahead, turn_i by what the path turns at the i-th point. Of angles and sideslip only what the linear car
    would have counts: what is learnt besides does what an integral of the lateral error would do, without overshoot.
    """
    if abs(speed) > LOOKING_ROUND:
        s.direction = 1.0 if speed > 0.0 else -1.0
    fastest = GAIN_SPEEDS[len(GAIN_SPEEDS) - 1]
    taken = min(max(abs(speed), GAIN_SPEEDS[0]), fastest)
    row = min(number_until(GAIN_SPEEDS, taken), len(GAIN_SPEEDS) - 1)
    upper = (taken - GAIN_SPEEDS[row - 1]) / (GAIN_SPEEDS[row] - GAIN_SPEEDS[row - 1])
    lower = 1.0 - upper
    if s.direction < 0.0:
        row += len(GAIN_SPEEDS)
    feedback, preview, points = c.gains.feedback, c.gains.preview, int(c.gains.points)

    distance, leg = paths.nearest(path, pose.x, pose.y, int(s.leg))
    s.leg = float(leg)
    reach = s.direction * taken * POINT_STEP
    here_x, here_y = paths.point_at(path, distance, leg)
    next_x, next_y = paths.point_at(path, distance + reach, leg)
    along_x, along_y = s.direction * (next_x - here_x), s.direction * (next_y - here_y)
    z, w = pose.orientation_z, pose.orientation_w
    cosine, sine = w * w - z * z, 2.0 * z * w  # of the heading, from its quaternion
    heading = _turn(along_x, along_y, cosine, sine)
    lateral = (along_x * (pose.y - here_y) - along_y * (pose.x - here_x)) / (taken * POINT_STEP)
    if abs(speed) > GAIN_SPEEDS[0]:
        linear = c.forwards if speed > 0.0 else c.reverse
        besides = wheels - (linear.length / speed + linear.gradient * abs(speed)) * body.yaw_rate
        sliding = (body.lateral - (linear.arm - linear.lag * abs(speed) * speed) * body.yaw_rate) / speed
        settled = p.lag + p.column_lag + linear.settling * abs(speed)
        share = min(period / (p.learning * settled), 1.0)
        s.besides = _learnt(p, s.besides, share, besides)
        s.sliding = _learnt(p, s.sliding, share, sliding)
    angles = (wheels - s.besides, s.arms - s.besides, s.intended - s.besides)
    state = (body.lateral - s.sliding * speed, body.yaw_rate, heading + s.sliding, lateral, *angles)
    rate = 0.0
    for n in range(_SIZE):
        rate -= (lower * feedback[(row - 1) * _SIZE + n] + upper * feedback[row * _SIZE + n]) * state[n]
    for n in range(points):
        ahead_x, ahead_y = paths.point_at(path, distance + (n + 2) * reach, leg)
        then_x, then_y = s.direction * (ahead_x - next_x), s.direction * (ahead_y - next_y)
        gain = lower * preview[(row - 1) * points + n] + upper * preview[row * points + n]
        rate += gain * _turn(along_x, along_y, then_x, then_y)
        along_x, along_y, next_x, next_y = then_x, then_y, ahead_x, ahead_y
    angle = s.arms  # of this instant: that of the next one would make him quicker by a control period
    if rate - rate == 0.0:  # else inputs overflow, which have no meaning for the hands
        s.intended = min(max(s.intended + period * rate, -p.max_angle), p.max_angle)
    s.arms += c.share * (s.intended - s.arms)
    return angle


@compilable
def _learnt(p: PreviewParameters, before: float, share: float, seen: float) -> float:
    """Angle [rad] that is learnt after a share of the way to what is seen [rad]; nothing of what overflows."""
    if seen - seen != 0.0:
        return before
    return min(max(before + share * (seen - before), -p.learnt_angle), p.learnt_angle)


@compilable
def _turn(from_x: float, from_y: float, to_x: float, to_y: float) -> float:
    """Angle from one direction to another, left positive [rad]; 0 where it is neither left nor right."""
    across = from_x * to_y - from_y * to_x
    return atan2(across, from_x * to_x + from_y * to_y) if across != 0.0 else 0.0


@dataclass(frozen=True, slots=True)
class PreviewDriverParameters(FeetParameters):
    """The path, how fast the driver takes its bends, how he looks ahead, and hands and feet."""

    path: paths.PathParameters = group(paths.PathParameters)
    plan: paths.SpeedPlanParameters = group(paths.SpeedPlanParameters)
    preview: PreviewParameters = group(PreviewParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class PreviewDriverState:
    """What feet, eyes and hands remember."""

    feet: FeetState = part(FeetState)
    plan: paths.SpeedPlanState = part(paths.SpeedPlanState)
    preview: PreviewState = part(PreviewState)
    hands: AngleControlState = part(AngleControlState)
    edge: paths.RoadEdgeState = part(paths.RoadEdgeState)


class PreviewedPath(NamedTuple):
    """What the feet follow, the path, how fast it may be driven, and what the driver knows of his car."""

    feet: FeetProfiles
    path: paths.Path
    plan: paths.SpeedPlan
    preview: Preview


def previewed_path(parameters: PreviewDriverParameters, vehicle: Vehicle, period: float) -> PreviewedPath:
    """The course that the parameters describe; ParameterError if they name a profile file that has not been read."""
    path = paths.path_of(parameters.path)
    return PreviewedPath(
        feet_profiles(parameters, vehicle, period),
        path,
        paths.speed_plan(parameters.plan, path),
        preview_of(parameters.preview, vehicle, period),
    )


def notes(p: PreviewDriverParameters, s: PreviewDriverState) -> tuple[str, ...]:
    """Whether the car was too fast for the plan, and whether it has left its road."""
    return (*paths.plan_notes(s.plan), *paths.edge_notes(s.edge, p.path.width))


@driver_method("preview", prepare=previewed_path, notes=notes)
@compilable
def preview(
    p: PreviewDriverParameters,
    car: Car,
    c: PreviewedPath,
    s: PreviewDriverState,
    period: float,
    now: Instant,
    body: BodyVelocity,
    pose: BodyPose,
    column: SteeringColumnState,
) -> DriverCommand:
    """Steer along a path by optimal preview with the car's single-track model, and slow down before its bends."""
    speed = speed_along_path(body)
    wheels = column.angle / car.steering_ratio
    angle = look_ahead(p.preview, c.preview, c.path, s.preview, period, pose, body, speed, wheels)
    leg = int(s.preview.leg)
    fastest = paths.planned_speed(p.plan, c.plan, c.path, s.plan, now.time, pose.x, pose.y, leg, speed)
    drive, brake = work_pedals(p, car, c.feet, s.feet, period, now.time, speed, fastest)
    paths.watch_edge(c.path, p.path.width, s.edge, now.time, pose, leg)
    return DriverCommand(
        drive, brake, turn_to_angle(p.hands.angle_control, s.hands, period, car.steering_ratio * angle, column)
    )
