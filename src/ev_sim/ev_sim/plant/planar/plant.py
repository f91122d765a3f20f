"""The planar plant as a method of the role `plant`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ev_core.law import Car, SteeringColumnState, WheelTorqueCommand, cos, inlined, method, sin, working_memory
from ev_sim.plant.commands import guarded_steering, guarded_torques
from ev_sim.plant.planar.body import steer
from ev_sim.plant.planar.car_faults import deflate, delay_commands, find_faults
from ev_sim.plant.planar.contact import find_road
from ev_sim.plant.planar.drive_torques import apply_drives
from ev_sim.plant.planar.energy import account
from ev_sim.plant.planar.equations import integrate
from ev_sim.plant.planar.outputs import ELECTRICAL_SIGNALS, SIGNALS, electrical_outputs, outputs
from ev_sim.plant.planar.parameters import IMPOSED, PlanarParameters, load_files
from ev_sim.plant.planar.prepare import PlanarConstants, prepare, prepare_electrical
from ev_sim.plant.planar.start import at_start, keep_noted, notes
from ev_sim.plant.planar.state import HEADING, STAGES, STEP, VX, VY, WHEEL_ANGLE, PlanarState, Stages, Step
from ev_sim.profiles.profile import value_at

# What all methods of this plant have, but for what they say themselves.
PLANAR: dict[str, Any] = {
    "state": PlanarState,
    "prepare": prepare,
    "start": at_start,
    "outputs": outputs,
    "notes": notes,
    "writes": SIGNALS,
    "load_files": load_files,
    "heavy": True,
    "mirrored": True,
}


@method("plant", "planar", PlanarParameters, **PLANAR)
@inlined
def planar(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
) -> None:
    """Body in the plane, four wheels on real tyres and real roads, drives and battery (docs/planar_plant.md).

    Over one period the torques are held and the steering angle goes on at its rate, as the guard accepts them.
    """
    advance(p, car, c, s, period, command, column, apply_drives, account)


@inlined
def advance(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    apply: Callable[..., None],
    book: Callable[..., None],
) -> None:
    """One period; `apply` sets the torques of a step as `apply_drives` does, `book` its energies as `account` does."""
    torques = guarded_torques(c.limits, s.guard, command)
    angle, rate = guarded_steering(c.limits, s.guard, column, period)
    if len(c.faults.kind) > 0 or s.faults.is_struck == 1.0:
        find_faults(p, c.faults, s, period)
    s.periods += 1.0
    s.imposed_acceleration = 0.0
    if p.speed == IMPOSED:
        s.imposed_acceleration = (value_at(c.imposed, s.periods * period) - s.motion[VX]) / period
    _run(p, car, c, s, torques, angle, rate, apply, book, working_memory(STEP), working_memory(STAGES))
    s.road_wheel_angle = angle + rate * (c.steps * c.h)
    keep_noted(s, car, c.road)


@method(
    "plant",
    "planar_electrical",
    PlanarParameters,
    **PLANAR | {"prepare": prepare_electrical, "outputs": electrical_outputs, "writes": ELECTRICAL_SIGNALS},
)
@inlined
def planar_electrical(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
) -> None:
    """The planar plant with currents, voltages and temperatures of its motors, and cells (docs/electrical.md).

    Voltage of the DC link and temperatures limit the torque.
    """
    planar(p, car, c, s, period, command, column)


@inlined
def _run(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarState,
    torques: WheelTorqueCommand,
    angle: float,
    rate: float,
    apply: Callable[..., None],
    book: Callable[..., None],
    steps: list[Step],
    stages: list[Stages],
) -> None:
    """All steps of a period, from a road-wheel angle [rad] that goes on at its rate [rad/s]."""
    step, h, y = steps[0], c.h, s.motion
    step.imposed_acceleration = s.imposed_acceleration
    for i in range(4):
        step.drive_command[i], step.brake_command[i] = torques.drive[i], torques.brake[i]
        s.mean_drive[i] = 0.0
    is_struck = s.faults.is_struck == 1.0
    if is_struck:
        delay_commands(s.faults, s.periods - 1.0, step)
    for n in range(int(c.steps)):
        find_road(y, c.body, step, c.road, n == 0 or is_struck)
        if is_struck:
            deflate(s.faults, p, car, c.body, step)
        time = (n + 0.5) * h
        steer(car, step, angle + rate * time, s.rear_angle + s.rear_rate * time)
        apply(s, p, car, c.power, c.lags, step, h)
        vx, vy, heading = y[VX], y[VY], y[HEADING]
        for i in range(4):
            step.turned[i] = -y[WHEEL_ANGLE + i]
        integrate(y, p, car, c.body, step, stages[0], h)
        for i in range(4):
            step.turned[i] += y[WHEEL_ANGLE + i]
            s.mean_drive[i] += step.drive[i] / c.steps
        # The position feeds nothing back, so the trapezoidal rule over the step is enough.
        mean_x, mean_y = 0.5 * (vx + y[VX]), 0.5 * (vy + y[VY])
        middle = 0.5 * (heading + y[HEADING])
        cosine, sine = cos(middle), sin(middle)
        s.x += h * (mean_x * cosine - mean_y * sine)
        s.y += h * (mean_y * cosine + mean_x * sine)
        book(s, p, car, c.power, step, h)
