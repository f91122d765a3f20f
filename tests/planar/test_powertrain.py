"""Motors, drivelines, brakes and battery of the planar plant."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ev_msgs_py.parameters import build
from ev_msgs_py.signals import BatteryCondition, SteeringColumnState, WheelStates, WheelTorqueCommand
from ev_msgs_py.vehicle import Battery, Driveline, Motor, Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels
from ev_sim.battery.resistive import current_at_power, open_circuit_voltage
from ev_sim.driveline.couplings import wheel_torques
from ev_sim.drives.losses import loss_power, map_loss_power
from ev_sim.drives.torque_controlled import limited_torque
from ev_sim.plant.planar.plant import PlanarParameters, PlanarPlant
from ev_sim.plant.planar.state import index

STRAIGHT = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)
LIMITS = {
    "peak_torque": 300.0,
    "nominal_torque": 200.0,
    "peak_power": 60e3,
    "maximum_speed": 800.0,
    "generator_torque": 150.0,
    "generator_power": 20e3,
}


def drive(plant: PlanarPlant, seconds: float, torques: Wheels, brake: float = 0.0) -> dict[type, object]:
    for _ in range(round(seconds / 0.01)):
        plant.advance(WheelTorqueCommand(torques, Wheels.all(brake)), STRAIGHT)
    return {type(signal): signal for signal in plant.outputs()}


@pytest.mark.parametrize(
    ("wanted", "speed", "heat", "expected"),
    [
        (500.0, 100.0, 0.0, 300.0),  # peak torque
        (250.0, 300.0, 0.0, 200.0),  # peak power
        (500.0, 100.0, 1.2, 200.0),  # hot: nominal torque
        (100.0, 801.0, 0.0, 0.0),  # beyond the maximum speed
        (-500.0, 100.0, 0.0, -150.0),  # generator torque
        (-500.0, 400.0, 0.0, -50.0),  # generator power
        (-500.0, -100.0, 0.0, -300.0),  # driving backwards
        (500.0, -400.0, 0.0, 50.0),  # generating backwards
    ],
)
def test_motor_limits(wanted, speed, heat, expected):
    assert limited_torque(wanted, speed, heat, *LIMITS.values()) == pytest.approx(expected)


def test_torque_lag_is_first_order():
    """63.2 % after one time constant; the impulse over it is tau/e, exactly, whatever the step."""
    car = PlanarPlant(PlanarParameters(), Vehicle(motor=Motor(torque_lag=0.05)), 0.01)
    impulse = 0.0
    for _ in range(5):
        out = drive(car, 0.01, Wheels.front(100.0, 100.0))
        impulse += out[WheelStates].effort.front_left * 0.01
    assert car.state[index("motor_torque")] * 2.65 == pytest.approx(100.0 * (1.0 - math.exp(-1.0)))
    assert impulse == pytest.approx(100.0 * 0.05 / math.e)


def test_losses_and_efficiency_map_agree():
    """A map made from the loss model gives the loss model's values at its points, driving and generating."""
    speeds, torques = np.linspace(50.0, 500.0, 4), np.linspace(20.0, 200.0, 5)
    of_loss = (0.05, 0.5, 5e-4, 20.0, 1.0)
    power = speeds[:, None] * torques[None, :]
    loss = np.array([[loss_power(t, w, *of_loss) for t in torques] for w in speeds])
    efficiency = power / (power + loss)
    by_speed = efficiency.ravel()
    assert map_loss_power(torques[2], speeds[1], speeds, torques, by_speed) == pytest.approx(loss[1, 2])
    generated = map_loss_power(-torques[2], speeds[1], speeds, torques, by_speed)
    assert generated == pytest.approx(power[1, 2] * (1.0 - efficiency[1, 2]))


def test_efficiency_map_in_the_plant():
    motor = Motor(map_speed=(100.0, 400.0), map_torque=(10.0, 100.0), map_efficiency=(0.8, 0.9, 0.85, 0.95))
    car = PlanarPlant(PlanarParameters(initial_speed=10.0), Vehicle(motor=motor), 0.01)
    drive(car, 1.0, Wheels.front(265.0, 265.0))
    given, used = car.state[index("battery_work")], car.state[index("drive_work")]
    assert used / given == pytest.approx(0.9, abs=0.02)  # at 100 N m and about 100 rad/s


SPEEDS, TORQUES = np.array([50.0, 100.0, 400.0]), np.array([10.0, 100.0])
EFFICIENCY = np.array([0.5, 0.6, 0.8, 0.7, 0.85, 0.95])  # for each speed a row over the torques


def test_torque_at_standstill_costs_what_the_lowest_speed_of_the_map_does():
    """100 N m at 50 rad/s and 0.6: 5000 W (1/0.6 - 1), whichever way the motor is about to turn; no torque, no loss."""
    for speed in (0.0, 1e-12, -1e-12, 25.0, 50.0):
        assert map_loss_power(100.0, speed, SPEEDS, TORQUES, EFFICIENCY) == pytest.approx(5000.0 * (1 / 0.6 - 1.0))
    assert map_loss_power(-100.0, 0.0, SPEEDS, TORQUES, EFFICIENCY) == pytest.approx(5000.0 * (1 / 0.6 - 1.0))
    assert map_loss_power(0.0, 0.0, SPEEDS, TORQUES, EFFICIENCY) == 0.0


