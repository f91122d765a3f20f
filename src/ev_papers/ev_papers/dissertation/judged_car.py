"""Car, drive and road of the dissertation (chapters 1 and 2) as they are judged: what is printed, and what follows.

Each public function measures one number of published.csv.
"""

from __future__ import annotations

import math

import numpy as np

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.driveline import wheel_inertia
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.surfaces import SURFACES, RoadParameters, left_and_right
from ev_study.verdicts.need import ScenarioRuns

_FRICTION = 0.8
_CELL = 3.2  # [V], which is assumed: no voltage is printed
_SEEDS = range(1, 11)
_CYCLE = 4402.6  # length [m]


def mass_of_car(driven: ScenarioRuns, radius: float) -> float:
    """Mass that four driven wheels of a radius [m] move at the limit of grip, M/(phi g r) each, rounded up [kg]."""
    per_wheel = driven.vehicle.motor.peak_torque * (1.0 / (_FRICTION * GRAVITY * radius))
    return 4.0 * math.ceil(per_wheel)


def is_front_driven(driven: ScenarioRuns) -> bool:
    """Whether the front wheels are driven and no others."""
    return driven.vehicle.driven_wheels == WHEEL_NAMES[:2]


def rolls_below(driven: ScenarioRuns, threshold: float) -> bool:
    """Whether a_x/w' of a rolling wheel, its radius, is below a threshold [m]."""
    return driven.vehicle.wheel_radius < threshold


def beyond_the_form(driven: ScenarioRuns) -> float:
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


def coefficient(surface: str, name: str) -> float:
    """Burckhardt coefficient c1, c2 or c3 of a surface [1]."""
    return getattr(SURFACES[surface], name)


def resistance(surface: str, end: str) -> float:
    """The least or the largest f_surface [1]."""
    return SURFACES[surface].rolling_resistance_range[0 if end == "least" else 1]


def slip_of_peak(surface: str) -> float:
    """Slip of the largest friction [1], from eq 2.15."""
    of = SURFACES[surface]
    return math.log(of.c1 * of.c2 / of.c3) / of.c2


def peak_friction(surface: str) -> float:
    """The largest friction of a surface [1]."""
    return SURFACES[surface].peak_friction


def share_of_snow(driven: ScenarioRuns, side: str) -> float:
    """Mean share of the length of one side over ten roads, as far as the cycle is long [1]."""
    road = {
        key: value for key, value in driven.parameters["plant"].items() if key.startswith("road.")
    }
    given = {key.removeprefix("road."): value for key, value in road.items()}
    shares = []
    for seed in _SEEDS:
        segments = left_and_right(RoadParameters(**{**given, "seed": seed}))[
            ("left", "right").index(side)
        ]
        edges = np.clip([*segments.start, math.inf], 0.0, _CYCLE)
        snow = [name.startswith("packed_snow") for name in segments.surface]
        shares.append(float(np.diff(edges)[snow].sum()) / _CYCLE)
    return sum(shares) / len(shares)


def largest_efficiency(end: str, f_0: float) -> float:
    """Largest eq 2.37 of a wheel on wet asphalt 1 for 40 % of the time and on packed snow 1 for the rest [1].

    Both slips are free and the wheel is in equilibrium, M/(F r) = phi(S) + f; `end` of the range of table 2.2 is the
    least or its middle.
    """
    slips = np.linspace(0.002, 0.3, 300)
    torque, useful, speed = 0.0, 0.0, 0.0
    for share, name, axis in (
        (0.4, "wet_asphalt_1", (slice(None), None)),
        (0.6, "packed_snow_1", (None, slice(None))),
    ):
        of = SURFACES[name]
        rolling = f_0 + (
            of.rolling_resistance if end == "middle" else of.rolling_resistance_range[0]
        )
        use = of.c1 * (1.0 - np.exp(-of.c2 * slips)) - of.c3 * slips
        useful = useful + share * use[axis]
        torque = torque + share * (use + rolling)[axis]
        speed = speed + share * (1.0 / (1.0 - slips))[axis]
    return float((useful / torque / speed).max())
