"""Allocation of least loss against brute force, closed forms, and its demands."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers.differentials import DISSERTATION, LOADS, on
from scipy.optimize import brute

from ev_control.shared.allocation import Range
from ev_control.torque_vectoring.known_motion import KnownMotion
from ev_control.torque_vectoring.least_loss import front_torque, least_loss, side_loss
from ev_control.torque_vectoring.weighted_least_squares import LeastSquaresParameters, least_squares
from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import Driveline
from ev_core.vehicle.losses import NO_MAP, EfficiencyMap
from ev_msgs_py.contract.signals import InertialMeasurement
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels

FOUR = on(DISSERTATION, WHEEL_NAMES)
CAR = namespace(car_numbers(FOUR))
P = LeastSquaresParameters()
SPEED = 60.0  # rad/s of the wheel, 444 of the shaft
FAR = Range(-2000.0, 2000.0)


def unequal(**of_driveline: float) -> Vehicle:
    return replace(FOUR, driveline=Driveline(**of_driveline))


def idling(idle: float, copper: float) -> EfficiencyMap:
    """A map of P_0 + k T^2, saved altogether by a motor without torque."""
    speed, torque = (100.0, 1000.0), tuple(np.linspace(1.0, 360.0, 360).tolist())
    rows = [[t * w / (t * w + idle + copper * t * t) for t in torque] for w in speed]
    return EfficiencyMap(speed, torque, tuple(rows[0] + rows[1]))


def lost(front: float | np.ndarray, car: Any, table: EfficiencyMap, both: float) -> float:
    """Loss of a side [W]; the search of scipy gives its torque as an array of one number."""
    return side_loss(car, table, SPEED, float(np.ravel(front)[0]), both)


def test_it_finds_what_brute_force_finds():
    """Maps with random efficiencies, bounds, motors and torques, driving and generating.

    At most 0.2 % more loss.

    Brute force has 2000 points; between those of the first round such a map may hide a dent.
    """
    random = np.random.default_rng(3)
    for _ in range(40):
        car = namespace(
            car_numbers(
                unequal(front_size=random.choice([1.0, 2.0]), rear_gear=random.uniform(0.5, 2.0))
            )
        )
        table = EfficiencyMap(
            (50.0, 300.0, 900.0),
            (10.0, 80.0, 200.0, 360.0),
            tuple(random.uniform(0.6, 0.95, 12).tolist()),
        )
        front, rear = (
            Range(-random.uniform(0.0, 2000.0), random.uniform(0.0, 2000.0)) for _ in range(2)
        )
        both = random.uniform(front.least + rear.least, front.most + rear.most)
        found = front_torque(car, table, SPEED, both, front, rear)
        low, high = max(front.least, both - rear.most), min(front.most, both - rear.least)
        assert low <= found <= high
        best = brute(lost, [(low, high)], (car, table, both), Ns=2000, finish=None)
        assert lost(found, car, table, both) <= 1.002 * lost(best, car, table, both)


@pytest.mark.parametrize("both", [700.0, -500.0])
@pytest.mark.parametrize(
    ("of_driveline", "front"),
    [({}, 1 / 2), ({"front_size": 2.0}, 2 / 3), ({"rear_gear": 2.0}, 1 / 5)],
)
def test_by_the_loss_model_torques_are_as_the_squares_of_gear_and_number_allow(
    of_driveline, front, both
):
    """Copper loss alone, sum k T^2/(n i^2): shares as n i^2.

    To the width of the last round, 4000 N m/16384.
    """
    copper = replace(FOUR.motor, inverter_torque_loss=0.0)
    car = namespace(car_numbers(replace(unequal(**of_driveline), motor=copper)))
    found = front_torque(car, NO_MAP, SPEED, both, FAR, FAR)
    assert found == pytest.approx(front * both, abs=0.25)


def test_one_motor_drives_alone_up_to_the_switching_torque():
    """P_0 + k T^2 < 2 P_0 + k T^2/2 up to T = sqrt(2 P_0/k), 141 N m at the shaft.

    Then both do the same.

    5 % beside it the choice is clear in spite of the map's steps of 1 N m.
    """
    table, switching = idling(500.0, 0.05), 7.4 * (2.0 * 500.0 / 0.05) ** 0.5
    low, high = 0.95 * switching, 1.05 * switching
    alone = front_torque(CAR, table, SPEED, low, FAR, FAR)
    assert min(abs(alone), abs(low - alone)) < 0.01 * low
    assert front_torque(CAR, table, SPEED, high, FAR, FAR) == pytest.approx(high / 2.0, rel=0.01)


def known(friction: float, speed: Wheels, side: float = 0.0) -> KnownMotion:
    grip = Wheels(*(friction * load for load in LOADS))
    return KnownMotion(
        20.0, 0.0, 0.0, grip, Wheels.all(side), 0.0, speed, InertialMeasurement(0.0, 0.0, 0.0)
    )


@pytest.mark.parametrize("friction", [0.9, 0.2])
@pytest.mark.parametrize("table", [NO_MAP, idling(500.0, 0.05)], ids=["model", "map"])
def test_each_side_keeps_its_torque_within_motors_and_friction(friction, table):
    """Sum and moment are those of least squares, also on snow in a bend, where neither holds."""
    motion = known(friction, Wheels.all(SPEED), 0.1 * friction * LOADS.front_left)
    most = 0.95 * friction * LOADS.front_left * CAR.wheel_radius + 1e-9
    for total, moment in ((0.0, 0.0), (900.0, 800.0), (-1500.0, 2000.0), (3000.0, -6000.0)):
        wanted = least_squares(P, CAR, motion, total, moment)
        found = least_loss(P, CAR, table, motion, total, moment)
        assert (found[0] + found[2], found[1] + found[3]) == pytest.approx(
            (wanted[0] + wanted[2], wanted[1] + wanted[3]), abs=1e-9
        )
        assert max(abs(torque) for torque in found) <= most
        if friction == 0.9 and total == 900.0:
            assert sum(found) == pytest.approx(total, abs=1.0)  # 1/weight of all grip is left
    assert found != NO_WHEELS


def test_a_mirrored_demand_is_given_mirrored_torques_to_the_bit():
    speed, table = Wheels(60.0, 62.0, 61.0, 63.0), idling(500.0, 0.05)
    left = least_loss(P, CAR, table, known(0.5, speed), 700.0, 500.0)
    right = least_loss(P, CAR, table, known(0.5, Wheels(62.0, 60.0, 63.0, 61.0)), 700.0, -500.0)
    assert left == (right[1], right[0], right[3], right[2])
