"""The wanted yaw rate against its equations; the single-track model behind it."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from helpers.differentials import GRAVITY, ZHILEYKIN

from ev_control.torque_vectoring.reference import (
    Bend,
    Reference,
    ReferenceParameters,
    ReferenceState,
    designed_acceleration,
    wanted_motion,
)
from ev_control.torque_vectoring.single_track import (
    SingleTrackParameters,
    single_track,
    steady_lateral_velocity,
    steady_moment,
)
from ev_msgs_py.refusal import ParameterError

CAR = ZHILEYKIN  # L 2.7 m
P = ReferenceParameters(lag=0.001)
GRIP = 0.8 * GRAVITY


def settled(
    kind: Reference,
    speed: float,
    angle: float,
    grip: float = GRIP,
    across: float = 0.0,
    slides: float = 0.0,
):
    """Wanted motion after 1 s, a thousand times the lag."""
    state = ReferenceState()
    for _ in range(100):
        wanted = wanted_motion(P, CAR, state, 0.01, kind, Bend(speed, angle, grip, across, slides))
    return wanted


@pytest.mark.parametrize("speed", [3.0, 20.0, -20.0])
def test_neutral_turns_by_geometry(speed):
    """The rate u delta/L.

    Wheels to the left turn the car to the left ahead and to the right in reverse.
    """
    assert settled(Reference.NEUTRAL, speed, 0.01).yaw_rate == pytest.approx(
        speed * 0.01 / 2.7, rel=1e-9
    )


@pytest.mark.parametrize("kind", [Reference.NEUTRAL, Reference.UNDERSTEER])
@pytest.mark.parametrize("speed", [20.0, -20.0])
def test_the_friction_bounds_the_yaw_rate(kind, speed):
    """It goes to 0.9 mu g/u, which the designed characteristic approaches."""
    assert settled(kind, speed, -1.4).yaw_rate == pytest.approx(-0.9 * GRIP / speed, rel=1e-6)


def test_understeer_is_that_of_its_gradient_in_the_linear_part():
    """The rate u delta/(L + K u^2), and the angle that belongs to it is the driver's."""
    wanted = settled(Reference.UNDERSTEER, 20.0, 0.02)
    assert wanted.yaw_rate == pytest.approx(20.0 * 0.02 / (2.7 + 0.002 * 400.0), rel=1e-9)
    assert wanted.angle == pytest.approx(0.02, rel=1e-9)
    assert wanted.rate == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.01, 0.03, 0.05, 0.07])
@pytest.mark.parametrize("speed", [2.0, 8.0, 40.0])
def test_the_angle_of_the_designed_acceleration_is_the_drivers(speed, angle):
    """The characteristic turned round.

    delta = L a/u^2 + K a, and beyond a_1 K a_1 - K (a_2 - a_1) ln(1 - use).
    """
    largest = 0.9 * GRIP
    a = designed_acceleration(P, 2.7 / (speed * speed), angle, largest)
    linear = 0.5 * largest
    beyond = 0.002 * (linear - (largest - linear) * math.log((largest - a) / (largest - linear)))
    assert 0.0 <= a < largest
    assert 2.7 * a / (speed * speed) + (0.002 * a if a <= linear else beyond) == pytest.approx(
        angle, abs=1e-9
    )


def test_a_rear_axle_that_slides_is_given_the_yaw_rate_of_the_path():
    """None of it at 0.04 rad, half at 0.07 rad, all at 0.1 rad, either way: a_y/u = 0.15 rad/s."""
    free = settled(Reference.UNDERSTEER, 20.0, 0.1).yaw_rate
    for slides, share in ((0.03, 0.0), (-0.07, 0.5), (0.2, 1.0)):
        found = settled(Reference.SIDESLIP_LIMIT, 20.0, 0.1, across=3.0, slides=slides).yaw_rate
        assert found == pytest.approx(free + share * (0.15 - free), rel=1e-9)


def test_limits_of_sideslip_have_an_order():
    with pytest.raises(
        ParameterError, match=r"last_sideslip is 0.04 rad, expected more than first_sideslip"
    ):
        ReferenceParameters(last_sideslip=0.04)


def test_a_car_of_the_wanted_gradient_needs_no_moment():
    """K = m_1/C_1 - m_2/C_2 of the car itself.

    M_z = 0, and v = b r - m_2 u^2 r/C_2 by its rear axle.
    """
    tyres = SingleTrackParameters(front_cornering_stiffness=100e3, rear_cornering_stiffness=150e3)
    car, u = replace(CAR, centre_of_mass_to_rear_axle=1.5), 20.0
    front, rear = car.mass * 1.5 / 2.7, car.mass * 1.2 / 2.7
    r = u * 0.02 / (2.7 + (front / 100e3 - rear / 150e3) * u * u)
    model = single_track(tyres, car, u)
    assert steady_moment(car, model, 0.02, r) == pytest.approx(0.0, abs=1e-8)
    assert steady_lateral_velocity(model, 0.02, r) == pytest.approx(
        1.5 * r - rear * u * u * r / 150e3, rel=1e-9
    )


def test_in_reverse_the_model_is_that_of_the_car_turned_round():
    """Front and rear axle exchanged, v and delta of the other sign."""
    tyres = SingleTrackParameters(front_cornering_stiffness=100e3, rear_cornering_stiffness=150e3)
    turned = SingleTrackParameters(front_cornering_stiffness=150e3, rear_cornering_stiffness=100e3)
    car = replace(CAR, centre_of_mass_to_rear_axle=1.5)
    back, ahead = (
        single_track(tyres, car, -20.0),
        single_track(turned, replace(CAR, centre_of_mass_to_rear_axle=1.2), 20.0),
    )
    assert (back.a_11, back.a_22) == pytest.approx((ahead.a_11, ahead.a_22), rel=1e-12)
    assert (back.a_12, back.a_21) == pytest.approx((-ahead.a_12, -ahead.a_21), rel=1e-12)
