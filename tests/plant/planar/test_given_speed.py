"""A speed that an outer force holds or imposes."""

from __future__ import annotations

import pytest
from plant.planar.car import CAR, STRAIGHT, command, outputs, plant
from plant.planar.manoeuvres import MANOEUVRES

from ev_msgs_py.contract.signals import InertialMeasurement, TireForces
from ev_sim.plant.planar.planar_state import VX, VY, YAW_RATE, index
from ev_sim.profiles.profile import profile_of, value_at


def test_held_speed_is_held_by_a_force_that_neither_turns_nor_pitches_the_car():
    """To the bit; on a level straight road it takes the force of the tyres but for the drag, which alone pitches."""
    held = plant(initial_speed=10.0, speed="held")
    for _ in range(300):
        held.advance(command(drive=(300.0, 300.0, 0.0, 0.0)), STRAIGHT)
        assert held.state[VX] == 10.0
    assert held.state[YAW_RATE] == 0.0
    drag = 0.5 * CAR.air_density * CAR.drag_coefficient * CAR.frontal_area * 10.0**2
    front = CAR.mass * 9.81 * 0.45 - drag * CAR.centre_of_mass_height / CAR.wheelbase
    load = outputs(held)[TireForces].load
    assert load.front_left + load.front_right == pytest.approx(front, rel=1e-9)  # the rest of a lag of 20 ms
    before = held.state[index("holding_work")]
    held.advance(command(drive=(300.0, 300.0, 0.0, 0.0)), STRAIGHT)
    power = (held.state[index("holding_work")] - before) / 0.01
    force = sum(outputs(held)[TireForces].longitudinal_force)  # steady by now
    assert power == pytest.approx((force - drag) * 10.0, rel=1e-6)


def test_imposed_speed_follows_its_profile():
    """At every period to rounding, in a bend and whatever the drives do; the accelerometer feels it."""
    parameters, inputs = MANOEUVRES["imposed speed"]
    car = plant(**parameters)
    profile = profile_of(parameters["imposed_speed__time"], parameters["imposed_speed__speed"], "linear")
    for n in range(1, 351):
        car.advance(*inputs(n * 0.01))
        assert car.state[VX] == pytest.approx(value_at(profile, n * 0.01), abs=1e-12)
        if n == 150:
            imu = outputs(car)[InertialMeasurement]
            turning = car.state[YAW_RATE] * car.state[VY]
            assert imu.longitudinal_acceleration == pytest.approx(2.0 - turning, abs=1e-6)
