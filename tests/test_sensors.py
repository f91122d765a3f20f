"""Sensors between the integrating objects and their topics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fake_network import FakeNetwork, Faults

from ev_msgs_py.configuration import Configuration, configure
from ev_msgs_py.measured import Measured
from ev_msgs_py.parameters import ParameterError, entries
from ev_msgs_py.quantities import QUANTITIES, sensors_for
from ev_msgs_py.roles import ROLES, RoleKind
from ev_msgs_py.sensor import Sensor, sensor_parameters
from ev_msgs_py.signals import (
    BatteryCondition,
    BodyPose,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.topics import TOPICS
from ev_msgs_py.wheels import Wheels
from ev_sim.recording.recording import Recording, signal_hash
from ev_sim.scenario.offline import run_offline
from ev_sim.scenario.scenario import Overrides, load_scenario

RATE = sensor_parameters("rad/s", 10.0)
PERIODS = 20_000
STRAIGHT = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)
COLUMN = [quantity.name for quantity in QUANTITIES if quantity.signal is SteeringColumnState]
EVERYTHING = {"noise": 0.01, "bias": -0.01, "quantisation": 1e-3, "delay": 2, "dropout": 0.1}


def shown(true: np.ndarray, seed: int = 0, name: str = "imu_yaw_rate", **errors: float) -> np.ndarray:
    """What a sensor shows of a row of single numbers."""
    sensor = Sensor(RATE(**errors), seed, name)
    return np.array([sensor.measure((value,))[0] for value in true.tolist()])


# One sensor


def test_noise_is_white_and_gaussian_with_its_standard_deviation():
    """Tolerances of four standard errors: mean 1/sqrt(N), deviation 1/sqrt(2 N), correlation 1/sqrt(N), tail."""
    error = shown(np.full(PERIODS, 5.0), noise=0.2, bias=0.3) - 5.0
    normal = (error - 0.3) / 0.2
    assert abs(normal.mean()) < 4 / math.sqrt(PERIODS)
    assert normal.std() == pytest.approx(1.0, abs=4 / math.sqrt(2 * PERIODS))
    assert abs((normal[1:] * normal[:-1]).mean()) < 4 / math.sqrt(PERIODS)
    beyond = 0.0455  # share beyond two standard deviations
    assert (np.abs(normal) > 2).mean() == pytest.approx(beyond, abs=4 * math.sqrt(beyond / PERIODS))


def test_quantisation_gives_the_nearest_multiple():
    true = np.linspace(-3.0, 3.0, 1001)
    got = shown(true, quantisation=0.1)
    steps = got / 0.1
    assert np.abs(steps - np.round(steps)).max() < 1e-12
    assert np.abs(got - true).max() <= 0.05 + 1e-12
    assert len(set(got.tolist())) == 61  # one number for each step, to the last bit


def test_delay_is_whole_periods_and_the_first_value_holds_until_then():
    true = np.arange(10.0)
    assert shown(true, delay=3).tolist() == [0, 0, 0, 0, 1, 2, 3, 4, 5, 6]


def test_a_lost_value_leaves_the_last_one():
    """A ramp: each shown value is the true one of this period or what was shown before."""
    true = np.arange(1.0, PERIODS + 1)
    got = shown(true, dropout=0.3)
    lost = got != true
    assert got[0] == 1.0
    assert (got[1:][lost[1:]] == got[:-1][lost[1:]]).all()
    assert lost.mean() == pytest.approx(0.3, abs=4 * math.sqrt(0.3 * 0.7 / PERIODS))
    assert shown(true, dropout=1.0).tolist() == [1.0] * PERIODS


def test_no_parameter_changes_what_is_drawn():
    """Noise alone, with bias, with delay, and with drop-out: the same noise at the same time."""
    true = np.zeros(500)
    noise = shown(true, noise=0.5)
    assert (shown(true, noise=1.0) == 2 * noise).all()
    assert (shown(true, noise=0.5, bias=1.0) == 1.0 + noise).all()
    assert (shown(true, noise=0.5, delay=2)[2:] == noise[:-2]).all()
    with_losses = shown(true, noise=0.5, dropout=0.5)
    lost = shown(np.arange(500.0), dropout=0.5) != np.arange(500.0)
    assert 150 < lost.sum() < 350
    assert (with_losses[~lost] == noise[~lost]).all()


def test_seed_and_name_choose_the_random_numbers():
    true = np.zeros(100)
    noise = shown(true, noise=1.0)
    assert (shown(true, noise=1.0) == noise).all()
    for other in ({"seed": 1}, {"name": "body_yaw_rate"}):
        assert abs(np.corrcoef(noise, shown(true, noise=1.0, **other))[0, 1]) < 0.4  # four standard errors


def test_the_random_numbers_are_these():
    """Recorded: numpy may change how it makes normal numbers, and runs with noise would silently be others."""
    recorded = [1.0752267780041265, 0.3700245727513761, 1.2661482178086334]
    assert shown(np.zeros(3), noise=1.0, seed=7).tolist() == recorded


# The table of quantities


def test_every_published_number_of_plant_and_column_has_one_sensor():
    """But the capacity of the battery, which is no measurement."""
    for role in ROLES.values():
        for signal in role.writes if role.kind is RoleKind.INTEGRATES else ():
            measured = [name for quantity in QUANTITIES if quantity.signal is signal for name in quantity.fields]
            assert sorted([*measured, *(["capacity"] if signal is BatteryCondition else [])]) == sorted(
                TOPICS[signal].codec.shape.fields
            )


def test_numbers_of_one_sensor_have_one_unit():
    for quantity in QUANTITIES:
        if quantity.name != "battery_state_of_charge":  # of which the charge is another way to say it
            assert len({TOPICS[quantity.signal].units[name] for name in quantity.fields}) == 1
    units = {entry.name: entry.spec.unit for entry in entries(sensors_for(ROLES["plant"].writes), "sensors.")}
    assert units["sensors.wheel_speed.noise"] == "rad/s"
    assert units["sensors.body_heading.bias"] == "rad"
    assert units["sensors.battery_state_of_charge.quantisation"] == "1"


def behind(role: str, **values: object) -> object:
    """A new object of a role behind sensors; double underscores stand for dots."""
    sensors = {f"sensors.{name.replace('__', '.')}": value for name, value in values.items() if name != "method"}
    return configure(role, {"method": values.get("method", ROLES[role].default_method), **sensors}).create()


def outputs(made: object) -> dict[type, object]:
    return {type(signal): signal for signal in made.outputs()}


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda quantity: quantity.name)
def test_a_bias_shows_in_its_own_numbers_and_nowhere_else(quantity):
    role = next(role for role in ROLES.values() if quantity.signal in role.writes)
    method = "planar" if role.name == "plant" else "powered"
    true = outputs(behind(role.name, method=method))
    biased = outputs(behind(role.name, method=method, **{f"{quantity.name}__bias": 0.125}))
    assert quantity.read(biased[quantity.signal]) == pytest.approx(
        [0.125 + number for number in quantity.read(true[quantity.signal])], rel=1e-15
    )
    for signal, at_rest in true.items():
        for name in TOPICS[signal].codec.shape.fields:
            if signal is not quantity.signal or name not in quantity.fields:
                assert getattr(biased[signal], name) == getattr(at_rest, name)
    assert list(biased) == list(true)


def test_heading_and_charge_stay_consistent():
    shown = outputs(behind("plant", method="planar", body_heading__noise=2.0, battery_state_of_charge__noise=0.1))
    pose, battery = shown[BodyPose], shown[BatteryCondition]
    assert pose.heading != 0.0
    assert math.hypot(pose.orientation_z, pose.orientation_w) == pytest.approx(1.0, rel=1e-15)
    assert battery.state_of_charge != pytest.approx(0.8, abs=1e-6)
    assert battery.charge == battery.state_of_charge * battery.capacity


# Around an object


def test_ideal_sensors_are_not_there():
    """So they cost nothing; a seed alone makes no noise."""
    made = configure("plant", {"seed": 3}).create()
    assert type(made).__name__ == "KinematicPlant"
    assert isinstance(behind("plant", wheel_speed__delay=1), Measured)


def test_outputs_are_measured_once_per_period():
    plant = behind("plant", imu_yaw_rate__noise=1.0)
    first = plant.outputs()
    assert plant.outputs() == first
    plant.advance(WheelTorqueCommand(Wheels.all(0.0)), STRAIGHT)
    assert plant.outputs() != first


def test_sensors_do_not_touch_the_state():
    """The same commands move the car alike, whatever is measured."""
    bare = behind("plant", method="planar")
    quantities = [quantity.name for quantity in QUANTITIES if quantity.signal is not SteeringColumnState]
    errors = {f"{name}__{error}": value for name in quantities for error, value in EVERYTHING.items()}
    made = behind("plant", method="planar", **errors)
    for k in range(50):
        command = WheelTorqueCommand(Wheels.front(100.0 + k, 200.0))
        for plant in (bare, made):
            plant.advance(command, STRAIGHT)
            plant.outputs()
    assert made.state.tobytes() == bare.state.tobytes()
    assert made.diagnostics == bare.diagnostics
    assert not any(a == b for a, b in zip(made.outputs(), bare.outputs(), strict=True))


def test_a_successor_of_a_running_object_goes_on_with_its_state():
    """As when a parameter is set while the node runs: on, changed, off."""
    plant = behind("plant", method="planar")
    for sensors in ({"imu_yaw_rate__delay": 2}, {"imu_yaw_rate__delay": 4, "wheel_speed__bias": 0.5}, {}):
        for _ in range(10):
            plant.advance(WheelTorqueCommand(Wheels.front(100.0, 300.0)), STRAIGHT)
            plant.outputs()
        successor = behind("plant", method="planar", **sensors)
        successor.state = plant.state
        plant = successor
        plant.advance(WheelTorqueCommand(Wheels.front(100.0, 300.0)), STRAIGHT)
        assert outputs(plant)[InertialMeasurement].yaw_rate == plant.state[2] != 0.0  # the first value is a present one


def test_sensors_of_signals_that_a_method_does_not_write_are_unused():
    values = {"sensors.tire_load.noise": 10.0, "sensors.wheel_speed.noise": 0.1}
    made = configure("plant", {"method": "kinematic", **values})
    assert made.unused == ("sensors.tire_load.noise",)
    assert not [name for name in made.values() if name.startswith("sensors.tire")]
    assert configure("plant", {"method": "planar", **values}).unused == ()


@pytest.mark.parametrize(
    ("role", "name", "value", "message"),
    [
        ("plant", "wheel_speed.noise", -0.1, "sensors.wheel_speed.noise: -0.1 is refused, allowed is 0 to 100 rad/s"),
        ("plant", "tire_load.dropout", 1.5, "sensors.tire_load.dropout: 1.5 is refused, allowed is 0 to 1"),
        ("plant", "imu_yaw_rate.delay", 0.5, "sensors.imu_yaw_rate.delay: 0.5 is refused, allowed is a whole number"),
        ("plant", "wheel_sped.noise", 0.1, "unknown parameter of plant 'sensors.wheel_sped.noise'; known: sensors."),
        ("steering_column", "wheel_speed.noise", 0.1, "unknown parameter of steering_column 'sensors.wheel_speed."),
        ("driver", "wheel_speed.noise", 0.1, "unknown parameter of driver 'sensors.wheel_speed.noise'"),
    ],
)
def test_bad_sensor_parameters_are_refused(role, name, value, message):
    with pytest.raises(ParameterError, match=message):
        configure(role, {f"sensors.{name}": value})


# In the graph


def graph(seed: int = 0, **values: object) -> dict[str, Configuration]:
    """The paper's car with sensors: `node__quantity__error`."""
    names = [name.split("__") for name in values]
    overrides = [(node, f"sensors.{q}.{e}", v) for (node, q, e), v in zip(names, values.values(), strict=True)]
    return dict(load_scenario("shchur2019", Overrides(values=[*overrides, ("*", "seed", seed)])).runs[0].configurations)


