"""Share that a side force leaves of slip thresholds (dissertation, section 1.4)."""

from __future__ import annotations

import pytest
from helpers.traction import CAR, PERIOD, car_of, numbers_of

from ev_control.estimation.slip_angle_observer import (
    Correction,
    SideForceParameters,
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    share_left,
)
from ev_control.estimation.wheel_dynamics import WheelMotion

KINEMATIC = SlipAngleObserverParameters(kinematic_share=1.0)


def left(angle: float, place: int = 0, ahead: float = 1.0, **changed) -> float:
    """Share of a threshold at a car straight on at 10 m/s, front wheels at an angle [rad]."""
    p = SideForceParameters(**{"correction": Correction.ELLIPSE, "observer": KINEMATIC, **changed})
    motion = WheelMotion(30.0, 30.0, 0.0, 100.0, 0.0, 0.0, 0.0, place, ahead, 10.0, 0.0, angle)
    return share_left(numbers_of(p), car_of(CAR), SlipAngleObserverState(), PERIOD, motion)


def test_threshold_shrinks_by_the_ellipse():
    """sqrt(1 - 0.6^2) = 0.8 at six tenths of the largest slip angle, either side.

    Rear wheels have none here.
    """
    assert left(0.072) == pytest.approx(0.8, rel=1e-12) == left(-0.072)
    assert left(0.072, place=2) == 1.0


def test_what_is_always_left_and_where_nothing_is_taken():
    """Beyond the largest slip angle a fifth is left.

    In reverse, and without the correction, all.
    """
    assert left(0.3) == 0.2
    assert left(0.072, ahead=-1.0) == left(0.072, correction=Correction.NONE) == 1.0
