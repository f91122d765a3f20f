"""A step of many cars in one compiled call: action, graph, observation, reward, the scenario's law.

How it works: each car has three frames. The first one is that of the present instant. In a step the
action takes the place of what the law wrote; roles behind it answer; the frame is copied into the
second one, from which the roles that integrate write the next instant into the first one. Then the
roles in front of the learner's answer, and the car is observed and judged. The law of the scenario
answers into the third frame, so that the first one shows what acted. The rows of a car are those of
the roles in front, of the law, of the roles behind it, and of those that integrate.
"""

from __future__ import annotations

from ctypes import CFUNCTYPE, c_int32, c_int64, c_void_p
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_core.compiled.loop import FINISHED, Parts, drive_instant, start
from ev_core.compiling.machine_code import Code, call
from ev_doors.learning.environment import meant, standing_for
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.frame import TIME

STEP, BEGIN, LEAVE = range(3)  # what a car does in a call
WITHOUT_MEANING, MISJUDGED = 3, 4  # statuses beside those of the loop
HERE, BEFORE, LAW = range(3)  # frames of a car
ORDER = 4  # numbers of a car's order: first rows of law, behind and integrating, end of all rows
STOPPED = 4  # numbers on where a call has stopped: frame, row, unused, car
_NANOSECONDS = float(stamps.NANOSECONDS)


class Cars(NamedTuple):
    """Arrays of all cars; the memory of their states and constants is that of their parts.

    `frames` (cars, 3, size), `rows` (cars, rows, 5) with their `order` (cars, ORDER), number of the
    `instants` (cars,), `choices` (cars, 2, actions) of the learner and of the law, `marks` (cars,
    2) of the judge, `judges` (cars, 2) with its function and the numbers of the car.
    """

    frames: np.ndarray
    rows: np.ndarray
    order: np.ndarray
    instants: np.ndarray
    choices: np.ndarray
    marks: np.ndarray
    judges: np.ndarray
    largest: np.ndarray


class Places(NamedTuple):
    """Places in a frame: of what the role writes, of the action, of what it limits, observed."""

    writes: np.ndarray
    actions: np.ndarray
    asked: np.ndarray
    seen: np.ndarray


class Given(NamedTuple):
    """Arrays of a call: what each car does, its action, and what it gives back."""

    doings: np.ndarray
    actions: np.ndarray
    seen: np.ndarray
    rewards: np.ndarray
    ended: np.ndarray
    own: np.ndarray


class Task(NamedTuple):
    """All that a call works on: kind of action, control period [ns], and its arrays."""

    limits: bool
    period: int
    cars: Cars
    places: Places
    given: Given


@compilable
def act(car: int, task: Task) -> None:
    """Put the answer of the law into the frame, and the action of the learner into its channels."""
    cars, places = task.cars, task.places
    here, law = cars.frames[car, HERE], cars.frames[car, LAW]
    for place in places.writes:
        here[place] = law[place]
    for i in range(len(places.actions)):
        action, place = task.given.actions[car, i], places.actions[i]
        cars.choices[car, 0, i] = action
        value = meant(task.limits, here[places.asked[i]], action)
        # What equals the output of the law is that output: of two zeros one may have a sign.
        if value != law[place]:
            here[place] = value


@compilable
def go_on(car: int, task: Task, stopped: np.ndarray) -> int:
    """Take a car from its instant to the next one, but for what answers there."""
    cars = task.cars
    frames, order = cars.frames[car], cars.order[car]
    act(car, task)
    parts = Parts(cars.rows[car, : order[3]], order[2])
    status = drive_instant(frames, HERE, HERE, (order[1], order[2]), parts, stopped)
    if status != FINISHED:
        return status
    # One by one: an assignment of all of them would take a heap.
    for i in range(frames.shape[1]):
        frames[BEFORE, i] = frames[HERE, i]
    cars.instants[car] += 1
    frames[HERE, TIME] = cars.instants[car] * task.period / _NANOSECONDS
    return drive_instant(frames, BEFORE, HERE, (order[2], order[3]), parts, stopped)


@compilable
def begin(car: int, cars: Cars, stopped: np.ndarray) -> int:
    """Put a car to its first instant, but for what answers there."""
    frames, order = cars.frames[car], cars.order[car]
    for i in range(frames.shape[1]):
        frames[HERE, i] = 0.0
    cars.instants[car] = 0
    return start(frames, Parts(cars.rows[car, : order[3]], order[2]), stopped)


@compilable
def judge(car: int, cars: Cars) -> int:
    """Let the compiled function of reward and end look at a car; not 0 where it fails."""
    function, constants = cars.judges[car]
    here = cars.frames.ctypes.data + car * cars.frames.strides[0]
    marks = cars.marks.ctypes.data + car * cars.marks.strides[0]
    choices = cars.choices.ctypes.data + car * cars.choices.strides[0]
    return call(function, here, marks, choices, constants)


