"""Chapter 1 of the dissertation: sizing of a drive, lock coefficients, thresholds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.drive_train import wheel_inertia
from ev_papers.dissertation.runs import MODEL, PART, of_car, parameter
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel, run_named
from ev_sim.verdicts.check import Number, absolute, holds, relative
from ev_sim.verdicts.declaration import Declaration, judged, no_verdict
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

RATIO = ScenarioNeed("urban_mixed", (("asr", "method", "acceleration_ratio"),), duration=1.0)
WINDOW = ScenarioNeed("urban_mixed", (("asr", "method", "slip_window"),), duration=1.0)
_SMALL, _LARGE = 0.25, 0.4  # radii of wheels [m]
_FRICTION = 0.8
_SPEED = relative(0.001, "785 for 785.4 rad/s")
_MASS = absolute(1.0, "whole kilograms are printed")


def _mass(radius: float, gear: float = 1.0) -> float:
    """What one driven wheel can move at the limit of grip, M/(phi g r) [kg]."""
    return gear / (_FRICTION * GRAVITY * radius)


def _per_wheel(radius: float) -> Number:
    return Number(
        "kg",
        {_SMALL: 184.0, _LARGE: 115.0}[radius],
        _MASS,
        of_car(lambda car: car.motor.peak_torque * _mass(radius)),
        f"per wheel of {radius:g} m",
    )


def _of_car(radius: float) -> Number:
    def mass(car: Vehicle) -> float:
        return 4.0 * math.ceil(car.motor.peak_torque * _mass(radius))

    return Number("kg", {_SMALL: 736.0, _LARGE: 460.0}[radius], _MASS, of_car(mass), f"car with wheels of {radius:g} m")


def _beyond_the_form(driven: ScenarioRuns) -> float:
    """Largest difference of (J/(a M r) + 1) r F_d from J w' + r F_d, over the latter [1]."""
    car = driven.vehicle
    inertia, radius, mass = wheel_inertia(car, car.driven_wheels[0]), car.wheel_radius, car.mass / 2
    worst = 0.0
    for acceleration in (0.5, 1.0, 4.0):  # a_x [m/s^2]
        for ratio in (0.05, 0.1, 0.3):  # a = a_x/w' [m]
            force = mass * acceleration
            printed = (inertia / (ratio * mass * radius) + 1.0) * radius * force
            expected = inertia * acceleration / ratio + radius * force
            worst = max(worst, abs(printed - expected) / expected)
    return worst


def _largest_ratio(driven: ScenarioRuns) -> float:
    """Largest ratio of the torques that are asked for at the front wheels, slower over faster [1]."""
    run = run_named(driven.runs, "urban_mixed")
    left, right = (channel(run, f"torque_request.drive.front_{side}") for side in ("left", "right"))
    driving = (left > 1.0) & (right > 1.0)
    if not driving.any():
        raise NotMeasured("the car was not driven")
    return float(np.maximum(left[driving] / right[driving], right[driving] / left[driving]).max())


def _locked(name: str, differential: str, ratio: float) -> tuple[ScenarioNeed, Number]:
    values = (("electronic_differential", "method", differential), ("asr", "method", "off"))
    if differential == "limited_slip":
        values = (*values, _SHARP, ("electronic_differential", "locking_ratio", ratio))
    need = replace(PART, values=(*PART.values, *values), duration=30.0)
    place = len(_DIFFERENTIALS)
    why = "the law is smooth in the difference of speeds, which ends where the wheels do"
    measure = lambda *driven: _largest_ratio(driven[place])  # noqa: E731
    return need, Number("1", ratio, relative(0.01, why), measure, name)


_SHARP = ("electronic_differential", "locking_speed", 0.1)  # [rad/s]
_DIFFERENTIALS: list[tuple[ScenarioNeed, Number]] = []
for _name, _law, _ratio in (
    ("free", "open_differential", 1.0),
    ("Torsen 3, DCCD, at most", "limited_slip", 1.9),
    ("Torsen 2, at most", "limited_slip", 3.0),
    ("Torsen 1, at most", "limited_slip", 5.0),
):
    _DIFFERENTIALS.append(_locked(_name, _law, _ratio))


DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.sizing.speed",
        MODEL,
        Number("m/s", 196.25, _SPEED, of_car(lambda car: car.motor.maximum_speed * _SMALL), "wheels of 0.25 m"),
        Number("m/s", 314.0, _SPEED, of_car(lambda car: car.motor.maximum_speed * _LARGE), "wheels of 0.4 m"),
    ),
    judged(
        "diss.sizing.mass",
        MODEL,
        _per_wheel(_SMALL),
        _per_wheel(_LARGE),
        _of_car(_SMALL),
        _of_car(_LARGE),
        Number(
            "kg",
            2200.0,
            relative(0.01, "printed as about"),
            of_car(lambda car: 4.0 * car.motor.peak_torque * _mass(_SMALL, 3.0)),
            "car with a gear of 3",
        ),
        assumption="four driven wheels, whose mass is rounded up first",
    ),
    no_verdict(
        "diss.t1.2", "a classification in words; no mass, power or torque is given by which a category would follow"
    ),
    judged(
        "diss.K",
        tuple(need for need, _ in _DIFFERENTIALS),
        *(number for _, number in _DIFFERENTIALS),
        assumption="Torsen and DCCD as limited_slip with their K; their least K are left out",
    ),
    judged(
        "diss.eq1.4",
        RATIO,
        Number(
            "m",
            0.4,
            relative(0.0, "exact; above r = 0.32 m it holds for every wheel, so half of r is the default here"),
            parameter("asr", "threshold"),
        ),
    ),
    judged(
        "diss.eq1.5",
        WINDOW,
        Number("1", 0.15, relative(0.0, "exact"), parameter("asr", "low"), "low"),
        Number("1", 0.19, relative(0.0, "exact"), parameter("asr", "high"), "high"),
        inputs="they are the defaults of slip_window; printed 0.15 > S > 0.19, read 0.15..0.19 as in section 2.4",
    ),
    judged(
        "diss.eq1.4.literal",
        MODEL,
        Number("m", 0.320, relative(0.0, "exact"), of_car(lambda car: car.wheel_radius)),
        holds(lambda driven: driven.vehicle.wheel_radius < 0.4, "always below 0.4 m, never above", "below 0.4 m"),
        inputs="a_x/w' of a rolling wheel is its radius",
    ),
    judged("diss.eq1.7.form", MODEL, Number("1", 0.0, absolute(1e-9, "algebra"), _beyond_the_form)),
)
