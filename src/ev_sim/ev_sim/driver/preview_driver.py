"""A driver with optimal preview of the path, and a speed for each bend.

How it works: the gains of `preview_gains` act on the state of a linear car beside the path and on
the turns of the path ahead. The real car needs other angles in a bend than the linear one; the
driver learns the difference on the way, so that it leaves no lateral error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, atan2, compilable, entry, exp, group, part, speed_along_path
from ev_msgs_py.contract.signals import (
    BodyPose,
    BodyVelocity,
    DriverCommand,
)
from ev_sim.driver import path as paths
from ev_sim.driver.followers import (
    LOOKING_ROUND,
    AngleControlState,
    HandParameters,
    OnPath,
    turn_to_angle,
)
from ev_sim.driver.pedals import (
    FeetParameters,
    FeetProfiles,
    FeetState,
    Pace,
    driver_method,
    feet_profiles,
    work_pedals,
)
from ev_sim.driver.preview_gains import (
    GAIN_SPEEDS,
    POINT_STEP,
    STATES,
    PreviewGains,
    PreviewParameters,
    preview_gains,
)
from ev_sim.profiles.profile import number_until
from ev_sim.understeer import axle_cornering_stiffnesses, axle_masses, understeer_gradient

_SIZE = len(STATES)
# Ratio of rear to front angle from which on a car goes aside more than it turns: nothing to learn.
_TURNS_ALONG = 0.5


@dataclass(slots=True)
class PreviewState:
    """Intended angle, angle of the arms, and where the eyes are."""

    intended: float = entry(unit="rad", about="road-wheel angle that he intends")
    arms: float = entry(unit="rad", about="road-wheel angle that his arms turn to")
    besides: float = entry(
        unit="rad", about="road-wheel angle that the car takes beyond its linear model"
    )
    sliding: float = entry(unit="rad", about="sideslip angle that the car has beyond it")
    leg: float = entry(unit="1", about="place of the leg of the path that is reached")
    direction: float = entry(1.0, unit="1", about="to which the eyes look: 1 ahead, -1 back")


class SteadyCircle(NamedTuple):
    """The linear car on a steady circle, one way.

    delta = (length/V + gradient |V|) r, v = (arm - lag |V| V) r. Lengths in m and the others in
    s^2/m; `settling` m/(C_1 + C_2) [s^2/m] times the speed is the time in which it gets there.
    """

    length: float
    gradient: float
    arm: float
    lag: float
    settling: float


class Preview(NamedTuple):
    """Gains, the share of a step that the arms make in a period, and the linear car both ways."""

    gains: PreviewGains
    share: float
    forwards: SteadyCircle
    reverse: SteadyCircle


def preview_of(p: PreviewParameters, vehicle: Vehicle, period: float) -> Preview:
    """The driver's knowledge of his car, for a period [s]."""
    circles = steady_circle(vehicle, 1.0), steady_circle(vehicle, -1.0)
    return Preview(preview_gains(p, vehicle), 1.0 - exp(-period / p.lag), *circles)


def steady_circle(vehicle: Vehicle, ahead: float) -> SteadyCircle:
    """The linear car that goes forwards, `ahead` 1, or in reverse, -1."""
    # With equal angles in front and behind the length would be L/0.
    learns = vehicle.rear_steering_ratio < _TURNS_ALONG
    steered = 1.0 - min(vehicle.rear_steering_ratio, _TURNS_ALONG)
    length, gradient = (
        vehicle.wheelbase / steered,
        understeer_gradient(vehicle, ahead=ahead) / steered,
    )
    front, rear = axle_cornering_stiffnesses(vehicle, ahead=ahead)
    return SteadyCircle(
        length,
        gradient,
        vehicle.centre_of_mass_to_rear_axle + vehicle.rear_steering_ratio * length,
        axle_masses(vehicle)[1] / rear - vehicle.rear_steering_ratio * gradient,
        vehicle.mass / (front + rear) if learns else math.inf,
    )


class Moving(NamedTuple):
    """Place and motion of the car, and the road-wheel angle that the steering wheel stands for."""

    pose: BodyPose
    body: BodyVelocity
    wheels: float  # [rad]