@compilable
def answer(car: int, task: Task, stopped: np.ndarray) -> int:
    """Let the roles in front of the learner answer, judge, and let the law answer."""
    cars, places = task.cars, task.places
    frames, order = cars.frames[car], cars.order[car]
    rows = cars.rows[car, : order[3]]
    status = drive_instant(frames, HERE, HERE, (0, order[0]), Parts(rows, order[2]), stopped)
    if status != FINISHED:
        return status
    # Where an episode begins there is nothing to reward.
    if task.given.doings[car] == STEP:
        if judge(car, cars) != FINISHED:
            return MISJUDGED
        task.given.rewards[car] = cars.marks[car, 0]
        task.given.ended[car] = cars.marks[car, 1] != 0.0
    frames[LAW, TIME] = frames[HERE, TIME]
    status = drive_instant(frames, HERE, LAW, (order[0], order[1]), Parts(rows, 0), stopped)
    if status != FINISHED:
        return status
    for i in range(len(places.actions)):
        written = frames[LAW, places.actions[i]]
        own = standing_for(task.limits, written)
        cars.choices[car, 1, i] = own
        if meant(task.limits, frames[HERE, places.asked[i]], own) != written:
            stopped[1] = i
            return WITHOUT_MEANING
    return FINISHED


@compilable
def show(car: int, task: Task) -> None:
    """Write what is observed of a car, and the action that stands for its law."""
    cars, places, given = task.cars, task.places, task.given
    for i in range(len(places.seen)):
        most = cars.largest[car, i]
        given.seen[car, i] = min(max(cars.frames[car, HERE, places.seen[i]], -most), most)
    for i in range(len(places.actions)):
        given.own[car, i] = cars.choices[car, 1, i]


@compilable
def step_cars(first: int, last: int, task: Task, stopped: np.ndarray) -> int:
    """Step some of the cars, put them to their start, or show them as they are."""
    for car in range(first, last):
        stopped[3] = car
        doing = task.given.doings[car]
        if doing != LEAVE:
            status = begin(car, task.cars, stopped) if doing == BEGIN else go_on(car, task, stopped)
            if status == FINISHED:
                status = answer(car, task, stopped)
            if status != FINISHED:
                return status
        show(car, task)
    return FINISHED


class Sizes(NamedTuple):
    """Numbers of all calls: kind of action, control period [ns], and the lengths of all arrays."""

    limits: int
    period: int
    cars: int
    rows: int
    actions: int
    writes: int
    seen: int


_CODE = Code(
    "step_cars",
    f'''"""A step of many cars: generated, do not edit."""

import numpy as np
from numba import carray, cfunc, types

I, P = types.int64, types.voidptr


@cfunc(types.int32({", ".join(["I", "I", *["P"] * 20])}), error_model="numpy")
def step(first, last, stopped, sizes, frames, rows, order, instants, choices, marks, judges,
         largest, writes, actions, asked, seen, doings, chosen, shown, rewards, ended, own):
    n = carray(sizes, {len(Sizes._fields)}, np.int64)
    cars = Cars(
        carray(frames, (n[2], 3, {frame.SIZE}), np.float64),
        carray(rows, (n[2], n[3], 5), np.int64),
        carray(order, (n[2], {ORDER}), np.int64),
        carray(instants, n[2], np.int64),
        carray(choices, (n[2], 2, n[4]), np.float64),
        carray(marks, (n[2], 2), np.float64),
        carray(judges, (n[2], 2), np.int64),
        carray(largest, (n[2], n[6]), np.float64),
    )
    places = Places(
        carray(writes, n[5], np.int64),
        carray(actions, n[4], np.int64),
        carray(asked, n[4], np.int64),
        carray(seen, n[6], np.int64),
    )
    given = Given(
        carray(doings, n[2], np.uint8),
        carray(chosen, (n[2], n[4]), np.float64),
        carray(shown, (n[2], n[6]), np.float64),
        carray(rewards, n[2], np.float64),
        carray(ended, n[2], np.uint8),
        carray(own, (n[2], n[4]), np.float64),
    )
    task = Task(n[0] != 0, n[1], cars, places, given)
    return drive(first, last, task, carray(stopped, {STOPPED}, np.int64))
''',
    {"drive": step_cars, "Task": Task, "Cars": Cars, "Places": Places, "Given": Given},
)


@cache
def function() -> Any:
    """The compiled step: first and last car, then addresses in the order of the records above."""
    return CFUNCTYPE(c_int32, c_int64, c_int64, *[c_void_p] * 20)(_CODE.address())
