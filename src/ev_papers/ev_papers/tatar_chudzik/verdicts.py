"""What Tatar & Chudzik are judged on: forces in the axes of the car, their sums, and what is claimed of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.measures import motion
from ev_sim.measures.car_axes import tyre_force
from ev_sim.measures.passing_speed import energy_since_turning_in, total_force, turning_in, when_passing
from ev_sim.measures.samples import channel, run_named
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.check import Comparison, Measure, Number, holds, relative
from ev_sim.verdicts.declaration import Declaration, judged, no_verdict, not_judgeable
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

RUNS = ScenarioNeed("tatar_chudzik")
LAYOUTS = ("front", "rear", "all")
CONTROLS = EQUAL, CORRECTED = ("equal", "corrected")
SPEEDS = (7.6, 8.0, 8.5, 9.0)  # [m/s], which every run passes in the bend
WHEELS = {"FL": "front_left", "FR": "front_right", "RL": "rear_left", "RR": "rear_right"}
ASSUMPTION = "tyre, drive torque, gain of the correction and more torque for the outer wheel, none of which is given"

Values = Callable[[Recording, Vehicle], np.ndarray]


def passing(run: str, speed: float, values: Values) -> Measure:
    """A quantity (n,) of a run when it passes a speed [m/s] in the bend."""

    def measure(driven: ScenarioRuns) -> float:
        recording = run_named(driven.runs, run)
        return when_passing(recording, speed, values(recording, driven.vehicle))

    return measure


def force_y(wheel: str) -> Values:
    """F_y of a wheel in the axes of the car [N]."""
    return lambda run, vehicle: tyre_force(run, wheel, vehicle).y


MARGIN, WHY = 0.001, "a sign at each of four speeds; numerical noise is below 0.01 % of the force"
RISES, FALLS = True, False
CLAIMS = {  # figure with the correction: the layout, and what happens to each wheel
    "fig12": ("front", {"FL": FALLS, "RL": RISES, "RR": RISES, "FR": RISES}),
    "fig13": ("rear", {"FL": FALLS, "FR": FALLS, "RL": RISES, "RR": RISES}),
    "fig14": ("all", {"FL": FALLS, "FR": FALLS, "RL": RISES, "RR": RISES}),
}


def _claim(figure: str, layout: str, wheel: str, rises: bool) -> Declaration:
    force = force_y(WHEELS[wheel])
    return judged(
        f"tatar.{figure}.{wheel}",
        RUNS,
        *(
            Comparison(
                "N",
                rises,
                MARGIN,
                WHY,
                passing(f"{layout}_{CORRECTED}", speed, force),
                passing(f"{layout}_{EQUAL}", speed, force),
                f"at {speed:g} m/s",
            )
            for speed in SPEEDS
        ),
        assumption=ASSUMPTION,
    )


_CLAIMS_DECLARATIONS = tuple(
    _claim(figure, layout, wheel, rises)
    for figure, (layout, wheels) in CLAIMS.items()
    for wheel, rises in wheels.items()
)


LOST = "curve not in the text"
TURNED = 1.0  # [s] after which the turn-in is over
STRAIGHT = 1.0  # [N] below which there is no lateral force
Courses = Mapping[str, np.ndarray]


def _shape(
    layout: str, courses: Callable[[Recording, Vehicle], Courses], rule: Callable[..., bool], what: str
) -> Number:
    def measure(driven: ScenarioRuns) -> bool:
        run = run_named(driven.runs, f"{layout}_{EQUAL}")
        return rule(courses(run, driven.vehicle), turning_in(run), run.time)

    return holds(measure, what)


def _forces_y(run: Recording, vehicle: Vehicle) -> Courses:
    return {name: tyre_force(run, wheel, vehicle).y for name, wheel in WHEELS.items()}


def _forces_x(run: Recording, vehicle: Vehicle) -> Courses:
    return {name: tyre_force(run, wheel, vehicle).x for name, wheel in WHEELS.items()}


def _wheel_speeds(run: Recording, _: Vehicle) -> Courses:
    return {name: channel(run, f"wheel_states.velocity.{wheel}") for name, wheel in WHEELS.items()}


def _inward(force: Courses, turn: int, time: np.ndarray) -> bool:
    late = time >= time[turn] + TURNED
    straight = all(np.abs(values[:turn]).max() < STRAIGHT for values in force.values())
    return straight and all(values[late][-1] > 0.0 for values in force.values()) and force["FR"][-1] > force["FL"][-1]


def _front_drops(force: Courses, turn: int, time: np.ndarray) -> bool:
    late = time >= time[turn] + TURNED
    return all(force[wheel][late].max() < force[wheel][turn] for wheel in ("FL", "FR"))


def _outer_above_inner(speed: Courses, turn: int, time: np.ndarray) -> bool:
    late = time >= time[turn] + TURNED
    return all((speed[outer][late] > speed[inner][late]).all() for inner, outer in (("FL", "FR"), ("RL", "RR")))


FIGURES = (
    (3, _forces_y, _inward, "zero until the turn, then inwards, outer above inner in front"),
    (4, _forces_x, _front_drops, "in the bend the front wheels stay below their force straight ahead"),
    (5, _wheel_speeds, _outer_above_inner, "in the bend the outer wheels are faster than the inner ones"),
)


def _equal_torques() -> tuple[Declaration, ...]:
    return tuple(
        not_judgeable(f"tatar.fig{first + 3 * n}", LOST, (RUNS,), _shape(layout, courses, rule, what))
        for first, courses, rule, what in FIGURES
        for n, layout in enumerate(LAYOUTS)
    )


_FIGURES_DECLARATIONS = (
    *_equal_torques(),
    not_judgeable("tatar.fig12_14.curves", f"{LOST}, beyond the signs", (RUNS,)),
    *(no_verdict(id, "a scheme without numbers") for id in ("tatar.fig1", "tatar.fig2")),
)


SPEED = 8.5  # [m/s]
ANGLE, REAR_ARM, WHEELBASE = math.pi / 10, 2.0, 4.0  # delta [rad], a_2 and a_1 + a_2 [m]
WALKING = ScenarioNeed(
    "tatar_chudzik",
    (
        ("plant", "initial_speed", 1.0),
        ("plant", "speed", "held"),
        ("driver", "pedals.drive_torque", (0.0,)),
        ("*", "vehicle.steering_geometry", "ackermann"),
        ("steering_column", "profile.time", (0.0,)),
        ("steering_column", "profile.angle", (16.0 * ANGLE,)),
    ),
    ("all_equal",),
    duration=10.0,
)


def sum_of_magnitudes(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Sum of |F_y| of the four wheels, (n,) [N]."""
    return np.sum([np.abs(tyre_force(run, wheel, vehicle).y) for wheel in WHEELS.values()], axis=0)


