"""Equal torques.

What one wheel is refused is dropped, or goes to the other one where that is asked for.
"""

from __future__ import annotations

import dataclasses

import pytest
from helpers.differentials import DISSERTATION, Differential, Motion, on
from hypothesis import given
from hypothesis import strategies as st

import ev_stack
from ev_msgs_py.contract.signals import WheelTorqueRequest
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels

PERIOD = 0.005
PEDAL = Motion(torque=1000.0)


def made(**changed) -> Differential:
    return Differential("adaptive", DISSERTATION, PERIOD, **{"redistribute": True, **changed})


def refusing(
    law: Differential, motion: Motion, left: float, right: float, steps: int
) -> WheelTorqueRequest:
    """Torques [N m] that act on the front wheels throughout; the last request."""
    for _ in range(steps):
        request = law.step(dataclasses.replace(motion, efforts=Wheels.front(left, right)))
    return request


def test_refused_torque_is_dropped_by_default():
    """Nothing in sections 2.4, 2.7.5 and 3.1 offers it on.

    500 N m each, whatever acts on the wheels.
    """
    law = Differential("adaptive", DISSERTATION, PERIOD)
    assert refusing(law, PEDAL, 300.0, 500.0, 1000).drive == Wheels.front(500.0, 500.0)
    assert refusing(law, PEDAL, 0.0, 100.0, 1000).drive == Wheels.front(500.0, 500.0)


def test_refused_torque_is_offered_to_the_other_wheel():
    """Share 500 N m, 300 N m act on the left.

    200 N m go to the right, at once up to T/(T + tau) = 1/11 of them.
    """
    law = made()
    # nothing was asked for before
    assert refusing(law, PEDAL, 300.0, 500.0, 1).drive == Wheels.front(500.0, 500.0)
    assert refusing(law, PEDAL, 300.0, 500.0, 1).drive == pytest.approx(
        Wheels.front(500.0, 500.0 + 200.0 / 11)
    )
    assert refusing(law, PEDAL, 300.0, 700.0, 1000).drive == pytest.approx(
        Wheels.front(500.0, 700.0)
    )


def test_both_are_offered_when_both_refuse():
    assert refusing(made(), PEDAL, 300.0, 400.0, 1000).drive == pytest.approx(
        Wheels.front(600.0, 700.0)
    )


def test_axles_offer_on_their_own():
    """250 N m each; the left wheels take 150 N m in front and 50 N m behind."""
    law = Differential("adaptive", on(DISSERTATION, WHEEL_NAMES), PERIOD, redistribute=True)
    for _ in range(1000):
        request = law.step(Motion(torque=1000.0, efforts=Wheels(150.0, 350.0, 50.0, 450.0)))
    assert request.drive == pytest.approx((250.0, 350.0, 250.0, 450.0))


def test_nothing_is_offered_while_braking():
    braking = refusing(made(), dataclasses.replace(PEDAL, brake=50.0), 300.0, 500.0, 1000)
    assert braking.drive == Wheels.front(500.0, 500.0)


def test_a_changed_direction_restarts_the_law():
    """The 200 N m refused forward on the left do not count in reverse."""
    law = made()
    refusing(law, PEDAL, 300.0, 500.0, 1000)
    assert refusing(law, Motion(torque=-1000.0), 300.0, 500.0, 1).drive == Wheels.front(
        -500.0, -500.0
    )
    assert law.state["refused.front_left"] == 0.0


@given(
    torque=st.floats(1.0, 3000.0),
    acting=st.lists(
        st.tuples(st.floats(-500.0, 2000.0), st.floats(-500.0, 2000.0)), min_size=2, max_size=30
    ),
)
def test_no_wheel_is_asked_for_more_than_both_shares(torque, acting):
    """A wheel gets from its own share up to that of both wheels, whatever acts."""
    law = made()
    for left, right in acting:
        drive = refusing(law, Motion(torque=torque), left, right, 1).drive
        assert all(torque / 2 <= m <= torque * (1 + 1e-12) for m in drive[:2])


# The driver's switch: equal torques on the road, asymmetric ones off it


EFFICIENCY = 0.97  # of the gear
GEARED = dataclasses.replace(
    DISSERTATION, motor=dataclasses.replace(DISSERTATION.motor, gear_efficiency=EFFICIENCY)
)


def on_the_road(**changed) -> Differential:
    return Differential("adaptive", GEARED, PERIOD, **{"driving_mode": "road", **changed})


