"""Sensors that change numbers of the part before them."""

from __future__ import annotations

import numpy as np
import pytest
from sensors.rows import EVERYTHING

from ev_core.compiling.machine_code import call
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import compiled_parts, hand_over, part_of
from ev_core.sensors.measuring import HEADING, NUMBERS
from ev_core.sensors.row import QUANTITIES
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.signals import WheelTorqueCommand

ROLLS = {
    "vehicle.suspension.sprung_mass": 1000.0,
    "vehicle.suspension.front_roll_stiffness": 30e3,
    "vehicle.suspension.rear_roll_stiffness": 30e3,
    "vehicle.suspension.roll_inertia": 300.0,
    "vehicle.suspension.front_roll_damping": 2e3,
    "vehicle.suspension.rear_roll_damping": 2e3,
}
PLANT = [quantity.name for quantity in QUANTITIES if quantity.signal in ROLES["plant"].writes]


def frames(role: str, method: str, errors: dict[str, float], steps: int = 0) -> np.ndarray:
    """Outputs of a role with sensors (quantity.error), from the start on, under wheel torques."""
    values = {f"sensors.{name}": value for name, value in errors.items()}
    if method == "planar":
        rolls = any(name.startswith("body_roll") for name in errors)
        values |= ROLLS if rolls else {"electrical": True}
    parts = compiled_parts(configure(role, {"method": method, **values}))
    rows = np.zeros((steps + 1, frame.SIZE))
    for k in range(steps + 1):
        for part in parts:
            function, state, constants = part.addresses()
            now = rows[k - 1].ctypes.data if k else 0
            assert call(function, now, rows[k].ctypes.data, state, constants) == 0
        rows[k, frame.PLACES[WheelTorqueCommand]][:2] = 100.0 + k, 200.0
    return rows


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda quantity: quantity.name)
def test_a_bias_shows_in_its_own_numbers_and_nowhere_else(quantity):
    """A heading shows it as that of a quaternion about the vertical axis.

    Wheels without a circuit have no sensors.
    """
    role = next(role.name for role in ROLES.values() if quantity.signal in role.writes)
    methods = {
        "plant": "planar",
        "steering_column": "powered",
        "rear_steering": "speed_dependent",
    }
    method = methods.get(role, "circuits_with_flow")
    true, biased = (
        frames(role, method, {f"{quantity.name}.bias": bias})[0] for bias in (0.0, 0.125)
    )
    driven = configure("plant", {}).common.vehicle.driven_wheels
    own = [quantity.places[i] for part in quantity.parts(driven) for i in part]
    if quantity.kind == HEADING:
        assert biased[list(quantity.places)] == pytest.approx(
            [np.sin(0.0625), np.cos(0.0625)], rel=1e-15
        )
    else:
        assert biased[own] == pytest.approx(0.125 + true[own], rel=2**-24)
    others = np.setdiff1d(
        np.arange(frame.SIZE), own if quantity.kind == NUMBERS else quantity.places
    )
    assert biased[others].tobytes() == true[others].tobytes()


def test_ideal_sensors_are_not_there():
    """Ideal sensors cost nothing; a seed alone makes no noise."""
    assert len(compiled_parts(configure("plant", {"seed": 3}))) == 1
    assert len(compiled_parts(configure("plant", {"sensors.wheel_speed.delay": 1}))) == 2


def test_sensors_do_not_touch_what_is_integrated():
    """The same commands move the car alike, whatever is measured: a bias is all that differs."""
    true = frames("plant", "planar", {}, 50)
    biased = frames("plant", "planar", {"body_velocity.bias": 0.5, "wheel_torque.delay": 3}, 50)
    for name, place in frame.channels().items():
        off = 0.5 if name in ("twist.longitudinal", "twist.lateral") else 0.0
        if not name.startswith("wheel_states.effort"):
            assert (biased[:, place] == true[:, place] + off).all(), name
    everything = {f"{name}.{error}": value for name in PLANT for error, value in EVERYTHING.items()}
    assert (frames("plant", "planar", everything, 50)[:, 1:60] != true[:, 1:60]).any(
        axis=0
    ).sum() > 50


def test_a_change_of_one_sensor_leaves_the_noise_of_the_others_as_it_is():
    """A sensor that comes later, with a delay, begins with what there is, and not with zeros."""
    values = {"method": "planar", "initial_speed": 10.0, "sensors.imu_yaw_rate.noise": 0.1}
    configuration, places = configure("plant", values), frame.channels()
    other = configuration.changed(
        {"sensors.wheel_speed.delay": 2, "sensors.body_position.noise": 0.1}
    )
    shown = []
    for second in (configuration, other):
        there, seen = Frame(), []
        plant = part_of(configuration, compiled=True)
        plant.start(there)
        for n in range(6):
            if n == 3:
                after = part_of(second, compiled=True)
                hand_over(plant, after)
                plant = after
            plant.step(Frame(), there)
            seen.append(there.numbers[places["imu.yaw_rate"]])
            assert there.numbers[places["wheel_states.velocity.rear_left"]] > 20.0  # 10 m/s
        shown.append(seen)
    assert shown[0] == shown[1]
    assert len(set(shown[0])) == 6
