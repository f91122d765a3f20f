"""Steering angles of another car than that of the scenario, found on a slow ramp.

How it works: a scenario's file has the angles of its own car. Another car, road or speed has
others: the standards find them by steering so slowly that the car is always in its steady state
(FMVSS 126, S7.6; ISO 4138), and so does `with_own_angles` for the runs that need it. The ramp is
one of the car, not of its control: it is driven with equal torques and without traction control.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.parameters.declaration import defaults
from ev_core.parameters.values import entries_by_name
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_sim.understeer import understeer_gradient
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.notes import Remark
from ev_stack.scenarios.records import Run, Scenario
from ev_stack.scenarios.slow_ramp import (
    AT_CROSSING,
    COLUMN,
    FITTED_LINE,
    ROBOT,
    SCALE,
    SlowRampParameters,
    car_of,
)

_OF_CONTROL = frozenset(("speed_mode",))  # switches of a plant for what the ramp is without
RAMP_BEGIN = 1.0  # [s], when the ramp begins
LARGEST = 2.5  # times the angle of the linear car: so far the ramp goes on
# Of the wanted acceleration, over which FMVSS 126, S7.6, fits its line: 0.1 to 0.375 g.
FIT_RANGE = (1 / 3, 1.25)


class NoOwnAngles(ParameterError):
    """A slow ramp gives no angles of a car; the message names the run and the reason."""


def with_own_angles(scenario: Scenario) -> Scenario:
    """Drive the slow ramps that runs need; each turns the wheel by angles of its own car then.

    Where a ramp gives none, a run keeps the angles of the file, and a note gives the reason.
    """
    found: dict[str, float] = {}  # runs with the same car share one ramp
    runs, notes = [], []
    for run in scenario.runs:
        try:
            run, note = on_its_own_angles(run, found)
            note = Remark(note)
        except NoOwnAngles as why:
            # Nothing tries again.
            run, note = replace(run, slow_ramp=None), str(why)
        runs.append(run)
        if note:
            notes.append(note)
    return replace(scenario, runs=tuple(runs), notes=(*scenario.notes, *notes))


def run_with_own_angles(run: Run) -> Run:
    """Drive the slow ramp that a run needs, if any; a warning where it gives none."""
    try:
        return on_its_own_angles(run, {})[0]
    except NoOwnAngles as why:
        # Of the caller's caller, which has named the scenario.
        warnings.warn(str(why), stacklevel=3)
        return replace(run, slow_ramp=None)


def on_its_own_angles(run: Run, found: dict[str, float]) -> tuple[Run, str]:
    """A run with the angles of its car and the note on it; `found` are those of cars so far.

    Raises NoOwnAngles if the ramp gives none.
    """
    ramp = run.slow_ramp
    if ramp is None:
        return run, ""
    # A text of all that angles depend on, as a key: lists in it have no hash.
    column, car = run.configurations[COLUMN], repr(car_of(run.configurations))
    try:
        if car not in found:
            driven = driven_slowly(run, ramp)
            found[car] = angle_at(driven, ramp.lateral_acceleration, ramp.read)
        changed = column.changed({SCALE: found[car] / ramp.reference_angle})
    except (NotMeasured, ParameterError, SignalError) as why:
        raise NoOwnAngles(
            f"{run.name}: steering angles are those of the scenario's own car, "
            f"a slow ramp gives none: {why}"
        ) from None
    note = (
        f"{run.name}: {COLUMN}.{SCALE} is {changed.parameters.scale:.4g}: on a slow ramp to "
        f"{ramp.lateral_acceleration:g} m/s^2 this car takes {found[car]:.4g} rad, that of the "
        f"file {ramp.reference_angle:g} rad"
    )
    configurations = {**run.configurations, COLUMN: changed}
    return replace(run, configurations=configurations, slow_ramp=None), note


def angle_at(run: Recording, acceleration: float, read: str = FITTED_LINE) -> float:
    """Steering-wheel angle [rad] at a lateral acceleration [m/s^2] on a slow ramp."""
    angle = channel(run, motion.STEERING_WHEEL_ANGLE)
    # A ramp to either side gives one angle, and the file's own signs stay.
    side = np.sign(angle[np.abs(angle).argmax()])
    angle = side * angle
    across = side * motion.lateral_acceleration_on_path(run)
    if read == AT_CROSSING:
        what = f"a lateral acceleration of {acceleration:g} m/s^2"
        time = motion.crossing_time(run.time, across, acceleration, what)
        return motion.value_at(run, angle, time)
    least, most = (share * acceleration for share in FIT_RANGE)
    slope, offset = motion.line_over(across, angle, least, most)
    return float(slope * acceleration + offset)


def driven_slowly(run: Run, ramp: SlowRampParameters) -> Recording:
    """The true motion of the car of a run on the slow ramp, at the initial speed."""
    plant = run.configurations[MASTER]
    # Faults and sensors would be in the angle as well; speed mode needs a traction control.
    ideal = {"faults": [], **dict.fromkeys(_OF_CONTROL & plant.values().keys(), False)}
    plant = plant.changed(ideal)
    plant = replace(plant, sensors=defaults(type(plant.sensors)))
    speed = plant.values().get("initial_speed", 0.0)
    angle = _largest_angle(run, ramp, speed)
    end = RAMP_BEGIN + angle / ramp.rate
    turned = {"profile.time": [RAMP_BEGIN, end], "profile.angle": [0.0, angle]}
    kept = {"speed_profile.time": [0.0], "speed_profile.speed": [speed]}

    def of(role: str, method: str, values: dict[str, Any]) -> Configuration:
        return replace(configure(role, {"method": method, **values}), common=plant.common)

    configurations = {
        **run.configurations,
        MASTER: plant,
        COLUMN: of(COLUMN, ROBOT, turned),
        "driver": of("driver", "manoeuvre", kept),
        "electronic_differential": of("electronic_differential", "equal_torque", {}),
        "asr": of("asr", "off", {}),
    }
    return run_offline(configurations, end)


def _largest_angle(run: Run, ramp: SlowRampParameters, speed: float) -> float:
    """End of the ramp [rad], by the linear car; NotMeasured if the column does not turn so far."""
    car = run.configurations[MASTER].common.vehicle
    if speed == 0.0:
        raise NotMeasured("the run begins at rest, where no angle gives a lateral acceleration")
    # delta/a_y = L/V^2 + K_us; by magnitude, so that an oversteering car has a ramp as well.
    gain = car.wheelbase / speed**2 + abs(understeer_gradient(car))
    # From the angle of the road wheels to that of the steering wheel.
    angle = LARGEST * (gain * ramp.lateral_acceleration) * car.steering_ratio
    known = entries_by_name(run.configurations[COLUMN].method.parameters)
    most = known["profile.angle"].spec.high
    if angle > most:
        raise NotMeasured(
            f"at the {abs(speed):g} m/s with which the run begins, "
            f"{ramp.lateral_acceleration:g} m/s^2 would take {angle / LARGEST:.3g} rad of the "
            f"steering wheel, and a ramp ends at {LARGEST:g} times that, "
            f"expected up to {most:g} rad"
        )
    return angle
