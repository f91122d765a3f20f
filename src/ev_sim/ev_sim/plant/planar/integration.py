"""Body, wheels and carcasses of the planar plant as y' = f(y), for solvers, analyses and comparisons."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_core.compiled.loop import compiled, one_record
from ev_core.law import NO_WHEELS, Car, Vehicle, inlined
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.car import car_numbers
from ev_sim.plant.planar.body import rates, steer
from ev_sim.plant.planar.contact import find_road
from ev_sim.plant.planar.given import BodyConstants, PlanarParameters, body_constants
from ev_sim.plant.planar.planar_state import INTEGRATED_SIZE, WHEEL_SPEED, Row, Step
from ev_sim.plant.planar.prepare import RoadTables, road_tables


@inlined
def integrate(y: Row, p: PlanarParameters, car: Car, body: BodyConstants, step: Step, h: float) -> None:
    """Advance the integrated part of the state in place by h [s].

    A wheel that dry friction has stopped within the step ends it at rest, exactly.
    """
    stages = step.stages
    stage, k1, k2, k3, k4 = stages.state, stages.k1, stages.k2, stages.k3, stages.k4
    rates(y, k1, p, car, body, step, True)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + 0.5 * h * k1[n]
    rates(stage, k2, p, car, body, step, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + 0.5 * h * k2[n]
    rates(stage, k3, p, car, body, step, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + h * k3[n]
    rates(stage, k4, p, car, body, step, False)
    for n in range(INTEGRATED_SIZE):
        y[n] += h / 6.0 * ((k1[n] + k4[n]) + 2.0 * (k2[n] + k3[n]))
    for i in range(4):
        if step.motion[i] * y[WHEEL_SPEED + i] < 0.0:
            y[WHEEL_SPEED + i] = 0.0


One = np.ndarray


class Equations:
    """The integrated part of the plant under torques, a steering angle and a road that stay as they are given.

    y are the numbers that `state.INTEGRATED` names, shape (INTEGRATED_SIZE,). Everything is compiled.
    """

    def __init__(self, parameters: PlanarParameters, vehicle: Vehicle) -> None:
        self._car, self._body = one_record(car_numbers(vehicle)), one_record(body_constants(vehicle))
        self._step = one_record(Step())
        self._model = (one_record(number_tree(parameters)), self._car, self._body, self._step)
        road = road_tables(parameters.road, vehicle)
        self._road = type(road)(*(type(table)(*map(np.array, table)) for table in road))
        self._rates, self._advance, self._hold, self._look = map(compiled, (_rates, _advance, _hold, _look))

    def look(self, y: np.ndarray) -> None:
        """Take the road from where the car is now."""
        self._look(y, self._body, self._step, self._road)

    def hold(self, angle: float, drive: Sequence[float] = NO_WHEELS, brake: Sequence[float] = NO_WHEELS) -> None:
        """Hold a mean road-wheel angle [rad], and drive and brake torques at the wheels [N m]."""
        self._step["drive"], self._step["brake"] = tuple(drive), tuple(brake)
        self._hold(self._car, self._step, angle)

    def rates(self, y: np.ndarray, starts: bool = False) -> np.ndarray:
        """f(y); one that `starts` decides which direction dry friction opposes at each wheel, the others keep to it."""
        dy = np.empty(INTEGRATED_SIZE)
        self._rates(y, dy, *self._model, starts)
        return dy

    def advance(self, y: np.ndarray, h: float) -> None:
        """One step of h [s] of the plant's own method, in place."""
        self._advance(y, *self._model, h)


# Compiled code is called with arrays of one record each.


@inlined
def _rates(y: Row, dy: Row, p: One, cars: One, bodies: One, steps: One, starts: bool) -> None:
    rates(y, dy, p[0], cars[0], bodies[0], steps[0], starts)


@inlined
def _advance(y: Row, p: One, cars: One, bodies: One, steps: One, h: float) -> None:
    integrate(y, p[0], cars[0], bodies[0], steps[0], h)


@inlined
def _hold(cars: One, steps: One, angle: float) -> None:
    steer(cars[0], steps[0], angle, 0.0)


@inlined
def _look(y: Row, bodies: One, steps: One, road: RoadTables) -> None:
    find_road(y, bodies[0], steps[0], road, True)