def test_a_row_at_standstill_is_not_looked_at():
    """At speed zero every efficiency means the same power, none."""
    speeds = np.array([0.0, *SPEEDS])
    for row in (0.01, 1.0):
        efficiency = np.concatenate((np.full(2, row), EFFICIENCY))
        for torque, speed in ((100.0, 0.0), (100.0, 20.0), (-60.0, 20.0)):
            assert map_loss_power(torque, speed, speeds, TORQUES, efficiency) == map_loss_power(
                torque, speed, SPEEDS, TORQUES, EFFICIENCY
            )


@pytest.mark.parametrize("torque", [100.0, -100.0, 37.0])
def test_losses_of_a_map_have_no_jumps(torque):
    """Steps of 0.01 rad/s from reverse through rest to beyond the map: 1 W, the steepest part is 67 W s/rad."""
    speeds = np.arange(-450.0, 450.0, 0.01)
    losses = np.array([map_loss_power(torque, speed, SPEEDS, TORQUES, EFFICIENCY) for speed in speeds])
    assert np.abs(np.diff(losses)).max() < 1.0
    assert losses.min() > 0.0


def test_holding_a_car_by_its_motors_empties_the_battery():
    """A second at rest under brakes with 100 N m at each motor: twice 5000 W (1/0.6 - 1), and the auxiliaries."""
    motor = Motor(map_speed=(50.0, 100.0, 400.0), map_torque=(10.0, 100.0), map_efficiency=tuple(EFFICIENCY))
    car = PlanarPlant(PlanarParameters(), Vehicle(motor=motor, battery=Battery(auxiliary_power=300.0)), 0.01)
    drive(car, 3.0, Wheels.front(265.0, 265.0), brake=1000.0)
    before = car.state.copy()
    drive(car, 1.0, Wheels.front(265.0, 265.0), brake=1000.0)
    loss, given, used = (
        car.state[index(name)] - before[index(name)] for name in ("motor_loss", "battery_work", "auxiliary_work")
    )
    assert loss == pytest.approx(2 * 5000.0 * (1 / 0.6 - 1.0), rel=1e-6)
    assert used == pytest.approx(300.0, rel=1e-6)
    assert given == pytest.approx(loss + used, rel=1e-6)


def test_open_differential_passes_equal_torque():
    car = Vehicle(driven_wheels=("rear_left", "rear_right"), driveline=Driveline(coupling="open"))
    road = build(PlanarParameters, {"road.left": ("ice",)})
    out = drive(PlanarPlant(road, car, 0.01), 1.0, Wheels.rear(500.0, 100.0))
    assert out[WheelStates].effort.rear_left == out[WheelStates].effort.rear_right == pytest.approx(300.0)
    assert out[WheelStates].velocity.rear_left > 5 * out[WheelStates].velocity.rear_right


def test_limited_slip_differential_helps_the_wheel_with_grip():
    """The slower wheel gets the locking torque more, and the car pulls away faster than with an open differential."""
    torques = np.zeros(4)
    motor, speed, driven = np.array([0, 0, 300.0, 300.0]), np.array([0, 0, 90.0, 5.0]), np.array([0, 0, 1.0, 1.0])
    wheel_torques(2, motor, speed, driven, np.zeros(4), 50.0, 0.3, 1.0, torques)
    assert torques[3] - torques[2] == pytest.approx(50.0 + 0.3 * 600.0)
    assert torques.sum() == pytest.approx(600.0)
    reached = {}
    for coupling in ("open", "limited_slip"):
        car = Vehicle(driven_wheels=("rear_left", "rear_right"), driveline=Driveline(coupling=coupling))
        road = build(PlanarParameters, {"road.left": ("ice",)})
        plant = PlanarPlant(road, car, 0.01)
        drive(plant, 2.0, Wheels.rear(300.0, 300.0))
        reached[coupling] = plant.state[0]
        assert plant.state[index("driveline_loss")] > -1e-6
    assert reached["limited_slip"] > 1.2 * reached["open"]


def test_clutch_shares_follow_with_their_lag():
    """A step of the share is followed by 63.2 % after 0.1 s (Zhileykin)."""
    car = Vehicle(driven_wheels=WHEEL_NAMES, driveline=Driveline(coupling="clutch"))
    plant = PlanarPlant(PlanarParameters(), car, 0.01)
    drive(plant, 1.0, Wheels.rear(100.0, 100.0))
    drive(plant, 0.1, Wheels.all(50.0))
    share = plant.state[index("torque_share") :][:4]
    assert share[0] == pytest.approx(0.25 * (1.0 - math.exp(-1.0)), rel=1e-3)
    assert share.sum() == pytest.approx(1.0)


