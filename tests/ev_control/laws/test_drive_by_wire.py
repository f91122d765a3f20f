"""The steering wheel sets the torque difference."""

from __future__ import annotations

import pytest
from helpers.differentials import REAR, SHCHUR, Differential, Motion, on
from helpers.steering_loop import Column, difference, drive, law

from ev_core.lockstep.finding import find_method
from ev_msgs_py.contract.signals import SteeringColumnState
from ev_msgs_py.refusal import ParameterError


def test_drive_by_wire_is_open_loop():
    """Delta M = k alpha whatever the road wheels do."""
    differential = law("drive_by_wire", gain=2.0)
    for road_wheel_angle in (0.0, 0.7):
        column = SteeringColumnState(3.0, 5.0, 1.0, road_wheel_angle, 0.0)
        assert difference(differential.step(Motion(torque=50.0, column=column))) == 6.0


def test_drive_by_wire_settles_where_the_steering_wheel_points():
    """The default gain is 2 r_k k_p/(d i), rounded to four digits.

    The object's own overshoot of 40.3 % remains.
    """
    column = Column("by_wire", held=16 * 0.5)
    angle, _ = drive(column, law("drive_by_wire"), hand_torque=0.0, duration=15.0)
    assert angle[-1] == pytest.approx(0.5, rel=5e-4)
    assert (angle.max() / angle[-1] - 1) * 100 == pytest.approx(40.3, abs=1.0)


@pytest.mark.parametrize("driven", [REAR, ("front_left",), ()])
def test_a_car_without_two_front_drives_is_refused(driven):
    with pytest.raises(
        ParameterError,
        match="drive_by_wire needs front_left and front_right among the driven wheels",
    ):
        Differential("drive_by_wire", on(SHCHUR, driven))


def test_hands_turn_nothing_else():
    assert find_method("electronic_differential", "drive_by_wire").requires == {
        "steering_column": "by_wire"
    }
