"""More torque for the outer wheel."""

from __future__ import annotations

import math

import pytest
from helpers.differentials import FRONT, REAR, ZHILEYKIN, Differential, Motion, motions, on
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError

LAW = "steering_correction"


@pytest.mark.parametrize(
    ("driven", "axle", "expected"),
    [
        (FRONT, "automatic", (25, 75, 0, 0)),
        (REAR, "automatic", (0, 0, 25, 75)),
        (WHEEL_NAMES, "automatic", (12.5, 37.5, 25, 25)),
        (WHEEL_NAMES, "rear", (25, 25, 12.5, 37.5)),
        (WHEEL_NAMES, "front", (12.5, 37.5, 25, 25)),
    ],
)
def test_half_of_the_inner_torque_moves_at_pi_over_ten(driven, axle, expected):
    """100 N m in all, steering left by pi/10: -50 % inside, +50 % outside on the corrected axle."""
    law = Differential(LAW, on(ZHILEYKIN, driven), axle=axle)
    assert law.step(Motion(torque=100.0).steered(math.pi / 10)).drive == pytest.approx(
        expected, rel=1e-12
    )


def test_correction_is_limited():
    law = Differential(LAW, ZHILEYKIN, largest_correction=0.2)
    assert law.step(Motion(torque=100.0).steered(0.5)).drive == pytest.approx(
        (20, 30, 25, 25), rel=1e-12
    )


@given(motion=motions, most=st.floats(0.0, 1.0))
def test_no_wheel_works_against_the_others(motion, most):
    """Even at the limit of 1 the inner wheel only loses all of its torque."""
    drive = Differential(LAW, ZHILEYKIN, largest_correction=most).step(motion).drive
    assert all(m * motion.torque >= 0.0 for m in drive)
    assert max(abs(m) for m in drive) <= abs(motion.torque) / 4 * (1 + most) * (1 + 1e-14)


@pytest.mark.parametrize(
    ("driven", "axle", "needed"),
    [
        (("rear_left",), "automatic", "rear_left and rear_right"),
        (("front_left", "rear_left"), "automatic", "rear_left and rear_right"),
        (REAR, "front", "front_left and front_right"),
        (FRONT, "rear", "rear_left and rear_right"),
        ((), "automatic", "rear_left and rear_right"),
    ],
)
def test_both_wheels_of_the_corrected_axle_must_be_driven(driven, axle, needed):
    with pytest.raises(
        ParameterError, match=f"steering_correction needs {needed} among the driven wheels"
    ):
        Differential(LAW, on(ZHILEYKIN, driven), axle=axle)