def test_on_the_road_the_other_wheel_gets_no_more():
    """The left takes 300 of 500 N m, which acts behind the gear.

    The right is asked for as much, by 11 in 1.
    """
    law = on_the_road()
    acting = (300.0 * EFFICIENCY, 500.0 * EFFICIENCY)
    # nothing was asked for before
    assert refusing(law, PEDAL, *acting, 1).drive == Wheels.front(500.0, 500.0)
    assert refusing(law, PEDAL, *acting, 1).drive == pytest.approx(
        Wheels.front(500.0, 500.0 - 200.0 / 11)
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("better", [0, 1])
def test_torques_that_follow_their_requests_become_equal(sign, better):
    """One wheel takes 300 N m at most.

    After twenty time constants both get that, and it is no trap.

    As soon as the wheel takes all again, both are back at their shares, forwards and in reverse,
    and for either side.
    """
    law, acting = on_the_road(), [0.0, 0.0]

    def drive(most: float, steps: int) -> Wheels:
        for _ in range(steps):
            motion = Motion(torque=sign * 1000.0, efforts=Wheels.front(*acting))
            request = law.step(motion).drive
            for i in range(2):
                limit = 500.0 if i == better else most
                acting[i] = sign * min(sign * request[i], limit) * EFFICIENCY
        return request

    assert drive(300.0, 200)[better] == pytest.approx(sign * 300.0, rel=1e-6)
    assert drive(500.0, 200) == pytest.approx(Wheels.front(sign * 500.0, sign * 500.0), rel=1e-6)


def test_a_wheel_that_takes_all_costs_nothing_on_the_road():
    """The gear's part of the command is no refusal: requests are those of equal_torque."""
    acting = 500.0 * EFFICIENCY
    assert refusing(on_the_road(), PEDAL, acting, acting, 1000).drive == pytest.approx(
        Wheels.front(500.0, 500.0)
    )


@given(
    acting=st.lists(
        st.tuples(st.floats(-500.0, 2000.0), st.floats(-500.0, 2000.0)), min_size=2, max_size=30
    )
)
def test_on_the_road_no_wheel_is_asked_for_more_than_its_share(acting):
    law = on_the_road()
    for left, right in acting:
        assert all(0.0 <= m <= 500.0 for m in refusing(law, PEDAL, left, right, 1).drive[:2])


def test_the_switch_turns_to_the_other_mode_at_its_time():
    """The scenario: equal torques until 4 s, as `road`.

    From then on as `off_road`, with more torque on the dry side.

    Of 5.4 kN at 0.32 m ice takes 0.05 and its rolling resistance 0.017, 117 N m: on the road the
    right wheel gets as much in the mean (5 %, for the ASR of the left one swings, which is half as
    much again at the most); off it, and from the switch on, it gets its 750 N m less the gear.
    """
    runs = {name: run.channels for name, run in ev_stack.run("road_off_road").runs.items()}
    left, right = (
        {n: c[f"wheel_states.effort.front_{side}"] for n, c in runs.items()}
        for side in ("left", "right")
    )
    settled, switch = 300, 800  # 1.5 s and 4 s
    for name, part in (("road", slice(settled, None)), ("switched", slice(settled, switch))):
        assert right[name][part].mean() == pytest.approx(left[name][part].mean(), rel=0.05)
        assert right[name][part].max() < 1.5 * left[name][part].mean()
    for name, part in (("off_road", slice(settled, None)), ("switched", slice(switch + 20, None))):
        assert right[name][part] == pytest.approx(750.0 * EFFICIENCY, rel=1e-6)
    assert runs["off_road"]["pose.x"][-1] > 4.0 * runs["road"]["pose.x"][-1]
    before = runs["switched"]["pose.x"][: switch + 1]
    assert (before == runs["road"]["pose.x"][: switch + 1]).all()  # to the bit


def test_without_a_switch_method_1_is_off_the_road():
    """Chapter 3 drives it so: "adaptive regulation".

    A switch turned at 2 s is the other mode from then on.
    """
    default, turned, acting = (
        Differential("adaptive", GEARED, PERIOD),
        on_the_road(switch_at=2.0),
        (300.0, 500.0),
    )
    assert refusing(default, PEDAL, *acting, 10).drive == Wheels.front(500.0, 500.0)
    assert (
        refusing(turned, dataclasses.replace(PEDAL, time=1.995), *acting, 10).drive.front_right
        < 450.0
    )
    assert refusing(turned, dataclasses.replace(PEDAL, time=2.0), *acting, 1).drive == Wheels.front(
        500.0, 500.0
    )
