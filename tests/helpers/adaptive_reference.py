"""The planar plant as one system of differential equations, for a solver with error control.

The physics is that of the plant's own functions: tyres, body, wheels, motor limits, driveline,
battery, road. What the plant does once a step is here the differential equation behind it: the lags
of motor torque, clutches and motor heat, the energies, the charge, the position. Coulomb friction
at the wheels (brakes and rolling resistance) is solved by events: between them every wheel turns
one way or is held, at them it stops, turns back or breaks loose. Taken from the run are its
commands, which are held over a control period, and the road-wheel angle, which is linear within it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from helpers.compiled_object import CompiledObject
from scipy.integrate import solve_ivp

from ev_core.compiled.loop import one_record
from ev_core.compiled.part_source import Unpacking, constants_row, constants_type
from ev_core.compiling.machine_code import compiled_function
from ev_core.lockstep.configuration import Configuration
from ev_core.methods.law import Given, given_names
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_sim.plant.guard import GuardState, guarded_steering, guarded_torques
from ev_sim.plant.planar.body import rates, steer
from ev_sim.plant.planar.contact import find_road
from ev_sim.plant.planar.model import Mechanics, Plant
from ev_sim.plant.planar.planar_state import (
    HEADING,
    INTEGRATED_SIZE,
    VX,
    VY,
    WHEEL_SPEED,
    Step,
    index,
)
from ev_sim.plant.planar.powertrain import account, apply_drives
from ev_sim.plant.planar.prepare import Lags, prepare
from ev_stack.recording.recording import Recording

SIZE = index("drives.front_left.torque")  # what comes before is advanced by differential equations
X, Y = index("x"), index("y")
MOTOR_TORQUE, MOTOR_HEAT, TORQUE_SHARE = (
    index("motor_torque"),
    index("motor_heat"),
    index("torque_share"),
)
STATE_OF_CHARGE, BATTERY_POWER, BATTERY_WORK = (
    index("state_of_charge"),
    index("battery_power"),
    index("battery_work"),
)
MOTOR_LOSS, DRIVELINE_LOSS, DRIVE_WORK = (
    index("motor_loss"),
    index("driveline_loss"),
    index("drive_work"),
)
AUXILIARY_WORK = index("auxiliary_work")
# Lags of a step that is long against all of them, with the torque at its beginning: the powertrain
# then applies the torque of the state and leaves behind the values that its lagged quantities go
# for.
NO_LAGS = Lags(torque=1.0, torque_mean=0.0, clutch=1.0, heat=1.0)
RELATIVE_TOLERANCE = 1e-9
# Nanometres, nanonewton metres and so on; of the carcasses' deflections, micronewtons.
ABSOLUTE_TOLERANCE = np.full(SIZE, 1e-9)
for _entry in ("longitudinal_deflection", "lateral_deflection"):
    ABSOLUTE_TOLERANCE[index(_entry) : index(_entry) + 4] = 1e-12
# Wheel speed [rad/s] and torque [N m] that count as zero at an event: above rounding, below
# anything that matters.
TOUCH = 1e-9


class Span(NamedTuple):
    """A time over which the commands were held and the road-wheel angle went on at one rate."""

    duration: float  # [s]
    drive: tuple[float, ...]  # [N m]
    brake: tuple[float, ...]  # [N m]
    angle: float  # at the beginning [rad]
    rate: float  # [rad/s]

    def goes_on_as(self, other: Span) -> bool:
        """Return True if the other span continues this one."""
        there = self.angle + self.rate * self.duration
        return (
            self[1:3] == other[1:3] and self.rate == other.rate and abs(there - other.angle) < 1e-14
        )


class DrivenPlant:
    """A configured plant that was driven as in a recording.

    Its state at the start and at the end, and its commands.
    """

    def __init__(self, configuration: Configuration, recording: Recording) -> None:
        self.parameters, self.vehicle = configuration.parameters, configuration.common.vehicle
        self.law = configuration.method.law
        self.period = configuration.common.control_period
        plant = CompiledObject(configuration.method, self.parameters, self.vehicle, self.period)
        self.start = plant.state.copy()
        self.spans: list[Span] = []
        limits, guard = prepare(self.parameters, self.vehicle, self.period).limits, GuardState()
        commands, columns = (
            _signals(recording, kind) for kind in (WheelTorqueCommand, SteeringColumnState)
        )
        for command, column in zip(commands[:-1], columns[:-1], strict=True):
            plant.advance(command, column)
            torques = guarded_torques(limits, guard, command)
            self._note(
                Span(self.period, *torques, *guarded_steering(limits, guard, column, self.period))
            )
        self.state = plant.state

    def _note(self, span: Span) -> None:
        if self.spans and self.spans[-1].goes_on_as(span):
            self.spans[-1] = self.spans[-1]._replace(
                duration=self.spans[-1].duration + span.duration
            )
        else:
            self.spans.append(span)


def _signals(recording: Recording, kind: type) -> list:
    rows = np.array([recording.channels[name] for name in TOPICS[kind].channels]).T
    return [shape_of(kind).signal_of(tuple(row)) for row in rows.tolist()]


def end_of_run(plant: DrivenPlant) -> np.ndarray:
    """The state at the end of the run, shape (SIZE,), by DOP853 at a relative tolerance of 1e-9."""
    # commutation of brushless drives is no differential equation
    assert plant.parameters.drive == "torque_controlled"
    equations, state, width = _Equations(plant), plant.start[:SIZE].copy(), 1e-3
    for span in plant.spans:
        time = 0.0
        while time < span.duration:
            equations.begin(span, time, state)
            found = solve_ivp(
                equations.slopes,
                (time, span.duration),
                state,
                method="DOP853",
                first_step=min(width, span.duration - time),
                rtol=RELATIVE_TOLERANCE,
                atol=ABSOLUTE_TOLERANCE,
                events=equations.events,
            )
            assert found.success, found.message
            if len(found.t) > 2:
                width = found.t[-2] - found.t[-3]  # the last step is cut off
            time, state = found.t[-1], found.y[:, -1].copy()
    return state


class _Equations:
    """Right-hand side and events in the form that the solver calls."""

    def __init__(self, plant: DrivenPlant) -> None:
        given = Given(plant.law, plant.parameters, plant.vehicle, plant.period)
        given.values["c"] = given.values["c"]._replace(h=1.0, lags=NO_LAGS)
        self._step, self._margins = one_record(Step()), np.zeros(4)
        self._slopes, self._decide = bound(slopes_of, given), bound(decide, given)
        self.events = [self._event(i) for i in range(4)]

    def begin(self, span: Span, time: float, state: np.ndarray) -> None:
        """Take the commands of a span and decide at a time of it which wheels turn or are held."""
        step = self._step[0]
        step["drive_command"], step["brake_command"] = span.drive, span.brake
        self._steering = (span.angle, span.rate)
        wheels = state[WHEEL_SPEED : WHEEL_SPEED + 4]
        wheels[np.abs(wheels) <= TOUCH] = 0.0
        step["motion"], step["held"] = np.sign(wheels), 0.0
        self.slopes(time, state)
        self._decide(state, self._step)

    def slopes(self, time: float, state: np.ndarray) -> np.ndarray:
        """Time derivative of the whole state."""
        slope = np.zeros(SIZE)  # the electrical side, which is not modelled here, stays as it is
        angle, rate = self._steering
        self._slopes(state, slope, self._margins, angle + rate * time, self._step)
        return slope

    def _event(self, wheel: int):
        def margin(time: float, state: np.ndarray) -> float:
            self.slopes(time, state)
            return self._margins[wheel]

        margin.terminal, margin.direction = True, -1.0
        return margin


@compilable
def dry_friction(car, step, i, vx):
    """The torque of drive and tyre on wheel i, and the largest one of dry friction [N m]."""
    rolling = (
        car.rolling_resistance
        + car.rolling_resistance_growth * vx * vx
        + step.tyre[i].rolling_resistance
    )
    torque = step.drive[i] - car.wheel_radius * step.force_x[i]
    return torque, step.brake[i] + car.wheel_radius * step.load[i] * rolling


@compilable
def decide(car, state, steps):
    """Release a wheel at rest if its torque reaches the dry friction, else hold it."""
    step = steps[0]
    for i in range(4):
        if state[WHEEL_SPEED + i] == 0.0:
            torque, dry = dry_friction(car, step, i, state[VX])
            loose = abs(torque) >= dry - TOUCH
            step.held[i] = 0.0 if loose else 1.0
            step.motion[i] = np.sign(torque) if loose else 0.0


@compilable
def slopes_of(p, car, c, s, state, slope, margins, angle, steps):
    """Derivative of the state into `slope`; into `margins` each wheel's distance to its event."""
    step = steps[0]
    for n in range(INTEGRATED_SIZE):
        s.motion[n] = state[n]
    for i in range(4):
        s.motor_torque[i], s.motor_heat[i] = state[MOTOR_TORQUE + i], state[MOTOR_HEAT + i]
        s.torque_share[i] = state[TORQUE_SHARE + i]
    s.state_of_charge, s.battery_power = state[STATE_OF_CHARGE], state[BATTERY_POWER]
    s.battery_work = s.motor_loss = s.driveline_loss = s.auxiliary_work = s.drive_work = 0.0
    find_road(s.motion, c.body, step, c.road, True)
    steer(car, step, angle, 0.0)
    plant = Plant(p, car, c, s, step)
    apply_drives(plant)
    rates(state, slope, Mechanics(p, car, c.body, step), False)
    for i in range(4):
        slope[MOTOR_TORQUE + i] = (
            s.motor_torque[i] - state[MOTOR_TORQUE + i]
        ) / car.motor.torque_lag
        slope[MOTOR_HEAT + i] = (s.motor_heat[i] - state[MOTOR_HEAT + i]) / car.motor.overload_time
        slope[TORQUE_SHARE + i] = (
            s.torque_share[i] - state[TORQUE_SHARE + i]
        ) / car.driveline.clutch_lag
        torque, dry = dry_friction(car, step, i, state[VX])
        margins[i] = (
            dry - abs(torque) if step.held[i] == 1.0 else step.motion[i] * state[WHEEL_SPEED + i]
        )
        step.turned[i] = state[WHEEL_SPEED + i]
    account(plant)
    slope[BATTERY_WORK], slope[MOTOR_LOSS], slope[DRIVELINE_LOSS] = (
        s.battery_work,
        s.motor_loss,
        s.driveline_loss,
    )
    slope[AUXILIARY_WORK], slope[DRIVE_WORK] = s.auxiliary_work, s.drive_work
    slope[STATE_OF_CHARGE] = s.state_of_charge - state[STATE_OF_CHARGE]
    slope[BATTERY_POWER] = 0.0  # no state of its own: the mean over the last step
    cosine, sine = np.cos(state[HEADING]), np.sin(state[HEADING])
    slope[X] = state[VX] * cosine - state[VY] * sine
    slope[Y] = state[VY] * cosine + state[VX] * sine


_BOUND = '''"""{function}: generated, do not edit."""

from numba import njit


@njit(error_model="numpy")
def step(constants, row, states, {rest}):
    k, s = constants[0], states[0]
    p, car, period = k.p, k.car, k.period
    c = {c}
    return function({given}, {rest})
'''


def bound(function: Callable[..., Any], given: Given) -> Callable[..., Any]:
    """The function, compiled, with what it asks for of p, car, c, s and period.

    The rest is still to be given.
    """
    names = given_names(function)
    rest = list(inspect.signature(function).parameters)[len(names) :]
    c, states = given.values["c"], one_record(given.values["s"])
    layout, row = (
        constants_type(given.trees, c),
        constants_row(given.trees, c, given.values["period"]),
    )
    unpacking = Unpacking(c, layout.itemsize // row.itemsize)
    text = _BOUND.format(
        function=function.__qualname__,
        given=", ".join(names),
        rest=", ".join(rest),
        c=unpacking.text,
    )
    step = compiled_function(function.__name__, text, {"function": function, **unpacking.names})
    return partial(step, row[: layout.itemsize // row.itemsize].view(layout), row, states)
