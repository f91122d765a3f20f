"""A car that begins on the move: traction control withholds nothing from wheels that roll."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers.traction import METHODS, SPEED_MODE, Control, Measured

import ev_stack
from ev_core.parameters.data_file import files_in_config
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_stack.measures.metric import channel
from ev_stack.scenarios.scenario import Overrides, load_scenario

CARS = sorted(files_in_config("vehicles"))
PERIOD = 0.01
# m/s, torque over weight times radius
STARTS = [(begin, share) for begin in (8.0, 22.0, -8.0) for share in (0.1, 0.2)]


def car(name: str) -> Vehicle:
    """A car of config/vehicles."""
    run = load_scenario("double_lane_change", Overrides(vehicle=name)).runs[0]
    return run.configurations["plant"].common.vehicle


@pytest.mark.sampled
@pytest.mark.parametrize("name", CARS)
def test_nothing_is_withheld_from_wheels_that_roll(name):
    """Forwards from rest, 8 and 22 m/s, and in reverse.

    A tenth of the weight for drive, 0.2 s on a level road.
    """
    vehicle = car(name)
    radius, force = vehicle.wheel_radius, 0.1 * vehicle.mass * 9.81
    torque = force * radius / len(vehicle.driven_wheels)
    for law in (*METHODS, *SPEED_MODE):
        for begin in (0.0, 8.0, 22.0, -8.0):
            ahead = math.copysign(1.0, begin)
            drive = Wheels(
                *(
                    ahead * torque if wheel in vehicle.driven_wheels else 0.0
                    for wheel in WHEEL_NAMES
                )
            )
            control, a_x = Control(law, vehicle, PERIOD), ahead * force / vehicle.mass
            for step in range(20):
                speed = begin + a_x * step * PERIOD
                rolls = Measured(drive, speed=Wheels.all(speed / radius), torque=drive, a_x=a_x)
                if law in SPEED_MODE:
                    control.set_points(rolls)
                    assert control.limits() == [math.inf] * 4, (law, begin, step)
                else:
                    assert control.step(rolls) == drive, (law, begin, step)


@pytest.mark.slow
@pytest.mark.parametrize("name", METHODS)
@pytest.mark.sampled
def test_nothing_is_withheld_on_a_dry_road_without_slip(name):
    """Cars at 8 and 22 m/s and in reverse, pedal at once to a tenth and a fifth of the weight.

    Torque comes before force: the carcass winds up and the wheel runs ahead, which
    `acceleration_ratio` took for slip. Without slip is below 0.05, where dry asphalt still carries
    more than half of the load.
    """
    seen = 0
    for vehicle in CARS:
        asked, given_, slip = starts(vehicle, name)
        grips = slip < 0.05
        assert (asked[grips] == given_[grips]).all(), vehicle
        seen += grips.sum()
    assert seen > 5 * len(CARS)


def starts(vehicle: str, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Requests and commands of all wheels [N m] in 0.5 s of six starts, and their largest slips."""
    of = car(vehicle)
    lever = of.mass * 9.81 * of.wheel_radius
    pedals = [[share * lever * math.copysign(1.0, begin)] for begin, share in STARTS]
    topics = ("torque_request.drive", "torque_command.drive", "tire_forces.slip_ratio")
    found = ev_stack.batch(
        "launch_split_mu",
        {
            "plant.initial_speed": [begin for begin, _ in STARTS],
            "driver.pedals.drive_torque": pedals,
        },
        run="fixed_steering",
        signals=[f"{topic}.{wheel}" for topic in topics for wheel in of.driven_wheels],
        vehicle=vehicle,
        method={"asr": name},
        set={
            "*.control_period": 0.005,
            "plant.road.left": ["dry_asphalt"],
            "driver.pedals.time": [0.0],
            "driver.pedals.drive_torque": [0.0],
            "driver.pedals.brake_torque": [0.0],
        },
        duration=0.5,
    )
    asked, given_, slip = (
        np.stack([found.signals[f"{of_}.{w}"] for w in of.driven_wheels], axis=1) for of_ in topics
    )
    return asked, given_, abs(slip).max(axis=(1, 2))


@pytest.mark.slow
def test_a_car_with_four_driven_wheels_drives_from_the_first_instant():
    """All of the torque is there in a lane change at 80 km/h.

    An observer from 0 m/s takes 4 s to let it pass.
    """
    run = ev_stack.run(
        "double_lane_change", vehicle="layout_1_8_c", method={"asr": "pi_slip"}, duration=1.0
    )
    for of in run.runs.values():
        for wheel in WHEEL_NAMES:
            asked, given = (
                channel(of, f"{topic}.drive.{wheel}")
                for topic in ("torque_request", "torque_command")
            )
            assert (asked == given).all()
            assert abs(asked).max() > 0.0
