"""Body, wheels and carcasses of the planar plant as y' = f(y), for solvers, analyses and comparisons."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_msgs_py.car import car_numbers
from ev_msgs_py.compiling.function import compiled, in_memory
from ev_msgs_py.parameters import number_tree
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS
from ev_sim.plant.planar.body import rates
from ev_sim.plant.planar.constants import body_constants
from ev_sim.plant.planar.integrator import integrate
from ev_sim.plant.planar.memory import Stages, Step
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.road_under_wheels import find_road, road_tables
from ev_sim.plant.planar.state import INTEGRATED_SIZE
from ev_sim.plant.planar.steering import steer


class Equations:
    """The integrated part of the plant under torques, a steering angle and a road that stay as they are told.

    y are the numbers that `state.INTEGRATED` names, shape (INTEGRATED_SIZE,). Everything is compiled.
    """

    def __init__(self, parameters: PlanarParameters, vehicle: Vehicle) -> None:
        p, car = in_memory(number_tree(parameters)), in_memory(car_numbers(vehicle))
        self._model = (p, car, in_memory(body_constants(vehicle)))
        self._step, self._stages = in_memory(Step()), in_memory(Stages())
        road = road_tables(parameters.road, vehicle)
        self._road = type(road)(*(type(table)(*map(np.array, table)) for table in road))
        self._rates, self._integrate, self._find_road = compiled(rates), compiled(integrate), compiled(find_road)
        self._steer = compiled(steer)

    def look(self, y: np.ndarray) -> None:
        """Take the road from where the car is now."""
        self._find_road(y, self._model[2], self._step, self._road, True)

    def hold(self, angle: float, drive: Sequence[float] = NO_WHEELS, brake: Sequence[float] = NO_WHEELS) -> None:
        """Hold a mean road-wheel angle [rad], and drive and brake torques at the wheels [N m]."""
        self._step["drive"], self._step["brake"] = tuple(drive), tuple(brake)
        self._steer(self._model[1], self._step, angle)

    def rates(self, y: np.ndarray, starts: bool = False) -> np.ndarray:
        """f(y); one that `starts` decides which direction dry friction opposes at each wheel, the others keep to it."""
        dy = np.empty(INTEGRATED_SIZE)
        self._rates(y, dy, *self._model, self._step, starts)
        return dy

    def advance(self, y: np.ndarray, h: float) -> None:
        """One step of h [s] of the plant's own method, in place."""
        self._integrate(y, *self._model, self._step, self._stages, h)
