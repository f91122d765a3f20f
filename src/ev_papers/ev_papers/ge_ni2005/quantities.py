"""Quantities of a turn with two driven rear wheels, as Ge & Ni (2005) plot them; inner is left."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.ge_ni2005 import paper
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel, last
from ev_stack.recording.recording import Recording

OfRun = Callable[[Recording], float]

SIDES = ("left", "right")
CHATTER_WINDOW = 1.0  # [s], the last one


def at_the_end(values: Callable[[Recording], np.ndarray]) -> OfRun:
    """The measure that gives values (n,) at the end of the source's figures."""
    return lambda run: motion.value_at(run, values(run), paper.INSTANT)


def slip(run: Recording, side: str) -> np.ndarray:
    """Slip ratio of a rear wheel, (n,) [1]."""
    return channel(run, f"tire_forces.slip_ratio.rear_{side}")


def friction_use(run: Recording, side: str) -> np.ndarray:
    """What a rear wheel uses of the printed friction along the wheel, mu(slip)/mu_p, (n,) [1]."""
    return paper.friction(slip(run, side)) / paper.PEAK


def ground_speed(run: Recording, side: str, vehicle: Vehicle) -> np.ndarray:
    """Speed of the centre of a straight rear wheel along the wheel, V_3 or V_4, (n,) [m/s]."""
    across = vehicle.rear_track / 2 * channel(run, motion.YAW_RATE)
    return channel(run, "twist.longitudinal") + (across if side == "right" else -across)


def rim_speed(run: Recording, side: str, vehicle: Vehicle) -> np.ndarray:
    """Speed of the rim of a rear wheel, w_i R, (n,) [m/s]."""
    return vehicle.wheel_radius * channel(run, f"wheel_states.velocity.rear_{side}")


def response_time(run: Recording, final: float) -> float:
    """Time to 90 % of a final yaw rate [rad/s], in [s]."""
    return motion.crossing_time(
        run.time, channel(run, motion.YAW_RATE) / final, 0.9, "90 % of the yaw rate"
    )


def own_response_time(run: Recording) -> float:
    """Time to 90 % of the run's own yaw rate in the end [s]."""
    return response_time(run, QUANTITIES["yaw_rate"][1](run))


def chatter(run: Recording) -> float:
    """How far both torque requests go to and fro, per time [N m/s]; one way only is no chatter."""
    begin, _ = last(run, CHATTER_WINDOW)
    if begin < run.time[0] - 1e-9:
        raise NotMeasured(f"the run is shorter than {CHATTER_WINDOW:g} s")
    late = run.time >= begin
    torques = [channel(run, f"torque_request.drive.rear_{side}")[late] for side in SIDES]
    return (
        sum(
            float(np.abs(np.diff(torque)).sum() - abs(torque[-1] - torque[0])) for torque in torques
        )
        / CHATTER_WINDOW
    )


def chatter_at_its_target(run: Recording, target: float) -> float:
    """The chatter [N m/s]; NotMeasured if no rear wheel comes to the target slip [1]."""
    if max(slip(run, side).max() for side in SIDES) < target:
        raise NotMeasured(f"no wheel comes to the target slip of {target:g}")
    return chatter(run)


QUANTITIES: dict[str, tuple[str, OfRun]] = {
    "yaw_rate": ("rad/s", at_the_end(lambda run: channel(run, motion.YAW_RATE))),
    "sideslip": ("rad", at_the_end(motion.sideslip_angle)),
    "lateral_speed": ("m/s", at_the_end(lambda run: channel(run, "twist.lateral"))),
    "radius": ("m", at_the_end(motion.radius_of_path)),
    "centripetal_acceleration": ("m/s^2", at_the_end(motion.lateral_acceleration_on_path)),
    "slip_rear_left": ("1", at_the_end(lambda run: slip(run, "left"))),
    "slip_rear_right": ("1", at_the_end(lambda run: slip(run, "right"))),
    "friction_use_rear_left": ("1", at_the_end(lambda run: friction_use(run, "left"))),
    "friction_use_rear_right": ("1", at_the_end(lambda run: friction_use(run, "right"))),
    "longitudinal_speed": ("m/s", at_the_end(lambda run: channel(run, "twist.longitudinal"))),
    "response_time": ("s", own_response_time),
    "chatter": ("N m/s", chatter),
}
OVER_TIME = {  # what is not read at one instant
    "response_time": "from turning in to the steady yaw rate",
    "chatter": "way of both torque requests to and fro in the last second, per time",
}
