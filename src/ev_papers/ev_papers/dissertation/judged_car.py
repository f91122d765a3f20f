"""Car, drive and road of the dissertation (chapters 1 and 2) as they are judged.

Each public function measures one number of published.csv: what is printed, or follows from it.
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
_SEEDS = range(1, 11)
_CYCLE = 4402.6  # length [m]
_ACCELERATIONS = (0.5, 1.0, 4.0)  # a_x, at which eq 1.7 is compared [m/s^2]
_RATIOS = (0.05, 0.1, 0.3)  # a = a_x/w', the same [m]


def mass_of_car(driven: ScenarioRuns, radius: float) -> float:
    """Mass that four driven wheels move at the limit of grip, M/(phi g r) each, rounded up [kg]."""
    per_wheel = driven.vehicle.motor.peak_torque * (1.0 / (_FRICTION * GRAVITY * radius))
    return 4.0 * math.ceil(per_wheel)


def is_front_driven(driven: ScenarioRuns) -> bool:
    """True if the front wheels are driven and no others."""
    return driven.vehicle.driven_wheels == WHEEL_NAMES[:2]


def rolls_below(driven: ScenarioRuns, threshold: float) -> bool:
    """True if a_x/w' of a rolling wheel, its radius, is below a threshold [m]."""
    return driven.vehicle.wheel_radius < threshold


def beyond_the_form(driven: ScenarioRuns) -> float:
    """Largest difference of (J/(a M r) + 1) r F_d from J w' + r F_d, over the latter [1]."""
    car = driven.vehicle
    inertia = wheel_inertia(car, car.driven_wheels[0])
    radius = car.wheel_radius
    mass = car.mass / 2
    worst = 0.0
    for acceleration in _ACCELERATIONS:
        force = mass * acceleration
        for ratio in _RATIOS:
            printed = (inertia / (ratio * mass * radius) + 1.0) * radius * force
            expected = inertia * acceleration / ratio + radius * force
            worst = max(worst, abs(printed - expected) / expected)
    return worst


def coefficient(surface: str, name: str) -> float:
    """Burckhardt coefficient c1, c2 or c3 of a surface [1]."""
    return getattr(SURFACES[surface], name)


def resistance(surface: str, end: str) -> float:
    """Least or largest f_surface [1]."""
    least, largest = SURFACES[surface].rolling_resistance_range
    return least if end == "least" else largest


def slip_of_peak(surface: str) -> float:
    """Slip of the largest friction, from eq 2.15 [1]."""
    of = SURFACES[surface]
    return math.log(of.c1 * of.c2 / of.c3) / of.c2


def peak_friction(surface: str) -> float:
    """Largest friction of a surface [1]."""
    return SURFACES[surface].peak_friction


def share_of_snow(driven: ScenarioRuns, side: str) -> float:
    """Mean share of snow on one side over ten roads, as far as the cycle is long [1]."""
    given = {}
    for name, value in driven.parameters["plant"].items():
        if name.startswith("road."):
            given[name.removeprefix("road.")] = value
    shares = []
    for seed in _SEEDS:
        left, right = left_and_right(RoadParameters(**{**given, "seed": seed}))
        segments = left if side == "left" else right
        # The last segment has no end of its own.
        edges = np.clip([*segments.start, math.inf], 0.0, _CYCLE)
        snow = [name.startswith("packed_snow") for name in segments.surface]
        shares.append(float(np.diff(edges)[snow].sum()) / _CYCLE)
    return sum(shares) / len(shares)


def largest_efficiency(end: str, f_0: float) -> float:
    """Largest eq 2.37 on wet asphalt 1 for 40 % of the time and packed snow 1 for the rest [1].

    Both slips are free and the wheel is in equilibrium, M/(F r) = phi(S) + f; `end` of the range of
    table 2.2 is the least or its middle.
    """
    slips = np.linspace(0.002, 0.3, 300)
    # Every slip on asphalt meets every slip on snow: one along each axis.
    on_asphalt = (0.4, "wet_asphalt_1", slips[:, None])
    on_snow = (0.6, "packed_snow_1", slips[None, :])
    torque, useful, speed = 0.0, 0.0, 0.0
    for share, name, slip in (on_asphalt, on_snow):
        of = SURFACES[name]
        resistance = of.rolling_resistance if end == "middle" else of.rolling_resistance_range[0]
        use = of.c1 * (1.0 - np.exp(-of.c2 * slip)) - of.c3 * slip
        useful = useful + share * use
        torque = torque + share * (use + (f_0 + resistance))
        speed = speed + share * (1.0 / (1.0 - slip))
    return float((useful / torque / speed).max())
