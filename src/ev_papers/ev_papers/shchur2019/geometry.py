"""Shchur (2019), Fig 2: angles and radii of the front wheels in a turn; and the schemes."""

from __future__ import annotations

from collections.abc import Callable

from ev_core.vehicle.description import Vehicle
from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.assumptions import ACKERMANN, SIGN_OF_RADIUS
from ev_papers.shchur2019.cycle import CYCLE
from ev_sim.plant.ackermann import front_wheel_angles, path_curvature, wheel_speed_ratios
from ev_sim.verdicts.check import Number, relative
from ev_sim.verdicts.declaration import Declaration, judged, no_verdict
from ev_sim.verdicts.need import ScenarioRuns

_TURN = paper.turn(paper.TURN_ANGLE)
_ALGEBRA = relative(0.001, "algebra")


def _radius(car: Vehicle) -> float:
    return 1 / path_curvature(paper.TURN_ANGLE, car.wheelbase, car.centre_of_mass_to_rear_axle)


def _front_radius(car: Vehicle, right: bool) -> float:
    ratios = wheel_speed_ratios(
        paper.TURN_ANGLE, car.wheelbase, car.front_track, car.rear_track, car.centre_of_mass_to_rear_axle
    )
    return _radius(car) * (ratios.front_right if right else ratios.front_left)


def _angle(car: Vehicle, right: bool) -> float:
    return front_wheel_angles(paper.TURN_ANGLE, car.wheelbase, car.front_track)[int(right)]


def _of_the_car(name: str, unit: str, value: float, measure: Callable[[Vehicle], float]) -> Number:
    def of_driven(driven: ScenarioRuns) -> float:
        return measure(driven.vehicle)

    return Number(unit, value, _ALGEBRA, of_driven, name)


DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "shchur.angles30",
        CYCLE,
        _of_the_car("inside", "rad", _TURN.left_angle, lambda car: _angle(car, right=False)),
        _of_the_car("outside", "rad", _TURN.right_angle, lambda car: _angle(car, right=True)),
        _of_the_car("R inside", "m", _TURN.left_radius, lambda car: _front_radius(car, right=False)),
        _of_the_car("R outside", "m", _TURN.right_radius, lambda car: _front_radius(car, right=True)),
        _of_the_car("R", "m", _TURN.radius, _radius),
        inputs=f"{ACKERMANN}; {SIGN_OF_RADIUS}",
    ),
    no_verdict("shchur.fig2", "a scheme; its equations are 8 to 12"),
    no_verdict("shchur.fig3", "a scheme; its parts are in the row of the references and of eq 13"),
)