def test_battery_current_and_voltage():
    table = np.array([400.0, 420.0, 440.0])
    assert open_circuit_voltage(table, 0.25) == pytest.approx(410.0)
    current = current_at_power(420.0, 0.1, 40e3)
    assert (420.0 - 0.1 * current) * current == pytest.approx(40e3)
    assert current_at_power(420.0, 0.1, -20e3) < 0.0


def test_battery_limits_hold():
    """Neither drive nor braking torque asks the battery for more than it may give or take."""
    battery = Battery(discharge_power=15e3, charge_power=5e3)
    plant = PlanarPlant(PlanarParameters(initial_speed=20.0), Vehicle(battery=battery), 0.01)
    power = index("battery_power")
    for torque, low, high in ((600.0, 0.0, 15e3), (-300.0, -5e3, 0.0)):
        drive(plant, 1.0, Wheels.front(torque, torque))
        assert low - 1e-3 * 5e3 <= plant.state[power] <= high + 1e-3 * 15e3
    empty = Battery(state_of_charge=0.0)
    plant = PlanarPlant(PlanarParameters(initial_speed=20.0), Vehicle(battery=empty), 0.01)
    drive(plant, 1.0, Wheels.front(300.0, 300.0))
    assert plant.state[index("drive_work")] <= 1e-6


def test_regeneration_charges():
    plant = PlanarPlant(PlanarParameters(initial_speed=20.0), Vehicle(), 0.01)
    before = plant.outputs()[5]
    out = drive(plant, 1.0, Wheels.front(-200.0, -200.0))
    assert isinstance(before, BatteryCondition)
    assert out[BatteryCondition].current > 0.0
    assert out[BatteryCondition].charge > before.charge
    assert out[BatteryCondition].voltage > before.voltage


def test_blended_braking_stops_the_car_alike_and_gains_energy():
    """The motors take their part of the brake torque as far as they can, the friction brakes the rest, down to rest."""
    distance, energy = {}, {}
    for blended in (False, True):
        plant = PlanarPlant(PlanarParameters(initial_speed=20.0), Vehicle(blend_brakes=blended), 0.01)
        drive(plant, 10.0, Wheels.all(0.0), brake=350.0)
        assert abs(plant.state[0]) < 1e-6
        distance[blended] = plant.state[index("body_distance")]
        energy[blended] = plant.state[index("battery_work")]
    assert distance[True] == pytest.approx(distance[False], rel=5e-3)
    assert energy[True] < energy[False] - 1e4


def test_overload_ends_at_the_nominal_torque():
    motor = Motor(overload_time=2.0, peak_torque=250.0, nominal_torque=150.0)
    plant = PlanarPlant(build(PlanarParameters, {"road.grade": (0.1,)}), Vehicle(motor=motor), 0.01)
    out = drive(plant, 0.5, Wheels.front(500.0, 500.0))
    assert out[WheelStates].effort.front_left == pytest.approx(500.0, rel=1e-3)
    out = drive(plant, 5.0, Wheels.front(500.0, 500.0))
    assert out[WheelStates].effort.front_left == pytest.approx(150.0 * 2.65, rel=0.06)


@pytest.mark.parametrize("kind", ["ideal", "averaged", "switched"])
def test_brushless_drives_plug_in(kind):
    """The drives of Shchur's car give the commanded torque in the mean, and their losses are in the balance."""
    plant = PlanarPlant(PlanarParameters(drive=kind, initial_speed=4.0), Vehicle(), 0.01)
    out = drive(plant, 1.0, Wheels.front(100.0, 100.0))
    mean = np.mean([drive(plant, 0.01, Wheels.front(100.0, 100.0))[WheelStates].effort[0] for _ in range(50)])
    assert mean == pytest.approx(100.0, rel=0.03)
    assert out[WheelStates].velocity.front_left > 4.0 / 0.294
    state = plant.state
    balance = state[index("motor_loss")] + state[index("driveline_loss")] + state[index("drive_work")]
    assert state[index("battery_work")] == pytest.approx(balance, rel=1e-9)
    copper = 2 * 2 * 0.15 * (100.0 / 2.65 / 4.0) ** 2 * 1.5  # two motors, two phases, i = M/(2 p psi), 1.5 s [J]
    assert state[index("motor_loss")] == pytest.approx(0.0 if kind == "ideal" else copper, rel=0.15, abs=1.0)


def test_equal_rotors_add_to_the_wheels():
    """Acceleration on a level road: M/r over m + sum(J)/r^2, with the rotors behind their gears."""
    car = Vehicle(rolling_resistance=0.0, drag_coefficient=0.0, motor=Motor(rotor_inertia=0.1))
    plant = PlanarPlant(PlanarParameters(initial_speed=5.0), car, 0.01)
    drive(plant, 0.5, Wheels.front(50.0, 50.0))
    before = plant.state[0]
    drive(plant, 0.5, Wheels.front(50.0, 50.0))
    inertia = 4 * 1.0 + 2 * 0.1 * 2.65**2
    expected = 100.0 / 0.294 / (1400.0 + inertia / 0.294**2)
    assert (plant.state[0] - before) / 0.5 == pytest.approx(expected, rel=2e-3)
