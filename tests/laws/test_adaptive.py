"""Equal torques; what one wheel is refused is dropped, or goes to the other one where that is asked for."""

from __future__ import annotations

import dataclasses

import pytest
from differentials import DISSERTATION, Differential, Motion, on
from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.signals import WheelTorqueRequest
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels

PERIOD = 0.005
PEDAL = Motion(torque=1000.0)


def made(**changed) -> Differential:
    return Differential("adaptive", DISSERTATION, PERIOD, **{"redistribute": True, **changed})


def refusing(law: Differential, motion: Motion, left: float, right: float, steps: int) -> WheelTorqueRequest:
    """Torques [N m] that act on the front wheels throughout; the last request."""
    for _ in range(steps):
        request = law.step(dataclasses.replace(motion, efforts=Wheels.front(left, right)))
    return request


def test_refused_torque_is_dropped_by_default():
    """Nothing in sections 2.4, 2.7.5 and 3.1 offers it on: 500 N m each, whatever acts on the wheels."""
    law = Differential("adaptive", DISSERTATION, PERIOD)
    assert refusing(law, PEDAL, 300.0, 500.0, 1000).drive == Wheels.front(500.0, 500.0)
    assert refusing(law, PEDAL, 0.0, 100.0, 1000).drive == Wheels.front(500.0, 500.0)


def test_refused_torque_is_offered_to_the_other_wheel():
    """Share 500 N m, 300 N m act on the left: 200 N m go to the right, at once up to T/(T + tau) = 1/11 of them."""
    law = made()
    assert refusing(law, PEDAL, 300.0, 500.0, 1).drive == Wheels.front(500.0, 500.0)  # nothing was asked for before
    assert refusing(law, PEDAL, 300.0, 500.0, 1).drive == pytest.approx(Wheels.front(500.0, 500.0 + 200.0 / 11))
    assert refusing(law, PEDAL, 300.0, 700.0, 1000).drive == pytest.approx(Wheels.front(500.0, 700.0))


def test_both_are_offered_when_both_refuse():
    assert refusing(made(), PEDAL, 300.0, 400.0, 1000).drive == pytest.approx(Wheels.front(600.0, 700.0))


def test_axles_offer_on_their_own():
    """250 N m each; the left wheels take 150 N m in front and 50 N m behind."""
    law = Differential("adaptive", on(DISSERTATION, WHEEL_NAMES), PERIOD, redistribute=True)
    for _ in range(1000):
        request = law.step(Motion(torque=1000.0, efforts=Wheels(150.0, 350.0, 50.0, 450.0)))
    assert request.drive == pytest.approx((250.0, 350.0, 250.0, 450.0))


def test_nothing_is_offered_while_braking():
    braking = refusing(made(), dataclasses.replace(PEDAL, brake=50.0), 300.0, 500.0, 1000)
    assert braking.drive == Wheels.front(500.0, 500.0)


def test_a_changed_direction_begins_anew():
    """Forward 200 N m were refused on the left; in reverse nobody has refused anything yet."""
    law = made()
    refusing(law, PEDAL, 300.0, 500.0, 1000)
    assert refusing(law, Motion(torque=-1000.0), 300.0, 500.0, 1).drive == Wheels.front(-500.0, -500.0)
    assert law.state["refused.front_left"] == 0.0


@given(
    torque=st.floats(1.0, 3000.0),
    acting=st.lists(st.tuples(st.floats(-500.0, 2000.0), st.floats(-500.0, 2000.0)), min_size=2, max_size=30),
)
def test_no_wheel_is_asked_for_more_than_both_shares(torque, acting):
    """Whatever acts: from its own share up to that of both wheels."""
    law = made()
    for left, right in acting:
        drive = refusing(law, Motion(torque=torque), left, right, 1).drive
        assert all(torque / 2 <= m <= torque * (1 + 1e-12) for m in drive[:2])