def differing(one: Recording, other: Recording) -> set[str]:
    return {name for name in one.channels if (one.channels[name] != other.channels[name]).any()}


def test_a_sensor_that_nobody_reads_changes_its_own_channels_only():
    """Shchur's laws do not read the imu: truth stays truth, and another sensor's noise stays the same."""
    true = run_offline(graph(), 2.0)
    assert signal_hash(run_offline(graph(seed=5), 2.0)) == signal_hash(true)
    one = run_offline(graph(plant__imu_yaw_rate__noise=0.01), 2.0)
    assert differing(one, true) == {"imu.yaw_rate"}
    two = run_offline(graph(plant__imu_yaw_rate__noise=0.01, plant__motor_torque__noise=1.0), 2.0)
    assert differing(two, one) == {f"motor_states.effort.{wheel}" for wheel in Wheels._fields}


def test_seed_decides_the_run():
    noisy = {"plant__wheel_torque__noise": 5.0, "steering_column__steering_angle__noise": 1e-3}
    hashes = [signal_hash(run_offline(graph(seed, **noisy), 1.0)) for seed in (1, 1, 2)]
    assert hashes[0] == hashes[1] != hashes[2]


def test_lost_messages_and_a_reset_do_not_change_what_sensors_show():
    """The nodes' steppers on a faulty network give the offline run, bit by bit, and once more after a reset."""
    sensors = {"plant": ("wheel_speed", "wheel_torque", "body_velocity", "body_heading"), "steering_column": COLUMN}
    names = [f"{role}__{quantity}" for role, quantities in sensors.items() for quantity in quantities]
    errors = {f"{name}__{error}": value for name in names for error, value in EVERYTHING.items()}
    configurations = graph(seed=4, **errors)
    offline = run_offline(configurations, 1.0)
    network = FakeNetwork(configurations, 100, seed=1, faults=Faults(0.1, 0.1, 0.001))
    for _ in range(2):
        network.forgives = True  # messages of the run before the reset may still be under way
        network.begin()
        network.run()
        assert network.signals() == {
            name: [float.hex(number) for number in column.tolist()] for name, column in offline.channels.items()
        }


def test_plant_and_column_read_each_other_as_measured():
    """The actuator that turns the road wheels trusts its sensor: a bias of the road-wheel angle steers the car."""
    values = {"steering_column__road_wheel_angle__bias": 0.01}
    measured = run_offline(graph(**values), 6.0).channels
    speed, yaw_rate = measured["twist.longitudinal"][-1], measured["twist.yaw_rate"][-1]
    assert speed > 3.0
    assert yaw_rate == pytest.approx(speed * math.tan(0.01) / 2.405, rel=1e-3)


def test_wheel_speed_noise_reaches_the_wheels_independently():
    speeds = []
    plant = behind("plant", wheel_speed__noise=0.1)
    for _ in range(2000):
        speeds.append(outputs(plant)[WheelStates].velocity)
        plant.advance(WheelTorqueCommand(Wheels.all(0.0)), STRAIGHT)
    correlation = np.corrcoef(np.array(speeds).T) - np.eye(4)
    assert np.abs(correlation).max() < 4 / math.sqrt(2000)
