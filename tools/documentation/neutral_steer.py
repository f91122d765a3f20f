"""The neutral-steer table and the Bode plot of docs/zhileykin2018.md: the linear model beside the plant."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from documentation.markdown import table
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import Wheels
from ev_stack.scenarios.files import vehicle_of
from ev_study.analysis.__main__ import drive_torques
from ev_study.analysis.linear_models import side_slip_model
from ev_study.analysis.linearised_plant import OperatingPoint, linearised

COLUMNS = (
    "front share h",
    "W₁₂",
    "linear tyres, no resistances",
    "tyres on ice, centre of mass on the road",
    "the car",
)
SPEED, FORCE = 8.0, 2000.0  # [m/s], [N]
SHARES = (0.0, 0.2, 0.3, 0.48, 0.5)  # of the front axle [1]


def neutral_steer_table() -> str:
    """Steady (d2 - d1)/Theta by the front share [1], of W12 and of the plant with less and less left out."""
    car = vehicle_of("zhileykin_4x4")
    on_the_road = dataclasses.replace(car, centre_of_mass_height=0.0)
    rows = [
        (
            f"{share:g}",
            *(
                f"{round(value, 4) + 0.0:.4f}".replace("-", "−")
                for value in _row(car, on_the_road, share)
            ),
        )
        for share in SHARES
    ]
    return table(COLUMNS, rows)


def _row(car: Vehicle, on_the_road: Vehicle, share: float) -> tuple[float, ...]:
    model = side_slip_model(car, SPEED, FORCE / car.mass, FORCE, share)
    plants = (_steady(each, share) for each in (without_losses(car), on_the_road, car))
    return (model.excitation / model.damping, *plants)


def without_losses(car: Vehicle) -> Vehicle:
    """The car that W12 is written for: linear tyres of the same stiffness, no carcass, no resistances, low mass."""
    stiffness = side_slip_model(car, SPEED, 0.0, 0.0, 0.0).axle_cornering_stiffness / 2
    tyre = dataclasses.replace(
        car.tyre,
        curve="linear",
        coefficients=(20.0, 0.0, 0.0, 0.0),
        combined="uncoupled",
        lateral_curve="linear",
        front_cornering_stiffness=stiffness,
        rear_cornering_stiffness=stiffness,
        lateral_stiffness=1e7,
        lateral_damping_time=1e-3,
    )
    return dataclasses.replace(
        car,
        tyre=tyre,
        centre_of_mass_height=0.0,
        rolling_resistance=0.0,
        drag_coefficient=0.0,
        wheel_inertia=0.1,
        steering_geometry="parallel",
    )


def _steady(car: Vehicle, share: float) -> float:
    half = FORCE * car.wheel_radius / 2
    drive = Wheels(half * share, half * share, half * (1 - share), half * (1 - share))
    plant = linearised(car, OperatingPoint(SPEED, drive=drive, accelerates=True))
    return float(plant.slip_angle_difference(np.array([0.0]))[0].real)


def save_bode_plot(folder: Path) -> None:
    """Bode plot of the car at the drive force of the table, equal torques, speed held."""
    from documentation.images import save_small
    from ev_study.analysis.linearised_plant import bode_figure

    car = vehicle_of("zhileykin_4x4")
    plant = linearised(car, OperatingPoint(SPEED, drive=drive_torques(car, FORCE)))
    model = side_slip_model(car, SPEED, plant.acceleration, FORCE, 0.5)
    save_small({"zhileykin2018_bode": bode_figure(model, plant)}, folder)
