"""Active front steering: an angle that is added to the hands' one, against the error of the yaw rate."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import BodyVelocity, Car, Instant, SteeringColumnState, compilable, entry, method, parameter, tan
from ev_sim.profiles.profile import Profile
from ev_sim.steering.steering_robot import SteeringRobotParameters, profile, turned, wanted_angle


@dataclass(frozen=True, slots=True)
class ActiveFrontParameters(SteeringRobotParameters):
    """What the robot steers, which yaw rate is wanted, and what the superposing motor can do; all assumptions."""

    gain: float = parameter(
        1.0, unit="s", low=0.0, high=10.0, about="added road-wheel angle over the error of the yaw rate"
    )
    understeer: float = parameter(
        0.0, unit="rad s^2/m", low=0.0, high=0.1, about="road-wheel angle that the car needs more per m/s^2 across"
    )
    largest_acceleration: float = parameter(
        3.0, unit="m/s^2", low=0.1, high=20.0, about="across, that the wanted yaw rate keeps to: what the road gives"
    )
    largest_angle: float = parameter(
        0.15, unit="rad", low=0.0, high=0.7, about="that is added to the road wheels, either way"
    )
    largest_rate: float = parameter(
        0.5, unit="rad/s", low=0.01, high=10.0, about="at which the added angle changes, of a superposition gear"
    )
    slowest: float = parameter(
        1.0, unit="m/s", low=0.1, high=20.0, about="speed below which the added angle goes back to zero"
    )


@dataclass(slots=True)
class ActiveFrontState:
    """Angles now and a period later; left positive."""

    angle: float = entry(unit="rad", about="of the steering wheel, now")
    next_angle: float = entry(unit="rad", about="of the steering wheel, a period later")
    added: float = entry(unit="rad", about="to the road wheels, now")
    next_added: float = entry(unit="rad", about="to the road wheels, a period later")


def at_its_beginning(p: ActiveFrontParameters, c: Profile, period: float) -> ActiveFrontState:
    """The robot holds the angle that is wanted at first; nothing is added."""
    begin = wanted_angle(p, c, 0.0)
    return ActiveFrontState(begin, turned(p, period, begin, wanted_angle(p, c, period)))


@compilable
def shown(car: Car, s: ActiveFrontState, period: float) -> SteeringColumnState:
    """The column at this instant: the road wheels stand at more than the steering wheel says."""
    rate, added_rate = (s.next_angle - s.angle) / period, (s.next_added - s.added) / period
    ratio = car.steering_ratio
    return SteeringColumnState(s.angle, rate, 0.0, s.angle / ratio + s.added, rate / ratio + added_rate)


@method(
    "steering_column",
    "active_front",
    ActiveFrontParameters,
    state=ActiveFrontState,
    prepare=profile,
    start=at_its_beginning,
    outputs=shown,
    mirrored=True,
)
@compilable
def active_front(
    p: ActiveFrontParameters,
    car: Car,
    c: Profile,
    s: ActiveFrontState,
    period: float,
    now: Instant,
    body: BodyVelocity,
) -> None:
    """Steer as the robot does, and add k (r* - r) to the road wheels, by a superposition gear.

    r* = V tan(d)/(L + K V^2) with the hands' own angle d, within a_y/|V|: the steady single-track model, no source has
    it. In reverse the sign turns around, since there the front wheels turn the car the other way. The added angle keeps
    to `largest_angle` and `largest_rate`; the hands do not feel it. The yaw rate and V are the true ones, as those of
    the rear steering are.
    """
    s.angle, s.added = s.next_angle, s.next_added
    s.next_angle = turned(p, period, s.angle, wanted_angle(p, c, now.time + 2 * period))
    speed, added = body.longitudinal, 0.0
    if abs(speed) >= p.slowest:
        steered = speed * tan(s.angle / car.steering_ratio) / (car.wheelbase + p.understeer * speed * speed)
        most = p.largest_acceleration / abs(speed)
        error = min(max(steered, -most), most) - body.yaw_rate
        added = min(max(p.gain * (error if speed > 0.0 else -error), -p.largest_angle), p.largest_angle)
    step = p.largest_rate * period
    s.next_added = s.added + min(max(added - s.added, -step), step)