def signed_sum(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Sum of F_y of the four wheels, (n,) [N]."""
    return np.sum([tyre_force(run, wheel, vehicle).y for wheel in WHEELS.values()], axis=0)


def _changes(**quantities: tuple[str, Values]) -> tuple[Comparison, ...]:
    """How the correction changes quantities (unit and values by name) of each layout."""
    return tuple(
        Comparison(
            unit,
            FALLS,
            MARGIN,
            "shown, not judged",
            passing(f"{layout}_{CORRECTED}", SPEED, values),
            passing(f"{layout}_{EQUAL}", SPEED, values),
            f"{layout} {name.replace('_', ' ')}",
        )
        for layout in LAYOUTS
        for name, (unit, values) in quantities.items()
    )


def _radius(driven: ScenarioRuns) -> float:
    run = run_named(driven.runs, "all_equal")
    lateral, yaw_rate = channel(run, "twist.lateral")[-1], channel(run, motion.YAW_RATE)[-1]
    return math.hypot(channel(run, "twist.longitudinal")[-1], lateral - REAR_ARM * yaw_rate) / yaw_rate


_SUMS_DECLARATIONS = (
    no_verdict(
        "tatar.aim",
        "at equal speed and radius the signed sum is m a_y, which no correction can change",
        (RUNS,),
        *_changes(sum_of_magnitudes=("N", sum_of_magnitudes), signed_sum=("N", signed_sum)),
    ),
    judged(
        "tatar.radius",
        WALKING,
        Number(
            "m", WHEELBASE / math.tan(ANGLE), relative(0.01, "no slip angles: 1 m/s, where they are 0.1 deg"), _radius
        ),
        assumption="Ackermann geometry; two parallel wheels, which cannot both roll without slip, turn on 12.6 m",
    ),
    no_verdict(
        "tatar.resistance",
        "announced in the source, not published",
        (RUNS,),
        *_changes(
            drive_energy=("J", lambda run, _: energy_since_turning_in(run)),
            total_tyre_force=("N", lambda run, _: total_force(run)),
        ),
    ),
)


DECLARATIONS = (*_CLAIMS_DECLARATIONS, *_FIGURES_DECLARATIONS, *_SUMS_DECLARATIONS)
