"""The sedan of `config/vehicles` driven as an 18-DOF and an 11-DOF model of others were driven.

`sedan_18dof.csv` has what these models give (uwsbel/low-fidelity-dynamic-models, C++, MIT licence,
2024; half-implicit Euler of 1 ms) with the tyre of our file: `soft` is the sedan as it is, `front`
has roll stiffnesses of 15 000 and 5 000 N m/rad, `rigid` does not roll. They were driven with all
mass in the body (`lumped`) and without relaxation of the tyres, so ours is driven with carcasses as
stiff as steps of 1 ms take, and loads that follow in the shortest time. A step of the road-wheel
angle is a ramp of 0.1 s under held speed, a ramp has 2 mrad/s for 30 s; `t90` counts from half of
the step, `beta` is that of the axles, and the gradient at a lateral acceleration the slope of
delta - L r/u over it from 0.4 m/s^2 below to 0.4 m/s^2 above. A sine has 0.01 rad and 0.5 Hz; its
gains are amplitudes over that of the angle, its phases lead it.
"""

from __future__ import annotations

import csv
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
from plant.planar.car import command, outputs, plant, steered

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.tyre import MF_NAMES
from ev_msgs_py.contract.signals import TireForces
from ev_sim.plant.planar.given import roll_constants
from ev_sim.plant.planar.planar_state import ROLL_RATE, VY, YAW_RATE
from ev_stack.scenarios.files import vehicle_of

SPEEDS = (15.0, 20.0, 25.0)
ANGLES = (0.01, 0.02, 0.04)
ACCELERATIONS = ("2.0", "4.0", "6.0")
PERIOD = 1e-3
RAMP_RATE = 2e-3  # [rad/s]
RAMP_SPEED = 20.0  # [m/s]
SINE_ANGLE = 0.01  # [rad]
SINE_RATE = np.pi  # [rad/s]
THEIR_CREEP = 0.01  # added to the speed of a rim, below every slip of theirs [m/s]


