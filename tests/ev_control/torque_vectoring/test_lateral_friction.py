"""Friction of the road from side forces.

On the planar plant on snow and asphalt, and on a car of linear tyres.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from helpers.differentials import GRAVITY

import ev_stack
from ev_control.estimation.plausible import Sensors
from ev_control.shared.torque_split import KnownBy
from ev_control.torque_vectoring.known_motion import (
    CarSeen,
    KnownMotionParameters,
    known_motion,
    unknown_motion,
)
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
    WheelStates,
)
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_sim.understeer import axle_cornering_stiffnesses
from ev_stack.report.result import Result

READS = (
    DriverCommand,
    SteeringColumnState,
    WheelStates,
    InertialMeasurement,
    BodyVelocity,
    TireForces,
)
PERIOD = 0.01
FRICTION = {"packed_snow_1": 0.402, "dry_asphalt": 0.891}  # of layout_1_8_c there
UNKNOWN = pytest.approx(1.2, rel=1e-9)


@cache
def driven(scenario: str, run: str, scale: float, road: str) -> Result:
    """The planar plant without any yaw moment."""
    values: dict[str, Any] = {f"plant.road.{side}": [road] for side in ("left", "right")}
    values["steering_column.scale"] = scale
    return ev_stack.run(scenario, [run], vehicle="layout_1_8_c", duration=3.5, set=values)


def estimated(
    result: Result, stiffer: float = 1.0, brakes: float = 0.0, first: float = 1.2
) -> Iterator[Any]:
    """Grip over load in each step, as the law believes and as the side forces show.

    That begins at `first`, and rises by itself only from 1.2.
    """
    vehicle = result.scenario.runs[0].configurations["plant"].common.vehicle
    parameters = KnownMotionParameters()
    p, car = namespace(number_tree(parameters)), namespace(car_numbers(vehicle))
    front, rear = axle_cornering_stiffnesses(vehicle)
    p.observer.front_cornering_stiffness, p.observer.rear_cornering_stiffness = (
        stiffer * front,
        stiffer * rear,
    )
    state = unknown_motion(parameters)
    state.lateral.friction, p.friction.rise = first, p.friction.rise if first == 1.2 else 0.0
    for n in range(len(result.time)):
        driver, column, wheels, imu, body, tires = (
            signal_at(result.signals, kind, n) for kind in READS
        )
        driver = driver._replace(brake_torque=brakes)
        seen = CarSeen(driver, Sensors(column, wheels, imu), body, tires)
        grip = known_motion(p, car, state, PERIOD, KnownBy.ESTIMATED, seen).grip
        yield (
            ((grip[0] + grip[1]) + (grip[2] + grip[3])) / (vehicle.mass * GRAVITY),
            state.lateral.friction,
        )


def believed(result: Result, stiffer: float = 1.0, brakes: float = 0.0) -> np.ndarray:
    return np.array([grip for grip, _ in estimated(result, stiffer, brakes)])


def signal_at(signals: Mapping[str, np.ndarray], kind: type, n: int) -> Any:
    place = TOPICS[kind].name.replace("/", ".")

    def value(field: str) -> Any:
        name = f"{place}.{field}"
        if name in signals:
            return float(signals[name][n])
        return Wheels(*(float(signals[f"{name}.{wheel}"][n]) for wheel in WHEEL_NAMES))

    return kind(*(value(field) for field in kind._fields))


@pytest.mark.parametrize("road", FRICTION)
@pytest.mark.parametrize("stiffer", [0.8, 1.25])
def test_in_a_bend_at_the_limit_the_road_shows(road: str, stiffer: float):
    """A step of the steering that asks for 12 m/s^2: at its end mu is known to a fifth.

    Cornering stiffnesses that are a quarter off move the limit at which an axle slides to 0.8 of
    its friction at least.
    """
    friction = believed(driven("step_steer", "left", 3.0, road), stiffer)
    assert friction[150] == UNKNOWN  # straight ahead nothing is known
    assert friction.min() > 0.8 * FRICTION[road]
    if road == "packed_snow_1" or stiffer > 1.0:
        assert friction[-1] == pytest.approx(FRICTION[road], rel=0.2)


def test_on_snow_it_is_known_before_the_car_spins_and_dry_asphalt_never_passes_for_it():
    """The car has 0.15 rad of sideslip in a sine with dwell at 2.9 s on snow.

    Most of it is to come.
    """
    snow, dry = (
        driven("sine_with_dwell", "times_3_5", 1.0, road)
        for road in ("packed_snow_1", "dry_asphalt")
    )
    sideslip = np.abs(np.arctan2(snow.signals["twist.lateral"], snow.signals["twist.longitudinal"]))
    lost = int(np.argmax(sideslip > 0.15))
    assert lost > 0
    assert np.argmax(believed(snow) < 0.5) < lost - 100  # a second before
    assert believed(dry).min() > 0.75


def test_a_mirrored_bend_shows_the_same_road_to_the_bit():
    left, right = (
        believed(driven("step_steer", run, 3.0, "packed_snow_1")) for run in ("left", "right")
    )
    assert left.min() < 0.5
    assert (left == right).all()


def test_below_the_limit_nothing_is_known():
    """4 m/s^2 on dry asphalt, less than half of what it holds: the first belief stays."""
    assert believed(driven("step_steer", "left", 1.0, "dry_asphalt")).min() == UNKNOWN


def test_while_the_driver_brakes_nothing_is_learnt():
    assert (
        believed(driven("step_steer", "left", 3.0, "packed_snow_1"), brakes=100.0).min() == UNKNOWN
    )


def test_wheels_that_spin_up_show_no_friction_that_is_not_there():
    """2880 N m at the rear wheels on snow at 8 m/s: of 0.3 no more is made than the road has.

    Their torque over their load is 1.3; the road takes less than half of it, the rest turns the
    wheels faster.
    """
    values: dict[str, Any] = {f"plant.road.{side}": ["packed_snow_1"] for side in ("left", "right")}
    values |= {"*.vehicle.driven_wheels": ["rear_left", "rear_right"], "plant.initial_speed": 8.0}
    values |= {
        "driver.pedals.drive_torque": [0.0, 0.0, 3000.0],
        "driver.pedals.brake_torque": [0.0, 0.0, 0.0],
    }
    result = ev_stack.run(
        "launch_split_mu", ["steered"], vehicle="compact_ev", duration=2.0, set=values
    )
    road = result.signals["tire_forces.friction_coefficient.rear_left"].max()
    assert max(result.signals["tire_forces.slip_ratio.rear_left"]) > 0.5
    shown = [lateral for _, lateral in estimated(result, first=0.3)]
    assert 0.3 < max(shown) < road
