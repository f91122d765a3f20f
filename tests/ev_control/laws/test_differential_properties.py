"""Properties of all electronic differentials whatever happens.

Mirrored cars, sums, brakes, wheels without a motor.
"""

from __future__ import annotations

import pytest
from helpers.differentials import (
    FRONT,
    GE_NI,
    REAR,
    ROLE,
    SHCHUR,
    ZHILEYKIN,
    Differential,
    Motion,
    motions,
    on,
    sequences,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_control.shared.torque_split import BrakeSplitParameters
from ev_core.methods.register import methods_of
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.signals import WheelTorqueRequest
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError

pytestmark = pytest.mark.slow

# By law: a car of its own layout, and choices of parameters besides the default.
CARS: dict[str, Vehicle] = dict.fromkeys(methods_of(ROLE), SHCHUR) | {
    "axle_redistribution": ZHILEYKIN,
    "slip_target": GE_NI,
    "steering_correction": ZHILEYKIN,
    "wheel_speed": GE_NI,
}
CHOICES: dict[str, tuple[dict, ...]] = {
    "adaptive": ({"redistribute": True},),
    "adhesion_share": ({"friction": "estimated"},),
    "axle_redistribution": (
        {"source": "estimated"},
        {"first_branch": "rear", "second_branch": "derived"},
        {"factor": "equality", "rear_wheels": "by_geometry"},
    ),
    "course_stability": (
        {"first": "yaw", "wish": "angle"},
        {"against": "both", "error_factor": 0.3},
    ),
    "slip_target": (
        {"source": "estimated"},
        {"reading": "offset", "boundary_layer": False},
        {"reading": "increment"},
    ),
    "steering_correction": ({"axle": "rear"},),
    "wheel_speed": ({"mean": "speed"},),
}
# These give less than asked for where grip or motor end, or another sum to reach slips or speeds.
LIMITING = (
    "adhesion_share",
    "direct_yaw_moment",
    "open_differential",
    "slip_target",
    "wheel_speed",
)
FRONT_LAYOUTS = (FRONT, ("front_left", "front_right", "rear_left"), WHEEL_NAMES)
ANY_LAYOUTS = (*FRONT_LAYOUTS, REAR, ("rear_left",))
LAYOUTS = {
    "axle_redistribution": (WHEEL_NAMES,),
    "course_stability": (FRONT,),
    "direct_yaw_moment": (*FRONT_LAYOUTS, REAR),
    "drive_by_wire": FRONT_LAYOUTS,
    "power_steering": FRONT_LAYOUTS,
    "slip_target": (REAR,),
    "steer_by_wire": FRONT_LAYOUTS,
    "steering_correction": (*FRONT_LAYOUTS, REAR),
    "wheel_speed": (REAR,),
}
SYMMETRIC = (FRONT, REAR, WHEEL_NAMES)
MIRRORED = [
    (name, changed, driven)
    for name in CARS
    for changed in ({}, *CHOICES.get(name, ()))
    for driven in SYMMETRIC
    if driven in LAYOUTS.get(name, SYMMETRIC) and (changed, driven) != ({"axle": "rear"}, FRONT)
]


def test_all_sixteen_are_asked():
    assert len(CARS) == 16


@pytest.mark.parametrize("name", CARS)
def test_law_rests_with_the_driver(name):
    assert Differential(name, CARS[name]).step(Motion()) == WheelTorqueRequest(NO_WHEELS, NO_WHEELS)


@settings(max_examples=40)
@given(sequence=sequences)
@pytest.mark.parametrize(("name", "changed", "driven"), MIRRORED)
@pytest.mark.sampled
def test_mirrored_car_gets_mirrored_torques_to_the_bit(name, changed, driven, sequence):
    car = on(CARS[name], driven)
    law, mirror = Differential(name, car, **changed), Differential(name, car, **changed)
    for motion in sequence:
        drive, (fl, fr, rl, rr) = law.step(motion).drive, mirror.step(motion.mirrored()).drive
        assert drive == (fr, fl, rr, rl)


@pytest.mark.sampled
@given(sequence=sequences, data=st.data())
@pytest.mark.parametrize("name", [name for name in CARS if name not in LIMITING])
def test_drive_torques_add_up_to_what_the_driver_asks(name, sequence, data):
    """Equal to rounding.

    1e-12 of the numbers involved, for differences are far above the driver's torque at times.
    """
    driven = data.draw(st.sampled_from(LAYOUTS.get(name, ANY_LAYOUTS)))
    law = Differential(name, on(CARS[name], driven))
    for motion in sequence:
        drive = law.step(motion).drive
        largest = max(abs(torque) for torque in drive)
        assert sum(drive) == pytest.approx(
            motion.torque, abs=1e-12 * (largest + abs(motion.torque)) + 1e-300
        )


@pytest.mark.sampled
@given(motion=motions, data=st.data())
@pytest.mark.parametrize("name", CARS)
def test_wheels_without_a_motor_are_asked_for_nothing(name, motion, data):
    driven = data.draw(st.sampled_from(LAYOUTS.get(name, ANY_LAYOUTS)))
    drive = Differential(name, on(CARS[name], driven)).step(motion).drive
    assert [
        torque for wheel, torque in drive._asdict().items() if wheel not in driven and torque != 0.0
    ] == []


@pytest.mark.sampled
@given(brake=st.floats(0.0, 10000.0), share=st.floats(0.0, 1.0))
@pytest.mark.parametrize("name", CARS)
def test_brake_torques_add_up_and_are_never_negative(name, brake, share):
    """Equal to rounding (1e-12)."""
    law = Differential(name, CARS[name], brake=BrakeSplitParameters(front_share=share))
    asked = law.step(Motion(brake=brake)).brake
    assert sum(asked) == pytest.approx(brake, rel=1e-12)
    assert min(asked) >= 0.0


@pytest.mark.parametrize("name", CARS)
def test_brakes_by_the_front_share(name):
    law = Differential(name, CARS[name], brake=BrakeSplitParameters(front_share=0.75))
    assert law.step(Motion(brake=800.0)).brake == Wheels(300.0, 300.0, 100.0, 100.0)


ONE_AT_LEAST = [name for name in CARS if name not in LAYOUTS]


@pytest.mark.parametrize("name", ONE_AT_LEAST)
def test_a_car_without_driven_wheels_is_refused(name):
    line = f"^electronic_differential method {name} needs at least one driven wheel, vehicle audi_a2 drives none$"
    with pytest.raises(ParameterError, match=line):
        Differential(name, on(SHCHUR, ()))
