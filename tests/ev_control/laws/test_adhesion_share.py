"""Torque by the grip of each wheel."""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from helpers.differentials import DISSERTATION, FRONT_LOAD, Differential, Motion, on
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_control.estimation.friction_estimate import FrictionEstimateParameters
from ev_control.estimation.reference_speed import ReferenceSpeedParameters, Source
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError

LAW = "adhesion_share"
PERIOD = 0.005
INERTIA = 1.658 + 7.4**2 * 0.02  # of a front wheel with its rotor [kg m^2]
GRIP = 0.32 * FRONT_LOAD  # torque that a front wheel takes with friction 1 [N m]
frictions = st.floats(0.05, 1.2)


def made(**changed) -> Differential:
    return Differential(LAW, DISSERTATION, PERIOD, **changed)


def on_road(torque: float, left: float, right: float) -> Motion:
    """The car at rest on roads of these frictions."""
    return Motion(torque=torque, friction=Wheels.front(left, right), load=Wheels.all(FRONT_LOAD))


@given(
    torque=st.floats(-1000.0, 1000.0), left=frictions, right=frictions, factor=st.floats(0.2, 3.0)
)
@settings(max_examples=100)
def test_with_a_limit_torques_stay_below_the_grip_and_in_proportion(torque, left, right, factor):
    """M_i <= factor phi_i F_i r (eq 1.2), M_left/M_right = phi_left/phi_right under equal loads."""
    drive = made(error_factor=factor, limit=True).step(on_road(torque, left, right)).drive
    for place, friction in enumerate((left, right)):
        assert abs(drive[place]) <= factor * friction * GRIP * (1 + 1e-14)
    assert drive.front_left * right == pytest.approx(drive.front_right * left, rel=1e-12, abs=1e-12)
    # below that a product keeps few digits
    assert abs(sum(drive)) <= abs(torque) * (1 + 1e-14) + 1e-300


@given(
    torque=st.floats(-3000.0, 3000.0), left=frictions, right=frictions, factor=st.floats(0.2, 3.0)
)
def test_all_of_the_torque_is_shared_also_where_the_road_does_not_carry_it(
    torque, left, right, factor
):
    """M_i = M phi_i/sum(phi) under equal loads, however wrong the friction is believed to be.

    1e-12 for rounding.
    """
    drive = made(error_factor=factor).step(on_road(torque, left, right)).drive
    shares = left / (left + right), right / (left + right)
    assert drive[:2] == pytest.approx([torque * share for share in shares], rel=1e-12, abs=1e-300)


@given(torque=st.floats(-300.0, 300.0), left=frictions, right=frictions)
def test_with_a_limit_all_is_shared_where_the_road_carries_it(torque, left, right):
    """Friction 0.05 carries 86 N m on each side, 1e-12 for rounding."""
    carried = (left + right) * GRIP
    drive = made(limit=True).step(on_road(torque, left, right)).drive
    assert abs(sum(drive)) == pytest.approx(min(abs(torque), carried), rel=1e-12, abs=1e-300)


def test_snow_and_asphalt_by_hand():
    """Snow left, asphalt right: all of 1000 N m at 1 : 2.

    With a limit of 9000 N m what both wheels can carry.
    """
    assert made().step(on_road(1000.0, 0.4, 0.8)).drive == pytest.approx(
        Wheels.front(1000 / 3, 2000 / 3)
    )
    assert made().step(on_road(9000.0, 0.4, 0.8)).drive == pytest.approx(
        Wheels.front(3000.0, 6000.0)
    )
    assert made(limit=True).step(on_road(9000.0, 0.4, 0.8)).drive == pytest.approx(
        Wheels.front(0.4 * GRIP, 0.8 * GRIP)
    )
    mistaken = made(error_factor=1.5, limit=True).step(on_road(9000.0, 0.4, 0.8)).drive
    assert mistaken == pytest.approx(Wheels.front(0.6 * GRIP, 1.2 * GRIP))


@pytest.mark.parametrize(("speed", "arrives"), [(20.0, 0.97), (0.0, 0.97), (-20.0, 1 / 0.97)])
def test_the_wheel_gets_its_grip_through_the_gear(speed, arrives):
    """The gear lets 97 % of a command arrive where it drives.

    Where the motor brakes, the gear helps.
    """
    car = dataclasses.replace(DISSERTATION, motor=Motor(gear_efficiency=0.97))
    motion = dataclasses.replace(on_road(9000.0, 0.4, 0.8), speeds=Wheels.all(speed))
    drive = Differential(LAW, car, PERIOD, limit=True).step(motion).drive
    assert [arrives * torque for torque in drive] == pytest.approx(
        Wheels.front(0.4 * GRIP, 0.8 * GRIP), rel=1e-14
    )
    part = Differential(LAW, car, PERIOD).step(dataclasses.replace(motion, torque=1000.0)).drive
    # the driver's torque is a command as well
    assert part == pytest.approx(Wheels.front(1000 / 3, 2000 / 3))


@pytest.mark.parametrize("limit", [False, True])
@pytest.mark.parametrize("load", [0.0, 5e-324])
def test_no_load_means_no_torque_or_a_finite_one(limit, load):
    """The smallest load that a float can have, too: torque over it would be infinite."""
    drive = made(limit=limit).step(Motion(torque=1000.0, load=Wheels.all(load))).drive
    assert sum(drive) in (0.0, 1000.0)


def test_estimated_friction_is_found_by_slipping():
    """The left wheel slips by a third while the road takes 0.4 F r of it.

    The right one rolls, and stays at 1.2.
    """
    law = made(friction="estimated")
    road = 0.4 * GRIP
    speeds = np.concatenate(
        (np.full(100, 20.0), np.linspace(20.0, 30.0, 41), np.full(60, 30.0))
    ).tolist()
    for before, left in pairwise(speeds):
        effort = Wheels.front(road + INERTIA * (left - before) / PERIOD, road)
        drive = law.step(
            Motion(torque=2000.0, speeds=Wheels(left, 20.0, 20.0, 20.0), efforts=effort)
        ).drive
    left, right = (law.state[f"estimate.friction.front_{side}"] for side in ("left", "right"))
    assert left == pytest.approx(0.4, rel=1e-3)
    assert right == 1.2
    assert drive.front_left / drive.front_right == pytest.approx(left / 1.2)


def test_truth_learns_nothing():
    law = made()
    first = law.state
    law.step(dataclasses.replace(on_road(1000.0, 0.4, 0.8), speeds=Wheels.all(20.0)))
    assert law.state == first


def test_free_wheels_must_be_there_to_be_believed():
    estimate = FrictionEstimateParameters(
        reference=ReferenceSpeedParameters(source=Source.FREE_WHEELS)
    )
    line = "adhesion_share needs a wheel without a motor for estimate.reference.source free_wheels"
    with pytest.raises(ParameterError, match=line):
        Differential(LAW, on(DISSERTATION, WHEEL_NAMES), estimate=estimate)
