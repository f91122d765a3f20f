"""What Shchur (2019) is judged by: steps of the hand torque (fig 1), the cycle (fig 4), angles and radii (fig 2).

Each public function measures one number of published.csv; the words behind its name there are its last
arguments, such as the name of a run or of a window of the cycle.
"""

from __future__ import annotations

import numpy as np

from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.step_response import StepResponse, first_peaks, step_response
from ev_sim.measures import motion
from ev_sim.measures.metric import channel, last, mean_between, run_named
from ev_sim.plant.kinematic import front_wheel_angles, path_curvature, wheel_speed_ratios
from ev_sim.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns

SETTLING_BAND = 0.05
WINDOW = 1.0  # mean values are taken over the last second [s]
CLOSED_LOOP = "closed_loop"
WINDOWS = {  # of the cycle: accelerations, and the last second of turns and of straight running [s]
    "first": paper.FIRST_ACCELERATION,
    "second": paper.SECOND_ACCELERATION,
    "slow": (paper.SECOND_ACCELERATION[0] - 1.0, paper.SECOND_ACCELERATION[0]),
    "fast": (49.0, 50.0),
    "left": (paper.LEFT_TURN[1] - 1.0, paper.LEFT_TURN[1]),
    "right": (paper.RIGHT_TURN[1] - 1.0, paper.RIGHT_TURN[1]),
}


def _angle(run: Recording) -> np.ndarray:
    return channel(run, motion.ROAD_WHEEL_ANGLE)


def _response(driven: ScenarioRuns, name: str) -> StepResponse:
    run = run_named(driven.runs, name)
    return step_response(run.time, _angle(run), motion.hand_torque_step_time(run), SETTLING_BAND, WINDOW)


def steady(driven: ScenarioRuns, run: str) -> float:
    """Road-wheel angle in the end [rad]."""
    return _response(driven, run).steady_value


def overshoot(driven: ScenarioRuns, run: str) -> float:
    """How far the road-wheel angle goes beyond that [%]."""
    return _response(driven, run).overshoot


def settling_time(driven: ScenarioRuns, run: str) -> float:
    """From the step to within 5 % of that [s]."""
    return _response(driven, run).settling_time


def ratio_of_ends(driven: ScenarioRuns) -> float:
    """Final angle of the closed loop over that of the object [1]."""
    return steady(driven, CLOSED_LOOP) / steady(driven, "object")


def _peaks(driven: ScenarioRuns, name: str) -> list[tuple[float, float]]:
    run = run_named(driven.runs, name)
    return first_peaks(run.time - motion.hand_torque_step_time(run), _angle(run))


def peak_time(driven: ScenarioRuns, run: str) -> float:
    """From the step to the first peak of the road-wheel angle [s]."""
    return _peaks(driven, run)[0][0]


def peak_angle(driven: ScenarioRuns, run: str) -> float:
    """The first peak [rad]."""
    return _peaks(driven, run)[0][1]


def period(driven: ScenarioRuns, run: str) -> float:
    """From the first peak to the second one [s]."""
    first, second, *_ = _peaks(driven, run)
    return second[0] - first[0]


def _while_held(run: Recording, values: np.ndarray) -> float:
    return motion.mean_while_held(run, values, paper.TURN_ANGLE, *last(run, WINDOW))


def hand_torque(driven: ScenarioRuns, run: str) -> float:
    """Hand torque that holds 30 deg [N m]."""
    return _while_held(run_named(driven.runs, run), channel(run_named(driven.runs, run), motion.HAND_TORQUE))


def holding_torque(driven: ScenarioRuns, run: str) -> float:
    """Differential torque while 30 deg are held [N m]."""
    return _while_held(run_named(driven.runs, run), motion.differential_torque(run_named(driven.runs, run)))


def _drive(driven: ScenarioRuns) -> str:
    return driven.parameters.get("plant", {}).get("drive", "ideal")


def held_within(driven: ScenarioRuns) -> str:
    """The tolerance of torques while an angle is held at rest."""
    return "1 %" if _drive(driven) == "switched" else "0.5 %"


def held_why(driven: ScenarioRuns) -> str:
    """Its reason."""
    return (
        "ripple of switched drives"
        if _drive(driven) == "switched"
        else "algebra, only the end of the window is left open"
    )


def drives(driven: ScenarioRuns) -> str:
    """What the assumption adds where the drives are ideal."""
    return "; ideal drives" if _drive(driven) == "ideal" else ""


def _cycle(driven: ScenarioRuns) -> Recording:
    return run_named(driven.runs, "shchur2019")


def _mean(run: Recording, values: np.ndarray, window: str) -> float:
    return mean_between(run, values, *WINDOWS[window])


def differential_torque(driven: ScenarioRuns, turn: str) -> float:
    """Mean differential torque at the end of a turn, in which 30 deg are held [N m]."""
    run, angle = _cycle(driven), paper.TURN_ANGLE if turn == "left" else -paper.TURN_ANGLE
    return motion.mean_while_held(run, motion.differential_torque(run), angle, *WINDOWS[turn])


def difference_beyond_the_law(driven: ScenarioRuns) -> float:
    """Largest distance of M_R* - M_L* from eq 4 with the column's own signals [N m]."""
    run = _cycle(driven)
    column = "steering_column.state"
    hand, angle, rate = (channel(run, f"{column}.{name}") for name in ("hand_torque", "angle", "rate"))
    lever = paper.differential_torque(1.0, 0.0) / paper.GAMMA
    law = lever * (paper.GAMMA * hand - paper.K_CK * angle - paper.B_CK * rate)
    return float(np.abs(motion.differential_torque(run) - law).max())


def neglected_damping(driven: ScenarioRuns, speed: float) -> float:
    """The last term of eq 3 at a speed [km/h] as a viscous friction, for J_k = 1 kg m^2, over that of eq 5 [1]."""
    return speed / 3.6 * paper.TRACK**2 / (2.0 * paper.R_K**2 * paper.WHEELBASE) / paper.CLOSED_LOOP.damping


def radius(driven: ScenarioRuns) -> float:
    """Radius of the path of the centre of mass at 30 deg [m], by the geometry of the plant."""
    car = driven.vehicle
    return 1 / path_curvature(paper.TURN_ANGLE, car.wheelbase, car.centre_of_mass_to_rear_axle)


def front_radius(driven: ScenarioRuns, side: str) -> float:
    """Radius of the path of a front wheel at 30 deg [m], by the geometry of the plant."""
    car = driven.vehicle
    ratios = wheel_speed_ratios(
        paper.TURN_ANGLE, car.wheelbase, car.front_track, car.rear_track, car.centre_of_mass_to_rear_axle
    )
    return radius(driven) * getattr(ratios, f"front_{side}")


def front_angle(driven: ScenarioRuns, side: str) -> float:
    """Angle of a front wheel at 30 deg [rad], by the geometry of the plant."""
    left, right = front_wheel_angles(paper.TURN_ANGLE, driven.vehicle.wheelbase, driven.vehicle.front_track)
    return left if side == "left" else right
