"""The battery in the car: limits, regeneration, blended brakes."""

from __future__ import annotations

import pytest
from plant.planar.car import STRAIGHT, command, drive, outputs, plant

from ev_core.vehicle.battery import Battery
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.signals import BatteryCondition, TireForces
from ev_msgs_py.contract.wheels import Wheels
from ev_sim.plant.planar.planar_state import index


def test_battery_limits_hold():
    """Neither drive nor braking torque asks the battery for more than it may give or take."""
    battery = Battery(discharge_power=15e3, charge_power=5e3)
    moved = plant(Vehicle(battery=battery), initial_speed=20.0)
    power = index("battery_power")
    for torque, low, high in ((600.0, 0.0, 15e3), (-300.0, -5e3, 0.0)):
        drive(moved, 1.0, Wheels.front(torque, torque))
        assert low - 1e-3 * 5e3 <= moved.state[power] <= high + 1e-3 * 15e3
    empty = Battery(state_of_charge=0.0)
    moved = plant(Vehicle(battery=empty), initial_speed=20.0)
    drive(moved, 1.0, Wheels.front(300.0, 300.0))
    assert moved.state[index("drive_work")] <= 1e-6


@pytest.mark.parametrize(("charge", "noted"), [(1e-6, True), (0.0, True), (0.5, False)])
def test_an_empty_battery_is_noted(charge, noted):
    """It gives no torque from then on, and the note stays when braking refills it a little."""
    moved = plant(Vehicle(battery=Battery(state_of_charge=charge)), initial_speed=20.0)
    drive(moved, 2.0, Wheels.front(200.0, 200.0))
    drive(moved, 1.0, Wheels.front(-200.0, -200.0))
    assert moved.state[index("state_of_charge")] > 0.0
    assert ("the battery was empty: no drive torque from it" in moved.reports()) == noted


@pytest.mark.parametrize(("lag", "most"), [(0.01, 1.093), (1e-4, 1.007)])
def test_spinning_wheels_overshoot_the_battery_limit_by_what_lag_and_step_take(lag, most):
    """The limit reaches the torque through its lag, at the speed that a step begins with.

    docs/planar_plant.md.
    """
    car = Vehicle(battery=Battery(discharge_power=20e3), motor=Motor(torque_lag=lag))
    moved = plant(car, period=1e-3, road__left=("ice",), road__right=("ice",))
    powers = []
    for _ in range(2000):
        moved.advance(command((400.0, 400.0, 0.0, 0.0)), STRAIGHT)
        powers.append(moved.state[index("battery_power")] / 20e3)
    assert max(powers) == pytest.approx(most, abs=1e-3)


def test_regeneration_charges():
    moved = plant(Vehicle(), initial_speed=20.0)
    before = outputs(moved)[BatteryCondition]
    out = drive(moved, 1.0, Wheels.front(-200.0, -200.0))
    assert out[BatteryCondition].current > 0.0
    assert out[BatteryCondition].charge > before.charge
    assert out[BatteryCondition].voltage > before.voltage


def test_blended_braking_stops_the_car_alike_and_gains_energy():
    """The motors brake as far as they can, the friction brakes do the rest, down to rest."""
    distance, energy = {}, {}
    for blended in (False, True):
        moved = plant(Vehicle(blend_brakes=blended), initial_speed=20.0)
        drive(moved, 10.0, Wheels.all(0.0), brake=350.0)
        assert abs(moved.state[0]) < 1e-6
        distance[blended] = moved.state[index("body_distance")]
        energy[blended] = moved.state[index("battery_work")]
    assert distance[True] == pytest.approx(distance[False], rel=5e-3)
    assert energy[True] < energy[False] - 1e4


@pytest.mark.parametrize("pedal", [0.0, 60.0, -60.0])
@pytest.mark.parametrize("speed", [15.0, -5.0])
def test_blended_brakes_are_exactly_as_strong_as_asked(speed, pedal):
    """Tyres have the force of friction brakes alone, at held speed behind the motors' lag."""
    forces = []
    for blended in (False, True):
        held = plant(Vehicle(blend_brakes=blended), initial_speed=speed, speed="held")
        forces.append(
            drive(held, 2.0, Wheels.front(pedal, pedal), brake=200.0)[TireForces].longitudinal_force
        )
    assert held.state[index("motor_torque")] * speed < 0.0
    assert forces[1] == pytest.approx(forces[0], rel=1e-9)
