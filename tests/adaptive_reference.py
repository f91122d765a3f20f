"""The planar plant as one system of differential equations, for a solver with error control.

The physics is that of the compiled functions: tyres, body, wheels, motor limits, driveline, battery, road. What the
fused loop does once a step is here the differential equation behind it: the lags of motor torque, clutches and motor
heat, the energies, the charge, the position. Coulomb friction at the wheels (brakes and rolling resistance) is solved
by events: between them every wheel turns one way or is held, at them it stops, turns back or breaks loose. Taken from
the run are its commands, which are held over a control period, and the road-wheel angle, which is linear within it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from ev_sim.compiled import compiled
from ev_sim.plant.planar.body import HEADING, VX, VY, WHEEL_SPEED, rates
from ev_sim.plant.planar.plant import PlanarPlant
from ev_sim.plant.planar.powertrain import (
    AUXILIARY_WORK,
    BATTERY_POWER,
    BATTERY_WORK,
    DRIVE_WORK,
    DRIVELINE_LOSS,
    MOTOR_HEAT,
    MOTOR_LOSS,
    MOTOR_TORQUE,
    STATE_OF_CHARGE,
    TORQUE_SHARE,
    account,
    apply_drives,
)
from ev_sim.plant.planar.state import SIZE, X, Y, index
from ev_sim.plant.planar.surroundings import find_road, steer

# Lags of a step that is long against all of them, with the torque at its beginning: the powertrain then applies the
# torque of the state and leaves behind the values that its lagged quantities go for.
NO_LAGS = (1.0, 0.0, 1.0, 1.0)
WORKS = (BATTERY_WORK, MOTOR_LOSS, DRIVELINE_LOSS, AUXILIARY_WORK, DRIVE_WORK)
RELATIVE_TOLERANCE = 1e-9
# Nanometres, nanonewton metres and so on; of the carcasses' deflections, micronewtons.
ABSOLUTE_TOLERANCE = np.full(SIZE, 1e-9)
for _entry in ("longitudinal_deflection", "lateral_deflection"):
    ABSOLUTE_TOLERANCE[index(_entry) : index(_entry) + 4] = 1e-12
# Wheel speed [rad/s] and torque [N m] that count as zero at an event: above rounding, below anything that matters.
TOUCH = 1e-9


class Span(NamedTuple):
    """A time over which the commands were held and the road-wheel angle went on at one rate."""

    duration: float  # [s]
    drive: tuple[float, ...]  # [N m]
    brake: tuple[float, ...]  # [N m]
    angle: float  # at the beginning [rad]
    rate: float  # [rad/s]

    def goes_on_as(self, other: Span) -> bool:
        """Whether the other span does as this one would."""
        there = self.angle + self.rate * self.duration
        return self[1:3] == other[1:3] and self.rate == other.rate and abs(there - other.angle) < 1e-14


class RecordedPlant(PlanarPlant):
    """A planar plant that keeps its state at the start and the commands that it accepted."""

    def __init__(self, *arguments) -> None:
        super().__init__(*arguments)
        self.start = self.state.copy()
        self.spans: list[Span] = []

    def advance(self, command, column) -> None:
        super().advance(command, column)
        step = self._step[0]
        drive, brake = tuple(step["drive_command"].tolist()), tuple(step["brake_command"].tolist())
        span = Span(self.period, drive, brake, float(step["steering_angle"]), float(step["steering_rate"]))
        if self.spans and self.spans[-1].goes_on_as(span):
            self.spans[-1] = self.spans[-1]._replace(duration=self.spans[-1].duration + span.duration)
        else:
            self.spans.append(span)


def end_of_run(plant: RecordedPlant) -> np.ndarray:
    """The state at the end of the recorded run, shape (SIZE,), by DOP853 at a relative tolerance of 1e-9."""
    assert plant._car[0]["brushless"] == 0  # the commutation of brushless drives is no differential equation
    equations, state, width = _Equations(plant), plant.start.copy(), 1e-3
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

    def __init__(self, plant: RecordedPlant) -> None:
        vehicle = plant.vehicle
        self._step = plant._step.copy()
        self._model = (
            plant._car,
            self._step,
            plant._road,
            plant._maps,
            plant._voltages,
            (vehicle.motor.torque_lag, vehicle.motor.overload_time, vehicle.driveline.clutch_lag),
            (plant._record["drives"][0], plant._record["drive_parameters"][0]),
        )
        self._scratch, self._work, self._margins = np.zeros(SIZE), np.zeros((5, 4)), np.zeros(4)
        self.events = [self._event(i) for i in range(4)]

    def begin(self, span: Span, time: float, state: np.ndarray) -> None:
        """Take the commands of a span and decide at a time of it which wheels turn or are held."""
        step = self._step[0]
        step["drive_command"], step["brake_command"] = span.drive, span.brake
        step["steering_angle"], step["steering_rate"] = span.angle, span.rate
        wheels = state[WHEEL_SPEED : WHEEL_SPEED + 4]
        wheels[np.abs(wheels) <= TOUCH] = 0.0
        step["motion"], step["held"] = np.sign(wheels), 0.0
        self.slopes(time, state)
        _decide(state, *self._model[:2])

    def slopes(self, time: float, state: np.ndarray) -> np.ndarray:
        """Time derivative of the whole state."""
        slope = np.empty(SIZE)
        _slopes(time, state, slope, *self._model, self._scratch, self._work, self._margins)
        return slope

    def _event(self, wheel: int):
        def margin(time: float, state: np.ndarray) -> float:
            self.slopes(time, state)
            return self._margins[wheel]

        margin.terminal, margin.direction = True, -1.0
        return margin


@compiled
def _dry_friction(car, step, i: int, vx: float) -> tuple[float, float]:
    """The torque of drive and tyre on wheel i, and the largest one of dry friction [N m]."""
    rolling = car.rolling + car.rolling_speed * vx * vx + step.tyre[i, 4]
    return step.drive[i] - car.radius * step.force_x[i], step.brake[i] + car.radius * step.load[i] * rolling


@compiled
def _decide(state, car_record, step_record):
    """A wheel at rest breaks loose if the torque on it is as large as the dry friction, else it is held."""
    car, step = car_record[0], step_record[0]
    for i in range(4):
        if state[WHEEL_SPEED + i] == 0.0:
            torque, dry = _dry_friction(car, step, i, state[VX])
            loose = abs(torque) >= dry - TOUCH
            step.held[i] = 0.0 if loose else 1.0
            step.motion[i] = np.sign(torque) if loose else 0.0


@compiled
def _slopes(time, state, slope, car_record, step_record, road, maps, voltages, lags, brushless, scratch, work, margins):
    """Derivative of the state into `slope`, and into `margins` how far each wheel is from its next event."""
    car, step = car_record[0], step_record[0]
    torque_lag, overload_time, clutch_lag = lags
    find_road(state, car, step, road)
    steer(car, step, step.steering_angle + step.steering_rate * time)
    scratch[:] = state
    apply_drives(scratch, car, step, maps, voltages, NO_LAGS, brushless, 1.0, work)
    rates(state, slope, car, step, False)
    for i in range(4):
        for place, lag in ((MOTOR_TORQUE, torque_lag), (MOTOR_HEAT, overload_time), (TORQUE_SHARE, clutch_lag)):
            slope[place + i] = (scratch[place + i] - state[place + i]) / lag
        torque, dry = _dry_friction(car, step, i, state[VX])
        margins[i] = dry - abs(torque) if step.held[i] == 1.0 else step.motion[i] * state[WHEEL_SPEED + i]
        work[4, i] = state[WHEEL_SPEED + i]
    for place in WORKS:
        scratch[place] = 0.0
    account(scratch, car, step, maps, voltages, brushless, work[4], 1.0, work)
    for place in WORKS:
        slope[place] = scratch[place]
    slope[STATE_OF_CHARGE] = scratch[STATE_OF_CHARGE] - state[STATE_OF_CHARGE]
    slope[BATTERY_POWER] = 0.0  # no state of its own: the mean over the last step
    cosine, sine = np.cos(state[HEADING]), np.sin(state[HEADING])
    slope[X] = state[VX] * cosine - state[VY] * sine
    slope[Y] = state[VY] * cosine + state[VX] * sine