@compilable
def look_ahead(
    p: PreviewParameters, c: Preview, path: paths.Path, s: PreviewState, period: float, car: Moving
) -> float:
    """Road-wheel angle [rad] to which the arms turn.

    rate = -K x + sum of g_i turn_i, x as in `STATES` beside the chord from the nearest point of the
    path to the first one ahead, turn_i by what the path turns at the i-th point. Of angles and
    sideslip only what the linear car would have counts: what is learnt besides does what an
    integral of the lateral error would do, without overshoot.
    """
    pose, body, wheels = car
    speed = speed_along_path(body)
    if abs(speed) > LOOKING_ROUND:
        s.direction = 1.0 if speed > 0.0 else -1.0
    gains = _gains_at(speed, s.direction)
    # From one point ahead to the next, backwards in reverse.
    reach = s.direction * gains.speed * POINT_STEP
    distance, leg = paths.nearest(path, pose.x, pose.y, int(s.leg))
    s.leg = float(leg)
    here_x, here_y = paths.point_at(path, distance, leg)
    next_x, next_y = paths.point_at(path, distance + reach, leg)
    # In reverse the eyes look back, yet all directions are those in which the front of the car
    # points.
    along_x, along_y = s.direction * (next_x - here_x), s.direction * (next_y - here_y)
    z, w = pose.orientation_z, pose.orientation_w
    cosine, sine = w * w - z * z, 2.0 * z * w  # of the heading, from its quaternion
    heading = _turn(along_x, along_y, cosine, sine)
    # The chord is as long as the reach, and so is the factor in the product: divided by it below.
    aside = along_x * (pose.y - here_y) - along_y * (pose.x - here_x)
    lateral = aside / (gains.speed * POINT_STEP)
    # Both estimates divide by the speed.
    if abs(speed) > GAIN_SPEEDS[0]:
        _learn(p, c, s, period, car)
    state = (
        body.lateral - s.sliding * speed,
        body.yaw_rate,
        heading + s.sliding,
        lateral,
        wheels - s.besides,
        s.arms - s.besides,
        s.intended - s.besides,
    )
    feedback, preview = c.gains.feedback, c.gains.preview
    points = int(c.gains.points)
    # Linear between the rows of the speeds below and above.
    before, row = gains.row - 1, gains.row
    rate = 0.0
    for n in range(_SIZE):
        gain = gains.lower * feedback[before * _SIZE + n] + gains.upper * feedback[row * _SIZE + n]
        rate -= gain * state[n]
    for n in range(points):
        ahead_x, ahead_y = paths.point_at(path, distance + (n + 2) * reach, leg)
        then_x, then_y = s.direction * (ahead_x - next_x), s.direction * (ahead_y - next_y)
        gain = gains.lower * preview[before * points + n] + gains.upper * preview[row * points + n]
        rate += gain * _turn(along_x, along_y, then_x, then_y)
        along_x, along_y = then_x, then_y
        next_x, next_y = ahead_x, ahead_y
    # The angle of this instant: that of the next one would make him quicker by a control period.
    angle = s.arms
    if rate - rate == 0.0:  # else inputs overflow, which have no meaning for the hands
        s.intended = min(max(s.intended + period * rate, -p.max_angle), p.max_angle)
    s.arms += c.share * (s.intended - s.arms)
    return angle


class GainsAt(NamedTuple):
    """A speed among those of the gains: the row behind it, and weights of the rows around it."""

    speed: float  # [m/s], within those of the gains
    row: int
    lower: float
    upper: float


@compilable
def _gains_at(speed: float, direction: float) -> GainsAt:
    """Rows of the gains at a speed [m/s], those of reverse where the eyes look back."""
    taken = min(max(abs(speed), GAIN_SPEEDS[0]), GAIN_SPEEDS[len(GAIN_SPEEDS) - 1])
    row = min(number_until(GAIN_SPEEDS, taken), len(GAIN_SPEEDS) - 1)
    upper = (taken - GAIN_SPEEDS[row - 1]) / (GAIN_SPEEDS[row] - GAIN_SPEEDS[row - 1])
    if direction < 0.0:
        row += len(GAIN_SPEEDS)
    return GainsAt(taken, row, 1.0 - upper, upper)


