"""Quantities of a turn with two driven rear wheels, as Ge & Ni (2005) plot them; inner is left."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.ge_ni2005 import paper
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel, last
from ev_stack.recording.recording import Recording

SIDES = ("left", "right")
CHATTER_WINDOW = 1.0  # [s], the last one
_AT_THE_END = f"at {paper.INSTANT:g} s"


class Quantity(NamedTuple):
    """A number of a run: its unit, how it is computed, and that in words."""

    unit: str
    of: Callable[[Recording], float]
    formula: str


def slip(run: Recording, side: str) -> np.ndarray:
    """Slip ratio of a rear wheel, (n,) [1]."""
    return channel(run, f"tire_forces.slip_ratio.rear_{side}")


def friction_use(run: Recording, side: str) -> np.ndarray:
    """Share of the printed friction that a rear wheel uses along it, mu(slip)/mu_p, (n,) [1]."""
    return paper.friction(slip(run, side)) / paper.PEAK


def ground_speed(run: Recording, side: str, vehicle: Vehicle) -> np.ndarray:
    """Speed of the centre of a straight rear wheel along the wheel, V_3 or V_4, (n,) [m/s]."""
    across = vehicle.rear_track / 2 * channel(run, motion.YAW_RATE)
    return channel(run, "twist.longitudinal") + (across if side == "right" else -across)


def rim_speed(run: Recording, side: str, vehicle: Vehicle) -> np.ndarray:
    """Speed of the rim of a rear wheel, w_i R, (n,) [m/s]."""
    return vehicle.wheel_radius * channel(run, f"wheel_states.velocity.rear_{side}")


def yaw_rate(run: Recording) -> float:
    """Yaw rate at the end of the source's figures [rad/s]."""
    return motion.value_at(run, channel(run, motion.YAW_RATE), paper.INSTANT)


def response_time(run: Recording, final: float) -> float:
    """Time to 90 % of a final yaw rate [rad/s], in [s]."""
    share = channel(run, motion.YAW_RATE) / final
    return motion.crossing_time(run.time, share, 0.9, "90 % of the yaw rate")


def own_response_time(run: Recording) -> float:
    """Time to 90 % of the run's own yaw rate in the end [s]."""
    return response_time(run, yaw_rate(run))


def chatter(run: Recording) -> float:
    """Way of both torque requests to and fro in the last second, per time [N m/s]."""
    begin, _ = last(run, CHATTER_WINDOW)
    if begin < run.time[0] - 1e-9:
        raise NotMeasured(f"the run is shorter than {CHATTER_WINDOW:g} s")
    late = run.time >= begin
    way = 0.0
    for side in SIDES:
        torque = channel(run, f"torque_request.drive.rear_{side}")[late]
        # A torque that goes one way only does not chatter.
        one_way = abs(torque[-1] - torque[0])
        way += float(np.abs(np.diff(torque)).sum() - one_way)
    return way / CHATTER_WINDOW


def chatter_at_its_target(run: Recording, target: float) -> float:
    """Chatter [N m/s]; NotMeasured if no rear wheel comes to the target slip [1]."""
    # Away from its target the law never switches, so calm torques would prove nothing.
    if max(slip(run, side).max() for side in SIDES) < target:
        raise NotMeasured(f"no wheel comes to the target slip of {target:g}")
    return chatter(run)


def _at_the_end(unit: str, values: Callable[[Recording], np.ndarray]) -> Quantity:
    """The quantity that values (n,) have at the end of the source's figures."""
    return Quantity(unit, lambda run: motion.value_at(run, values(run), paper.INSTANT), _AT_THE_END)


QUANTITIES: Mapping[str, Quantity] = {
    "yaw_rate": Quantity("rad/s", yaw_rate, _AT_THE_END),
    "sideslip": _at_the_end("rad", motion.sideslip_angle),
    "lateral_speed": _at_the_end("m/s", lambda run: channel(run, "twist.lateral")),
    "radius": _at_the_end("m", motion.radius_of_path),
    "centripetal_acceleration": _at_the_end("m/s^2", motion.lateral_acceleration_on_path),
    "slip_rear_left": _at_the_end("1", lambda run: slip(run, "left")),
    "slip_rear_right": _at_the_end("1", lambda run: slip(run, "right")),
    "friction_use_rear_left": _at_the_end("1", lambda run: friction_use(run, "left")),
    "friction_use_rear_right": _at_the_end("1", lambda run: friction_use(run, "right")),
    "longitudinal_speed": _at_the_end("m/s", lambda run: channel(run, "twist.longitudinal")),
    "response_time": Quantity("s", own_response_time, "from turning in to the steady yaw rate"),
    "chatter": Quantity(
        "N m/s", chatter, "way of both torque requests to and fro in the last second, per time"
    ),
}
