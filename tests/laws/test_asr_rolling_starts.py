"""A car that begins on the move: traction control withholds nothing from wheels that roll."""

from __future__ import annotations

import math

import pytest
from traction import METHODS, SPEED_MODE, Control, Measured

import ev_sim
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.parameters.config_folders import files_in_config
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.samples import channel
from ev_sim.running.scenarios.scenario import Overrides, load_scenario

CARS = sorted(files_in_config("vehicles"))
PERIOD = 0.01


def car(name: str) -> Vehicle:
    """A car of config/vehicles."""
    run = load_scenario("double_lane_change", Overrides(vehicle=name)).runs[0]
    return run.configurations["plant"].common.vehicle


@pytest.mark.parametrize("name", CARS)
def test_nothing_is_withheld_from_wheels_that_roll(name):
    """Forwards from rest, 8 and 22 m/s, and in reverse: a tenth of the weight for drive, 0.2 s on a level road."""
    vehicle = car(name)
    radius, force = vehicle.wheel_radius, 0.1 * vehicle.mass * 9.81
    torque = force * radius / len(vehicle.driven_wheels)
    for law in (*METHODS, *SPEED_MODE):
        for begin in (0.0, 8.0, 22.0, -8.0):
            ahead = math.copysign(1.0, begin)
            drive = Wheels(*(ahead * torque if wheel in vehicle.driven_wheels else 0.0 for wheel in WHEEL_NAMES))
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
def test_a_car_with_four_driven_wheels_drives_from_the_first_instant():
    """In a lane change at 80 km/h all of the torque is there, where an observer from 0 m/s took 4 s to let it pass."""
    run = ev_sim.run("double_lane_change", vehicle="layout_1_8_c", method={"asr": "pi_slip"}, duration=1.0)
    for of in run.runs.values():
        for wheel in WHEEL_NAMES:
            asked, given = (channel(of, f"{topic}.drive.{wheel}") for topic in ("torque_request", "torque_command"))
            assert (asked == given).all()
            assert abs(asked).max() > 0.0