@compilable
def _learn(p: PreviewParameters, c: Preview, s: PreviewState, period: float, car: Moving) -> None:
    """Learn by how much angle and sideslip differ from those of the linear car in a bend."""
    body, speed = car.body, speed_along_path(car.body)
    linear = c.forwards if speed > 0.0 else c.reverse
    steered = (linear.length / speed + linear.gradient * abs(speed)) * body.yaw_rate
    aside = (linear.arm - linear.lag * abs(speed) * speed) * body.yaw_rate
    settled = p.lag + p.column_lag + linear.settling * abs(speed)
    share = min(period / (p.learning * settled), 1.0)
    s.besides = _learnt(p, s.besides, share, car.wheels - steered)
    s.sliding = _learnt(p, s.sliding, share, (body.lateral - aside) / speed)


@compilable
def _learnt(p: PreviewParameters, before: float, share: float, seen: float) -> float:
    """Angle [rad] learnt after a share of the way to the seen one; nothing of what overflows."""
    if seen - seen != 0.0:
        return before
    return min(max(before + share * (seen - before), -p.learnt_angle), p.learnt_angle)


@compilable
def _turn(from_x: float, from_y: float, to_x: float, to_y: float) -> float:
    """Angle from one direction to another, left positive [rad]; 0 for neither left nor right."""
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
    """Memory of feet, eyes and hands."""

    feet: FeetState = part(FeetState)
    plan: paths.SpeedPlanState = part(paths.SpeedPlanState)
    preview: PreviewState = part(PreviewState)
    hands: AngleControlState = part(AngleControlState)
    edge: paths.RoadEdgeState = part(paths.RoadEdgeState)


class PreviewedPath(NamedTuple):
    """Profiles of the feet, the path and its speeds, and the driver's knowledge of his car."""

    feet: FeetProfiles
    path: paths.Path
    plan: paths.SpeedPlan
    preview: Preview


def previewed_path(
    parameters: PreviewDriverParameters, vehicle: Vehicle, period: float
) -> PreviewedPath:
    """The course of the parameters; ParameterError if a file that they name has not been read."""
    path = paths.path_of(parameters.path)
    return PreviewedPath(
        feet_profiles(parameters, vehicle, period),
        path,
        paths.speed_plan(parameters.plan, path),
        preview_of(parameters.preview, vehicle, period),
    )


def notes(p: PreviewDriverParameters, s: PreviewDriverState) -> tuple[str, ...]:
    """Lines about a plan that was missed, and about a road that was left."""
    return (*paths.plan_notes(s.plan), *paths.edge_notes(s.edge, p.path.width))


@driver_method("preview", prepare=previewed_path, notes=notes)
@compilable
def preview(
    p: PreviewDriverParameters,
    car: Car,
    c: PreviewedPath,
    s: PreviewDriverState,
    period: float,
    seen: OnPath,
) -> DriverCommand:
    """Steer along a path by optimal preview of a single-track model, and slow down before bends."""
    time = seen.now.time
    pose = seen.pose
    column = seen.column
    speed = speed_along_path(seen.body)
    moving = Moving(pose, seen.body, column.angle / car.steering_ratio)
    angle = look_ahead(p.preview, c.preview, c.path, s.preview, period, moving)
    leg = int(s.preview.leg)
    at = paths.OnLeg(leg, pose.x, pose.y, speed, time)
    fastest = paths.planned_speed(p.plan, c.plan, c.path, s.plan, at)
    drive, brake = work_pedals(p, car, c.feet, s.feet, period, Pace(time, speed, fastest))
    paths.watch_edge(c.path, p.path.width, s.edge, time, pose, leg)
    wanted = car.steering_ratio * angle
    torque = turn_to_angle(p.hands.angle_control, s.hands, period, wanted, column)
    return DriverCommand(drive, brake, torque)
