"""The steering-wheel angle to which the amplitudes of a manoeuvre refer, found on the very car by a slow ramp.

A scenario's file has the angles of its own car. Another car, road or speed has others: the
standards find them by steering so slowly that the car is always in its steady state (FMVSS 126,
S7.6; ISO 4138), and so do we, before the run. The ramp is one of the car, not of its control: it is
driven with equal torques and without traction control.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.parameters.declaration import defaults, parameter, setting
from ev_core.parameters.values import entries_by_name
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_sim.understeer import understeer_gradient
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

if TYPE_CHECKING:
    from ev_stack.scenarios.scenario import Run

COLUMN, ROBOT, SCALE = "steering_column", "steering_robot", "scale"
RAMP_BEGIN = 1.0  # [s], when the ramp begins
LARGEST = 2.5  # times the angle of the linear car: so far the ramp goes on
RAMP_READINGS = FITTED_LINE, AT_CROSSING = ("line", "crossing")
# of the wanted acceleration, over which FMVSS 126, S7.6, fits its line: 0.1 to 0.375 g
FIT_RANGE = (1 / 3, 1.25)
_HOW_A_ROAD_IS_DRAWN = ("road.seed", "road.random_distance")
_OF_THE_CAR = ("method", "initial_speed", "vehicle.", "road.", "rear_steering.")


@dataclass(frozen=True, slots=True)
class SlowRampParameters:
    """How the steering angles of a car are found that is not that of the file: in proportion to a reference angle."""

    lateral_acceleration: float = setting(
        0.0,
        unit="m/s^2",
        low=0.0,
        high=20.0,
        about="at which the angle is read, at the initial speed; 0: no ramp",
    )
    reference_angle: float = setting(
        1.0,
        unit="rad",
        low=1e-3,
        high=30.0,
        about="of the steering wheel at this acceleration, of the file's own car",
    )
    run: str = setting(
        "", about="run of the scenario that is such a ramp itself and keeps its angles"
    )
    rate: float = parameter(
        0.2356,
        unit="rad/s",
        low=1e-3,
        high=1.0,
        about="of the steering wheel, 13.5 deg/s",
        source="FMVSS 126, S7.6",
    )
    read: str = setting(
        FITTED_LINE,
        choices=RAMP_READINGS,
        about="from the line of FMVSS 126, S7.6, or where the acceleration is reached",
    )


def angle_at(run: Recording, acceleration: float, read: str = FITTED_LINE) -> float:
    """Steering-wheel angle at a lateral acceleration [m/s^2] on a slow ramp to either side [rad]."""
    angle = channel(run, motion.STEERING_WHEEL_ANGLE)
    side = np.sign(angle[np.abs(angle).argmax()])
    angle, across = side * angle, side * motion.lateral_acceleration_on_path(run)
    if read == AT_CROSSING:
        time = motion.crossing_time(
            run.time, across, acceleration, f"a lateral acceleration of {acceleration:g} m/s^2"
        )
        return motion.value_at(run, angle, time)
    slope, offset = motion.line_over(across, angle, *(share * acceleration for share in FIT_RANGE))
    return float(slope * acceleration + offset)


def on_its_own_car(
    run: Run, own: Run, ramp: SlowRampParameters, found: dict[str, float]
) -> tuple[Run, str]:
    """The run with the angles of its car, and what there is to note; `own` is the run as the file has it.

    As it is where its car is that of the file. `found` are the reference angles of the cars of
    other runs.
    """
    column = run.configurations[COLUMN]
    if run.name == ramp.run or column.method.name != ROBOT or _car(run) == _car(own):
        return run, ""
    try:
        car = repr(_car(run))
        if car not in found:
            found[car] = angle_at(driven_slowly(run, ramp), ramp.lateral_acceleration, ramp.read)
        changed = column.changed({SCALE: found[car] / ramp.reference_angle})
    except (NotMeasured, ParameterError, SignalError) as why:
        return (
            run,
            f"{run.name}: steering angles are those of the scenario's own car, a slow ramp gives none: {why}",
        )
    note = (
        f"{run.name}: {COLUMN}.{SCALE} is {changed.parameters.scale:.4g}: on a slow ramp to "
        f"{ramp.lateral_acceleration:g} m/s^2 this car takes {found[car]:.4g} rad, that of the file "
        f"{ramp.reference_angle:g} rad"
    )
    return replace(run, configurations={**run.configurations, COLUMN: changed}), note


def _car(run: Run) -> dict[str, Any]:
    """What the angle depends on: the car, its road, its speed."""
    return {
        name: value
        for role in (MASTER, "rear_steering")
        if role in run.configurations
        for short, value in run.configurations[role].values().items()
        for name in [short if role == MASTER else f"{role}.{short}"]
        if name.startswith(_OF_THE_CAR) and name not in _HOW_A_ROAD_IS_DRAWN
    }


def driven_slowly(run: Run, ramp: SlowRampParameters) -> Recording:
    """The true motion of the car of a run on the slow ramp, at the initial speed."""
    # numba is slow to import, and needed for other cars only
    from ev_stack.recording.offline import run_offline

    plant = run.configurations[MASTER]
    plant = replace(plant.changed({"faults": []}), sensors=defaults(type(plant.sensors)))
    car, speed = plant.common.vehicle, plant.values().get("initial_speed", 0.0)
    if speed == 0.0:
        raise NotMeasured("the run begins at rest, where no angle gives a lateral acceleration")
    linear = (car.wheelbase / speed**2 + abs(understeer_gradient(car))) * ramp.lateral_acceleration
    angle = LARGEST * linear * car.steering_ratio
    most = entries_by_name(run.configurations[COLUMN].method.parameters)["profile.angle"].spec.high
    if angle > most:
        raise NotMeasured(
            f"at the {abs(speed):g} m/s with which the run begins, {ramp.lateral_acceleration:g} m/s^2 would take "
            f"{angle / LARGEST:.3g} rad of the steering wheel, and a ramp ends at {LARGEST:g} times that, expected "
            f"up to {most:g} rad"
        )
    end = RAMP_BEGIN + angle / ramp.rate

    def of(role: str, method: str, **values: Any) -> Configuration:
        named = {name.replace("__", "."): value for name, value in values.items()}
        return replace(configure(role, {"method": method, **named}), common=plant.common)

    configurations = {
        **run.configurations,
        MASTER: plant,
        COLUMN: of(COLUMN, ROBOT, profile__time=[RAMP_BEGIN, end], profile__angle=[0.0, angle]),
        "driver": of(
            "driver", "manoeuvre", speed_profile__time=[0.0], speed_profile__speed=[speed]
        ),
        "electronic_differential": of("electronic_differential", "equal_torque"),
        "asr": of("asr", "off"),
    }
    return run_offline(configurations, end)
