"""Measures of Shchur (2019): steps of the hand torque (fig 1), held angles, radii (fig 2).

Each public function measures one number of published.csv; the words behind its name there are its
last arguments, such as the name of a run. Means and ratios are expressions in that list.
"""

from __future__ import annotations

import numpy as np

from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.step_response import StepResponse, first_peaks, step_response
from ev_sim.plant.kinematic import front_wheel_angles, path_curvature, wheel_speed_ratios
from ev_stack.measures import motion
from ev_stack.measures.metric import channel, last, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns

SETTLING_BAND = 0.05
WINDOW = 1.0  # mean values are taken over the last second [s]
CYCLE = "shchur2019"
END_OF_TURN = {"left": paper.LEFT_TURN[1], "right": paper.RIGHT_TURN[1]}  # [s]
HELD = {"left": paper.TURN_ANGLE, "right": -paper.TURN_ANGLE}  # [rad]


def _response(driven: ScenarioRuns, name: str) -> StepResponse:
    run = run_named(driven.runs, name)
    angle = channel(run, motion.ROAD_WHEEL_ANGLE)
    step_time = motion.hand_torque_step_time(run)
    return step_response(run.time, angle, step_time, SETTLING_BAND, WINDOW)


def steady(driven: ScenarioRuns, run: str) -> float:
    """Road-wheel angle in the end [rad]."""
    return _response(driven, run).steady_value


def overshoot(driven: ScenarioRuns, run: str) -> float:
    """Extreme of the road-wheel angle beyond that, over it [%]."""
    return _response(driven, run).overshoot


def settling_time(driven: ScenarioRuns, run: str) -> float:
    """Time from the step until the angle stays within 5 % of that [s]."""
    return _response(driven, run).settling_time


def ratio_of_ends(driven: ScenarioRuns) -> float:
    """Final angle of the closed loop over that of the object [1]."""
    return steady(driven, "closed_loop") / steady(driven, "object")


def _peaks(driven: ScenarioRuns, name: str) -> list[tuple[float, float]]:
    """Time after the step [s] and road-wheel angle [rad] of each peak."""
    run = run_named(driven.runs, name)
    since_step = run.time - motion.hand_torque_step_time(run)
    return first_peaks(since_step, channel(run, motion.ROAD_WHEEL_ANGLE))


def peak_time(driven: ScenarioRuns, run: str) -> float:
    """Time from the step to the first peak of the road-wheel angle [s]."""
    time, _ = _peaks(driven, run)[0]
    return time


def peak_angle(driven: ScenarioRuns, run: str) -> float:
    """Road-wheel angle at the first peak [rad]."""
    _, angle = _peaks(driven, run)[0]
    return angle


def period(driven: ScenarioRuns, run: str) -> float:
    """Time from the first peak to the second one [s]."""
    first, second, *_ = _peaks(driven, run)
    return second[0] - first[0]


def _while_held(run: Recording, values: np.ndarray) -> float:
    return motion.mean_while_held(run, values, paper.TURN_ANGLE, *last(run, WINDOW))


def hand_torque(driven: ScenarioRuns, run: str) -> float:
    """Hand torque that holds 30 deg [N m]."""
    recording = run_named(driven.runs, run)
    return _while_held(recording, channel(recording, motion.HAND_TORQUE))


def holding_torque(driven: ScenarioRuns, run: str) -> float:
    """Differential torque while 30 deg are held [N m]."""
    recording = run_named(driven.runs, run)
    return _while_held(recording, motion.differential_torque(recording))


def differential_torque(driven: ScenarioRuns, turn: str) -> float:
    """Mean differential torque in the last second of a turn of the cycle, at 30 deg [N m]."""
    run = run_named(driven.runs, CYCLE)
    torque = motion.differential_torque(run)
    end = END_OF_TURN[turn]
    return motion.mean_while_held(run, torque, HELD[turn], end - WINDOW, end)


def _has_switched_drives(driven: ScenarioRuns) -> bool:
    return driven.parameters.get("plant", {}).get("drive", "ideal") == "switched"


def held_within(driven: ScenarioRuns) -> str:
    """Tolerance of torques while an angle is held at rest."""
    return "1 %" if _has_switched_drives(driven) else "0.5 %"


def held_why(driven: ScenarioRuns) -> str:
    """Reason of that tolerance."""
    if _has_switched_drives(driven):
        return "ripple of switched drives"
    return "algebra, only the end of the window is left open"


def drives(driven: ScenarioRuns) -> str:
    """Addition to the assumption where the drives are ideal."""
    is_ideal = driven.parameters.get("plant", {}).get("drive", "ideal") == "ideal"
    return "; ideal drives" if is_ideal else ""


def difference_beyond_the_law(driven: ScenarioRuns) -> float:
    """Largest distance of M_R* - M_L* from eq 4 with the column's own signals [N m]."""
    run = run_named(driven.runs, CYCLE)
    hand = channel(run, motion.HAND_TORQUE)
    angle = channel(run, motion.STEERING_WHEEL_ANGLE)
    rate = channel(run, "steering_column.state.rate")
    lever = paper.differential_torque(1.0, 0.0) / paper.GAMMA
    law = lever * (paper.GAMMA * hand - paper.K_CK * angle - paper.B_CK * rate)
    return float(np.abs(motion.differential_torque(run) - law).max())


def neglected_damping(driven: ScenarioRuns, speed: float) -> float:
    """Last term of eq 3 at a speed [km/h] as damping, J_k = 1 kg m^2, over that of eq 5 [1]."""
    per_speed = paper.TRACK**2 / (2.0 * paper.R_K**2 * paper.WHEELBASE)
    return speed / 3.6 * per_speed / paper.CLOSED_LOOP.damping


def radius(driven: ScenarioRuns) -> float:
    """Radius of the path of the centre of mass at 30 deg [m], by the geometry of the plant."""
    car = driven.vehicle
    return 1 / path_curvature(paper.TURN_ANGLE, car.wheelbase, car.centre_of_mass_to_rear_axle)


def front_radius(driven: ScenarioRuns, side: str) -> float:
    """Radius of the path of a front wheel at 30 deg [m], by the geometry of the plant."""
    car = driven.vehicle
    ratios = wheel_speed_ratios(
        paper.TURN_ANGLE,
        car.wheelbase,
        car.front_track,
        car.rear_track,
        car.centre_of_mass_to_rear_axle,
    )
    return radius(driven) * getattr(ratios, f"front_{side}")


def front_angle(driven: ScenarioRuns, side: str) -> float:
    """Angle of a front wheel at 30 deg [rad], by the geometry of the plant."""
    car = driven.vehicle
    left, right = front_wheel_angles(paper.TURN_ANGLE, car.wheelbase, car.front_track)
    return left if side == "left" else right
