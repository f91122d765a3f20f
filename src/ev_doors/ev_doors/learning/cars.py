"""The memory of many cars, and the calls of compiled code that step them (`stepping`).

How it works: each car has the parts that a run of a batch has (`placed`), with the law of the
learner's role among them. The cars are shared out to the cores. An episode begins with the states
that the parts have at their start; those of a role with random numbers are made for its seed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise

import numpy as np

from ev_core.compiled.interruptible import side_by_side
from ev_core.compiled.loop import FINISHED
from ev_core.methods.method_record import Method
from ev_doors.learning.environment import Environment
from ev_doors.learning.judging import Judge
from ev_doors.learning.stepping import (
    BEFORE,
    BEGIN,
    HERE,
    LAW,
    MISJUDGED,
    ORDER,
    STOPPED,
    WITHOUT_MEANING,
    Cars,
    Given,
    Places,
    Sizes,
    function,
)
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.placed import Placed, Placing

_FEWEST = 8  # cars for which a thread is worth its call


class SteppedCars:
    """Cars of a scenario around the same learner, each with its own parts.

    `of` is the environment of one of them, which gives all of them its bounds of what is observed.
    """

    def __init__(
        self, of: Environment, placing: Placing, judge: Judge, count: int, threads: int
    ) -> None:
        simulation = of.simulation
        self._of, self._placing, self._judge = of, placing, judge
        self._role = of.action.role
        self._roles = (
            *simulation.before, self._role, *simulation.behind, *simulation.integrating
        )  # fmt: skip
        self._integrating = simulation.integrating
        self._methods = {role: each.method for role, each in simulation.configurations.items()}
        actions = len(of.channels)
        self._placed: list[dict[str, list[Placed]]] = []
        orders: list[list[int]] = []
        vehicles = []
        for car in range(count):
            placed = {role: placing.placed(role, car) for role in self._roles}
            self._placed.append(placed)
            orders.append(self._order(placed))
            vehicles.append(placing.configuration(self._role, car).common.vehicle)
        self._random = [role for role in self._roles if placing.is_random(role)]
        # Kept: the compiled functions of the judges read them by their addresses.
        self._judged = {id(vehicle): judge.of(vehicle) for vehicle in vehicles}
        judges = [self._judged[id(vehicle)] for vehicle in vehicles]
        self.cars = Cars(
            frames=np.zeros((count, 3, frame.SIZE)),
            rows=np.zeros((count, max(order[-1] for order in orders), 5), np.int64),
            order=np.array(orders, np.int64),
            instants=np.zeros(count, np.int64),
            choices=np.zeros((count, 2, actions)),
            marks=np.zeros((count, 2)),
            judges=np.array([(address, row.ctypes.data) for address, row in judges], np.int64),
            largest=np.tile(of.observation_space.high, (count, 1)),
        )
        for car in range(count):
            self._put_rows(car)
        self._places = _places(of, self._methods[self._role])
        sizes = Sizes(
            limits=int(of.action.limits),
            period=simulation.period,
            cars=count,
            rows=self.cars.rows.shape[1],
            actions=actions,
            writes=len(self._places.writes),
            seen=len(of.observed),
        )
        self._sizes = np.array(sizes, np.int64)
        arrays = (self._sizes, *self.cars, *self._places)
        self._fixed = tuple(array.ctypes.data for array in arrays)
        shares = max(min(threads, count // _FEWEST), 1)
        ends = [count * share // shares for share in range(shares + 1)]
        self._shares = list(pairwise(ends))
        self._stopped = np.zeros((shares, STOPPED), np.int64)
        function()

    def _order(self, placed: Mapping[str, Sequence[Placed]]) -> list[int]:
        numbers = {role: len(parts) for role, parts in placed.items()}
        simulation = self._of.simulation
        order = [sum(numbers[role] for role in simulation.before)]
        order.append(order[-1] + numbers[self._role])
        order.append(order[-1] + sum(numbers[role] for role in simulation.behind))
        order.append(order[-1] + sum(numbers[role] for role in simulation.integrating))
        assert len(order) == ORDER
        return order

    def _put_rows(self, car: int) -> None:
        rows = [placed.row for role in self._roles for placed in self._placed[car][role]]
        self.cars.rows[car, : len(rows)] = rows

    def prepare(self, car: int, seed: int) -> None:
        """Put the states of a car to their start, with a seed of everything random."""
        placed = self._placed[car]
        for role in self._roles:
            if role in self._random:
                placed[role] = self._placing.seeded(placed[role], car, seed)
                continue
            for each in placed[role]:
                each.state[:] = each.part.state
        if self._random:
            self._put_rows(car)

    def call(self, given: Given) -> None:
        """Step the cars, or let them begin.

        ParameterError for what a law does, also the reward, SignalError where a number is not
        finite.
        """
        addresses = (*self._fixed, *(array.__array_interface__["data"][0] for array in given))
        step = function()
        calls = []
        for (first, last), stopped in zip(self._shares, self._stopped, strict=True):
            calls.append(partial(step, first, last, stopped.ctypes.data, *addresses))
        if len(calls) > 1 or self._placing.are_checked or self._judge.may_never_end:
            statuses = side_by_side(calls, (self, given))
        else:
            statuses = [calls[0]()]
        for status, stopped in zip(statuses, self._stopped, strict=True):
            if status != FINISHED:
                raise self._error(status, stopped.tolist(), given)

    def _error(self, status: int, stopped: Sequence[int], given: Given) -> Exception:
        """Error of the car at which a call has stopped: a part has written into a frame of it."""
        at, place, _, car = stopped
        frames = self.cars.frames[car]
        time = stamps.to_seconds(int(self.cars.instants[car]) * self._of.simulation.period)
        if status == WITHOUT_MEANING:
            written = float(frames[LAW, self._places.actions[place]])
            no_meaning = self._of.without_meaning(self._of.channels[place], written, time)
            return ParameterError(f"car {car}: {no_meaning}")
        if status == MISJUDGED:
            vehicle = self._placing.configuration(self._role, car).common.vehicle
            wrong = self._judge.error(vehicle, frames[HERE], self.cars.choices[car])
            return type(wrong)(f"car {car}: at {time:g} s: {wrong}")
        parts = [each for role in self._roles for each in self._placed[car][role]]
        part = parts[place]
        read: np.ndarray | None = frames[HERE]
        if part.role in self._integrating:
            read = None if given.doings[car] == BEGIN else frames[BEFORE]
        error = part.error(status, read, frames[at], self._methods[part.role])
        return type(error)(f"car {car}: at {time:g} s: {part.role}: {error}")


def _places(of: Environment, method: Method) -> Places:
    places = frame.channels()

    def at(channels: Sequence[str]) -> np.ndarray:
        return np.array([places[name] for name in channels], np.int64)

    written = [name for signal in method.writes for name in TOPICS[signal].channels]
    return Places(at(written), at(of.channels), at(of.action.asked(of.channels)), at(of.observed))