def reference() -> dict[str, dict[str, dict[str, float]]]:
    """Numbers of the other models by model, manoeuvre and quantity."""
    found: dict = defaultdict(lambda: defaultdict(dict))
    with (Path(__file__).parent / "sedan_18dof.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            found[row["model"]][row["manoeuvre"]][row["quantity"]] = float(row["value"])
    return found


def lumped() -> Vehicle:
    """The sedan with all mass in the body, on tyres without relaxation."""
    sedan = vehicle_of("sedan")
    tyre = replace(
        sedan.tyre,
        longitudinal_stiffness=5e6,
        lateral_stiffness=5e6,
        longitudinal_damping_time=1e-3,
        lateral_damping_time=1e-3,
    )
    suspension = replace(sedan.suspension, sprung_mass=sedan.mass, sprung_mass_height=0.0)
    return replace(sedan, tyre=tyre, suspension=suspension)


def cars() -> dict[str, Vehicle]:
    """The car of each model."""
    soft = lumped()
    rigid = replace(
        soft.suspension,
        sprung_mass=0.0,
        roll_inertia=0.0,
        front_roll_damping=0.0,
        rear_roll_damping=0.0,
    )
    front = replace(soft.suspension, front_roll_stiffness=15e3, rear_roll_stiffness=5e3)
    return {
        "soft": soft,
        "front": replace(soft, suspension=front),
        "rigid": replace(soft, suspension=rigid),
        # A single track: no load moves across, and no wheel is aside that turning spins up.
        "11dof": replace(soft, suspension=rigid, load_transfer="longitudinal", wheel_inertia=0.05),
    }


def driven(car: Vehicle, speed: float, angles: np.ndarray):
    """The object at the end, and yaw rate [rad/s] and velocity across the axles [m/s], (n,).

    `angles` (n,) are those of the road wheels at the instants [rad].
    """
    held = plant(car, period=PERIOD, initial_speed=speed, speed="held", load_transfer_lag=2e-3)
    lever = roll_constants(car).lever
    still = command()
    motion = np.zeros((len(angles), 2))
    for n in range(len(angles) - 1):
        rate = (angles[n + 1] - angles[n]) / PERIOD
        held.advance(still, steered(angles[n], rate))
        # The velocity of the centre of mass, which sways over the axles.
        across = held.state[VY] + lever * held.state[ROLL_RATE]
        motion[n + 1] = held.state[YAW_RATE], across
    return held, motion[:, 0], motion[:, 1]


def step(car: Vehicle, speed: float, angle: float) -> dict[str, float]:
    """The quantities of a step of the road-wheel angle [rad]."""
    time = np.arange(4001) * PERIOD
    held, yaw_rate, across = driven(car, speed, angle * np.minimum(time / 0.1, 1.0))
    load = outputs(held)[TireForces].load
    steady = yaw_rate[-1]
    above = int(np.argmax(yaw_rate >= 0.9 * steady))
    around = slice(above - 1, above + 1)
    return {
        "gain": steady / angle,
        "beta": across[-1] / speed,
        "t90": float(np.interp(0.9 * steady, yaw_rate[around], time[around])) - 0.05,
        "dfz_f": (load.front_right - load.front_left) / 2.0,
        "dfz_r": (load.rear_right - load.rear_left) / 2.0,
    }


def gradients(car: Vehicle) -> tuple[dict[str, float], dict[str, float]]:
    """Understeer gradients [rad s^2/m] at `ACCELERATIONS` of a slow ramp.

    The first are ours, the second those of the same run by the slip angle of the other models.
    """
    angles = RAMP_RATE * np.arange(30001) * PERIOD
    _, yaw_rate, across = driven(car, RAMP_SPEED, angles)
    by_their_slip = _steered_by_their_slip(car, angles, yaw_rate, across)
    return _slopes(car, angles, yaw_rate), _slopes(car, by_their_slip, yaw_rate)


def _slopes(car: Vehicle, angles: np.ndarray, yaw_rate: np.ndarray) -> dict[str, float]:
    lateral = RAMP_SPEED * yaw_rate
    excess = angles - car.wheelbase * yaw_rate / RAMP_SPEED
    found = {}
    for name in ACCELERATIONS:
        near = np.abs(lateral - float(name)) < 0.4
        if near.any():
            found[name] = float(np.polyfit(lateral[near], excess[near], 1)[0])
    return found


def _steered_by_their_slip(
    car: Vehicle, angles: np.ndarray, yaw_rate: np.ndarray, across: np.ndarray
) -> np.ndarray:
    """Road-wheel angles [rad] that give the same side forces by the other models' slip angle.

    Theirs is atan(v/(r w + 0.01 m/s)) - delta, of the velocity v across the body and the speed of
    the rim: steering does not turn the velocities. A wheel that rolls without a drive is slower
    than the road by the slip that carries its rolling resistance.
    """
    front_arm = car.wheelbase - car.centre_of_mass_to_rear_axle
    front = across + front_arm * yaw_rate
    rear = across - car.centre_of_mass_to_rear_axle * yaw_rate
    slip_stiffness = car.tyre.front_mf[MF_NAMES.index("pkx1")]
    rolling = 1.0 - car.rolling_resistance / slip_stiffness
    # The same slip angle behind needs another velocity across the car, which front wheels feel too.
    wider = (RAMP_SPEED * rolling + THEIR_CREEP) / RAMP_SPEED
    moved = front + rear * (wider - 1.0)
    along = RAMP_SPEED * np.cos(angles) + front * np.sin(angles)
    slip_angle = np.arctan(front / RAMP_SPEED) - angles
    return np.arctan(moved / (along * rolling + THEIR_CREEP)) - slip_angle


def sine(car: Vehicle, speed: float) -> dict[str, float]:
    """Gains and phases [deg] of the third to fifth period of a sine of the road-wheel angle."""
    time = np.arange(10001) * PERIOD
    _, yaw_rate, across = driven(car, speed, SINE_ANGLE * np.sin(SINE_RATE * time))
    answers = {
        "r": yaw_rate,
        "ay": np.gradient(across, PERIOD) + speed * yaw_rate,
        "beta": across / speed,
    }
    last = slice(4000, 10000)
    phases = SINE_RATE * time[last]
    waves = np.column_stack((np.sin(phases), np.cos(phases), np.ones_like(phases)))
    found = {}
    for name, answer in answers.items():
        with_it, ahead, _ = np.linalg.lstsq(waves, answer[last], rcond=None)[0]
        found[name] = float(np.hypot(with_it, ahead)) / SINE_ANGLE
        found[f"{name}_phase"] = float(np.degrees(np.arctan2(ahead, with_it)))
    return found


def table() -> list[str]:
    """Rows of docs/measured.md: each number of ours, and behind a stroke theirs."""
    theirs = reference()
    rows = []
    for model, car in cars().items():
        for speed in SPEEDS:
            for angle in ANGLES:
                given = theirs[model][f"step {speed:g} {angle:g}"]
                rows.append(
                    _row(model, f"{speed:g} m/s, {angle:g} rad", step(car, speed, angle), given)
                )
    return rows


_FORMATS = {"gain": ".4f", "beta": ".3f", "t90": ".1f", "dfz_f": ".1f", "dfz_r": ".1f"}
_SCALES = {"beta": 1e3, "t90": 1e3}


def _row(model: str, label: str, ours: dict[str, float], theirs: dict[str, float]) -> str:
    cells = [model, label]
    for name, form in _FORMATS.items():
        scale = _SCALES.get(name, 1.0)
        if name in theirs:
            cells.append(f"{scale * ours[name]:{form}} / {scale * theirs[name]:{form}}")
        else:
            cells.append("-")
    return f"| {' | '.join(cells)} |"


def gradient_table() -> list[str]:
    """The same of the understeer gradients [mrad s^2/m], ours by their slip angle in between."""
    theirs = reference()
    rows = []
    for model, car in cars().items():
        ours, by_their_slip = gradients(car)
        cells = [model]
        for name in ACCELERATIONS:
            numbers = (ours[name], by_their_slip[name], theirs[model]["ramp 20"][name])
            cells.append(" / ".join(f"{1e3 * number:.4f}" for number in numbers))
        rows.append(f"| {' | '.join(cells)} |")
    return rows


if __name__ == "__main__":
    print(*table(), "", *gradient_table(), sep="\n")
