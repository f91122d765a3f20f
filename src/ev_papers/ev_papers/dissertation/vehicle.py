"""The car of the dissertation: tables 1.1 and 2.1, k_f, the battery."""

from __future__ import annotations

import math
from collections.abc import Callable

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_papers.dissertation.assumptions import BATTERY
from ev_papers.dissertation.runs import MODEL, of_car
from ev_sim.verdicts.check import Number, Shown, absolute, between, holds, relative
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns

_GIVEN = "the vehicle file has what is printed"
_EXACT = relative(1e-12, "exact, but for rounding of units")


def _printed(name: str, unit: str, value: float, measure: Callable[[Vehicle], float]) -> Number:
    return Number(unit, value, _EXACT, of_car(measure), name)


def _is_front_driven(driven: ScenarioRuns) -> bool:
    return driven.vehicle.driven_wheels == WHEEL_NAMES[:2]


DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.t1.1",
        MODEL,
        _printed("peak torque", "N m", 360.0, lambda car: car.motor.peak_torque),
        _printed("nominal torque", "N m", 250.0, lambda car: car.motor.nominal_torque),
        _printed("peak power", "kW", 150.0, lambda car: car.motor.peak_power / 1e3),
        Number(
            "kW",
            85.0,
            between(85.0, math.inf, "printed as more than this"),
            of_car(lambda car: car.motor.generator_power / 1e3),
            "nominal power, as generator",
        ),
        Number(
            "rpm",
            7500.0,
            relative(1e-6, "six digits of rad/s"),
            of_car(lambda car: car.motor.maximum_speed * 30.0 / math.pi),
            "largest speed",
        ),
        inputs=f"{_GIVEN}; the mass of a motor is no parameter",
    ),
    judged(
        "diss.nominal_conflict",
        MODEL,
        _printed("", "N m", 250.0, lambda car: car.motor.nominal_torque),
        inputs="chosen: table 1.1, 250 N m and 24 kg; only the error F of the fit hangs on it",
    ),
    judged(
        "diss.t2.1",
        MODEL,
        holds(_is_front_driven, "exact", "front driven"),
        _printed("mass", "kg", 2170.0, lambda car: car.mass),
        _printed("load in front", "1", 0.51, lambda car: car.centre_of_mass_to_rear_axle / car.wheelbase),
        _printed("J_z", "kg m^2", 5017.5, lambda car: car.yaw_inertia),
        _printed("wheelbase", "m", 2.699, lambda car: car.wheelbase),
        _printed("front track", "m", 1.544, lambda car: car.front_track),
        _printed("rear track", "m", 1.551, lambda car: car.rear_track),
        _printed("frontal area", "m^2", 2.222, lambda car: car.frontal_area),
        _printed("c_x", "1", 0.26, lambda car: car.drag_coefficient),
        _printed("density of air", "kg/m^3", 1.24, lambda car: car.air_density),
        _printed("gear ratio", "1", 7.4, lambda car: car.gear_ratio),
        _printed("wheel radius", "m", 0.320, lambda car: car.wheel_radius),
        _printed("wheel inertia", "kg m^2", 1.658, lambda car: car.wheel_inertia),
        inputs=_GIVEN,
    ),
    judged(
        "diss.kf",
        MODEL,
        Number("1", 4.5e-5, between(4e-5, 5e-5, "the printed range"), of_car(lambda car: car.rolling_resistance_speed)),
        Shown("s^2/m^2", of_car(lambda car: car.rolling_resistance_growth), "as added to f"),
        inputs="the vehicle file has its middle, read relative to f_0 with V in km/h (rolling_resistance_reading)",
    ),
    judged(
        "diss.bench.battery",
        MODEL,
        _printed("capacity", "A h", 60.0, lambda car: car.battery.capacity),
        Number(
            "1",
            206.0,
            absolute(1e-9, "exact"),
            of_car(lambda car: min(car.battery.open_circuit_voltage) / 3.2),
            "cells in series",
        ),
        Number(
            "1",
            206.0,
            absolute(1e-9, "exact"),
            of_car(lambda car: car.battery.cells.in_series),
            "cells in series of planar_electrical",
        ),
        inputs=f"{_GIVEN}; {BATTERY} (assumption: no voltage is printed)",
    ),
)
