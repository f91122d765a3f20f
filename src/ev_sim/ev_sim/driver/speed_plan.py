"""How fast a driver takes a bend: by the friction he counts on, and slowed down early enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import GRAVITY, atan2, compilable, cos, entry, parameter, setting, sqrt, tan
from ev_sim.driver.path import Path, passed_on
from ev_sim.driver.pedals import UNBOUNDED

_UNBOUNDED_SQUARE = UNBOUNDED * UNBOUNDED  # [m^2/s^2]
_BENT = 0.99  # share of a leg within the circles at its ends from which on the leg is a chord of a bend
_MISSED = 1.0  # [m/s] by which a driver who follows his plan is too fast: more than his speed control lags behind


@dataclass(frozen=True, slots=True)
class SpeedPlanParameters:
    """Which lateral and longitudinal acceleration the driver allows himself."""

    follow: bool = setting(
        True, about="true: never faster than the plan; false: the speed profile alone, whatever the bends are"
    )
    friction: float = parameter(
        0.9, unit="1", low=0.01, high=2.0, about="friction coefficient that the driver counts on"
    )
    share: float = parameter(
        0.5, unit="1", low=0.01, high=1.0, about="share of that friction that he uses in a bend",
        source="assumption; 3 to 5 m/s^2 are usual for drivers in a hurry",
    )  # fmt: skip
    acceleration: float = parameter(
        3.0, unit="m/s^2", low=0.1, high=20.0, about="by which he slows down before bends, and speeds up behind them",
    )  # fmt: skip
    cut: float = parameter(
        0.5, unit="m", low=0.01, high=100.0, about="how far he rounds off a corner between two waypoints",
    )  # fmt: skip


@dataclass(slots=True)
class SpeedPlanState:
    """Whether the plan was met."""

    missed_at: float = entry(unit="s", about="when the car first was too fast")
    excess: float = entry(unit="m/s", about="by how much at most; 0 for never")


class SpeedPlan(NamedTuple):
    """Squares of largest speeds [m^2/s^2]: at the points of the path, and in between them for each of its legs.

    On a leg the speed changes from `begin` on, for `run` [m]; one within a bend is taken no faster than its faster end.
    """

    point: tuple[float, ...]
    leg: tuple[float, ...]
    begin: tuple[float, ...]
    run: tuple[float, ...]


def speed_plan(p: SpeedPlanParameters, path: Path) -> SpeedPlan:
    """The plan for a path: V^2/R = share x friction x g at each corner, and less where another one is too near.

    A corner of the angle phi is rounded off by the largest circle that touches both legs, not beyond their middles, and
    passes the corner no farther than `cut`: chords of an arc get the arc.
    """
    grip = p.share * p.friction * GRAVITY
    point, around = [_UNBOUNDED_SQUARE], [0.0]
    for n in range(1, len(path.x)):
        across = path.along_x[n - 1] * path.along_y[n] - path.along_y[n - 1] * path.along_x[n]
        along = path.along_x[n - 1] * path.along_x[n] + path.along_y[n - 1] * path.along_y[n]
        half = 0.5 * atan2(abs(across), along)
        touch, cosine = 0.5 * min(path.length[n - 1], path.length[n]), cos(half)
        around.append(min(touch, p.cut * cosine / (1.0 - cosine) * tan(half)) if cosine < 1.0 else touch)
        point.append(min(grip * around[n] / tan(half), _UNBOUNDED_SQUARE) if half else _UNBOUNDED_SQUARE)
    point.append(_UNBOUNDED_SQUARE)
    around.append(0.0)
    legs, begin, run = range(len(path.x)), [], []
    bent = [around[n] + around[n + 1] > _BENT * path.length[n] for n in legs]
    for n in legs:
        begin.append(0.0 if bent[n] else around[n])
        run.append(path.length[n] if bent[n] else path.length[n] - around[n] - around[n + 1])
        point[n + 1] = min(point[n + 1], point[n] + 2.0 * p.acceleration * run[n])
    for n in reversed(legs):
        point[n] = min(point[n], point[n + 1] + 2.0 * p.acceleration * run[n])
    leg = [max(point[n], point[n + 1]) if bent[n] else _UNBOUNDED_SQUARE for n in legs]
    return SpeedPlan(tuple(point), tuple(leg), tuple(begin), tuple(run))


@compilable
def planned_speed(
    p: SpeedPlanParameters, plan: SpeedPlan, path: Path, s: SpeedPlanState, time: float, x: float, y: float, leg: int,
    speed: float,
) -> float:  # fmt: skip
    """Largest speed [m/s], either way, at a place (x, y) [m] beside a leg; keeps when a speed [m/s] was too high."""
    if p.follow == 0.0:
        return UNBOUNDED
    since = passed_on(path, leg, x, y) - plan.begin[leg]
    twice = 2.0 * p.acceleration
    from_behind = plan.point[leg] + twice * max(since, 0.0)
    for_ahead = plan.point[leg + 1] + twice * max(plan.run[leg] - since, 0.0)
    planned = sqrt(min(plan.leg[leg], from_behind, for_ahead))
    excess = abs(speed) - planned
    if excess > _MISSED:
        if s.excess == 0.0:
            s.missed_at = time
        s.excess = max(s.excess, excess)
    return planned


def plan_notes(s: SpeedPlanState) -> tuple[str, ...]:
    """One line about a plan that was missed; by how much in few steps, so that it seldom becomes another."""
    if not s.excess:
        return ()
    excess = next(limit for limit in (10.0, 5.0, 2.0, _MISSED) if s.excess > limit)
    return (
        f"the car was too fast for its speed plan from {s.missed_at:.2f} s on, by more than {excess:g} m/s: bends ahead"
        " ask for a lower speed or a larger driver.plan.acceleration",
    )
