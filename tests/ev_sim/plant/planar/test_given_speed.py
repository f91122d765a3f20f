"""A speed that an outer force holds or imposes."""

from __future__ import annotations

from dataclasses import replace

import pytest
from plant.planar.car import CAR, STRAIGHT, command, outputs, plant, steered
from plant.planar.manoeuvres import MANOEUVRES

from ev_msgs_py.contract.signals import InertialMeasurement, TireForces
from ev_sim.plant.planar.planar_state import VX, VY, YAW_RATE, index
from ev_sim.profiles.profile import profile_of, value_at


def test_held_speed_is_held_by_a_force_that_neither_turns_nor_pitches_the_car():
    """The speed holds to the bit.

    A level straight road takes the tyres' force but for drag, which alone pitches.
    """
    held = plant(initial_speed=10.0, speed="held")
    for _ in range(300):
        held.advance(command(drive=(300.0, 300.0, 0.0, 0.0)), STRAIGHT)
        assert held.state[VX] == 10.0
    assert held.state[YAW_RATE] == 0.0
    drag = 0.5 * CAR.air_density * CAR.drag_coefficient * CAR.frontal_area * 10.0**2
    front = CAR.mass * 9.81 * 0.45 - drag * CAR.centre_of_mass_height / CAR.wheelbase
    load = outputs(held)[TireForces].load
    # the rest of a lag of 20 ms
    assert load.front_left + load.front_right == pytest.approx(front, rel=1e-9)
    before = held.state[index("holding_work")]
    held.advance(command(drive=(300.0, 300.0, 0.0, 0.0)), STRAIGHT)
    power = (held.state[index("holding_work")] - before) / 0.01
    force = sum(outputs(held)[TireForces].longitudinal_force)  # steady by now
    assert power == pytest.approx((force - drag) * 10.0, rel=1e-6)


def test_imposed_speed_follows_its_profile():
    """The speed is that of the profile to rounding, in a bend and with any drives.

    The accelerometer feels it.
    """
    parameters, inputs = MANOEUVRES["imposed speed"]
    car = plant(**parameters)
    profile = profile_of(
        parameters["imposed_speed__time"], parameters["imposed_speed__speed"], "linear"
    )
    for n in range(1, 351):
        car.advance(*inputs(n * 0.01))
        assert car.state[VX] == pytest.approx(value_at(profile, n * 0.01), abs=1e-12)
        if n == 150:
            imu = outputs(car)[InertialMeasurement]
            turning = car.state[YAW_RATE] * car.state[VY]
            assert imu.longitudinal_acceleration == pytest.approx(2.0 - turning, abs=1e-6)


def test_speed_imposed_at_the_wheels_is_carried_by_the_tyres():
    """Braking at 5 m/s^2 on a straight: the tyres give m a less drag, by the shares of the axles.

    Less what the spin of the wheels takes (J/r^2 of 4 wheels over m: 3.3 %); that and rolling
    resistance remain for the body.
    """
    braking = {"initial_speed": 30.0, "speed": "imposed", "imposed_speed__time": (0.0, 2.0)}
    car = plant(
        **braking, imposed_speed__speed=(30.0, 20.0), imposed_at="wheels", imposed_front_braking=0.7
    )
    for _ in range(100):
        car.advance(command(), STRAIGHT)
    before = car.state[index("holding_work")]
    car.advance(command(), STRAIGHT)
    force = outputs(car)[TireForces].longitudinal_force
    drag = 0.5 * CAR.air_density * CAR.drag_coefficient * CAR.frontal_area * car.state[VX] ** 2
    wanted = -CAR.mass * 5.0 + drag
    assert sum(force) == pytest.approx(wanted, rel=0.05)
    assert force.front_left + force.front_right == pytest.approx(0.7 * wanted, rel=0.05)
    assert car.state[VX] == pytest.approx(24.95, abs=1e-12)
    assert abs(car.state[index("holding_work")] - before) / 0.01 < 0.05 * abs(wanted) * 25.0


def test_a_car_with_its_mass_right_of_the_middle_is_pulled_to_the_left_when_braked():
    """The brakes act as far left of the mass as that is right of the middle.

    J r' = m a y, less what the tyres hold.
    """
    braking = {"initial_speed": 30.0, "speed": "imposed", "imposed_speed__time": (0.0, 2.0)}
    rates = []
    for offset in (-0.05, 0.05):
        loaded = replace(CAR, centre_of_mass_offset=offset)
        car = plant(loaded, **braking, imposed_speed__speed=(30.0, 20.0), imposed_at="wheels")
        for _ in range(10):
            car.advance(command(), STRAIGHT)
        rates.append(car.state[YAW_RATE])
    free = CAR.mass * 5.0 * 0.05 / CAR.yaw_inertia * 0.1
    assert 0.2 * free < rates[0] < free
    assert rates[1] == -rates[0]


def test_a_held_start_continues_a_steady_bend():
    """Lateral velocity and yaw rate of a bend, held for ten lags of the loads, stay.

    Without the hold carcasses and loads begin at rest, and the car has to catch up: it loses 0.7 %
    of the yaw rate.
    """
    given = {"initial_speed": 15.0, "speed": "imposed", "imposed_speed__speed": (15.0,)}
    bend = steered(0.06)
    steady = plant(**given)
    for _ in range(600):
        steady.advance(command(), bend)
    there = {
        "initial_lateral_velocity": steady.state[VY],
        "initial_yaw_rate": steady.state[YAW_RATE],
    }
    largest = {}
    for hold in (0.0, 0.2):
        car = plant(**given, **there, initial_hold=hold)
        for _ in range(round(hold / 0.01)):
            car.advance(command(), bend)
            assert car.state[YAW_RATE] == there["initial_yaw_rate"]
        errors = []
        for _ in range(100):
            car.advance(command(), bend)
            errors.append(abs(car.state[YAW_RATE] / there["initial_yaw_rate"] - 1.0))
        largest[hold] = max(errors)
    assert largest[0.2] < 1e-3  # what is left of a lag after ten of them is far below
    assert largest[0.0] > 0.005
