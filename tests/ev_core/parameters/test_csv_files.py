"""Files that parameters name.

Where they are looked for, efficiency maps, and what is refused in one line.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from plant.planar.car import STRAIGHT, plant

from ev_core.lockstep.configuration import configure
from ev_core.parameters.data_file import find_file
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.files import with_map_from_file
from ev_core.vehicle.losses import loss_power
from ev_core.vehicle.motor import Motor
from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.planar_state import index
from ev_stack.scenarios.parameter_file import ParameterFile

ROOT = Path(__file__).parents[3]
HEADER = "speed_rpm,torque_nm,efficiency\n"


def vehicle_with(file: Path | str) -> Vehicle:
    return Vehicle(motor=Motor(map_file=str(file)))


def class_b(**motor: object) -> Vehicle:
    values = ParameterFile(ROOT / "config/vehicles/dissertation_class_b.yaml").values_for(
        "/ev/plant"
    )
    return configure(
        "plant", {**values, **{f"vehicle.motor.{k}": v for k, v in motor.items()}}
    ).common.vehicle


def test_a_relative_name_counts_from_the_config_folder_first(tmp_path, monkeypatch):
    config, here = tmp_path / "config", tmp_path / "here"
    for folder in (config, here):
        folder.mkdir()
        (folder / "both.csv").touch()
    (here / "mine.csv").touch()
    monkeypatch.setenv("EV_STACK_CONFIG", str(config))
    monkeypatch.chdir(here)
    assert find_file("both.csv") == config / "both.csv"
    assert find_file("mine.csv").resolve() == here / "mine.csv"
    assert find_file(str(here / "both.csv")) == here / "both.csv"


def test_speed_profile_and_map_follow_the_same_rule(tmp_path, monkeypatch):
    monkeypatch.setenv("EV_STACK_CONFIG", str(tmp_path))
    (tmp_path / "cycle.csv").write_text("# made up\n\nt_s,v_mps\n0,1\n\n# comment\n2,3\n")
    (tmp_path / "map.csv").write_text(
        "speed_radps,torque_nm,efficiency\n1,2,.8\n3,2,.9\n3,4,.7\n1,4,.6\n"
    )
    driver = configure("driver", {"speed_profile.file": "cycle.csv"}).parameters
    assert (driver.speed_profile.time, driver.speed_profile.speed) == ((0.0, 2.0), (1.0, 3.0))
    for role in REQUIRED:  # the vehicle is one for all: a law may know the map too
        motor = configure(role, {"vehicle.motor.map_file": "map.csv"}).common.vehicle.motor
        assert (motor.map_speed, motor.map_torque) == ((1.0, 3.0), (2.0, 4.0))
        assert motor.map_efficiency == (0.8, 0.6, 0.9, 0.7)
        assert motor.map_file == ""


def test_without_a_config_folder_the_way_out_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("EV_STACK_CONFIG", str(tmp_path / "gone"))
    with pytest.raises(
        ParameterError,
        match=r"^vehicle.motor.map_file: map.csv: the config folder .*gone, named by",
    ):
        with_map_from_file(vehicle_with("map.csv"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "speed,torque_nm,efficiency\n",
            "no header with the columns one of speed_radps and speed_rpm, torque_nm",
        ),
        (
            "speed_rpm,torque_nm,efficiency,torque_nm\n",
            "line 1: column torque_nm is listed twice, expected once",
        ),
        (
            HEADER + "10,1,0.9\n20,1,0.9\n10,2,0.9\n",
            "2.0944 rad/s and 2 N m is there 0 times, expected once",
        ),
        (HEADER + "10,1,0.9\n10,1,0.8\n", "1.0472 rad/s and 1 N m is there 2 times, expected once"),
        (
            HEADER + "10,1,0.9\n20,1,1.1\n10,2,1\n20,2,1\n",
            r"map_efficiency: .*1.1.* is refused, expected 0.01 to 1",
        ),
        (HEADER + "10,1,0.9\n20,1,0.9\n", "map_torque needs at least two elements and must rise"),
        (HEADER + "10,1,0.9\n20,one,0.9\n", "line 3: torque_nm is no finite number"),
        (
            HEADER + "10,1,1\n20,1,0,95\n",
            "line 3: 4 columns, expected at most 3, as in the header, and a point in dec",
        ),
    ],
)
def test_bad_maps_are_refused_in_one_line(tmp_path, text, message):
    path = tmp_path / "map.csv"
    path.write_text(text)
    with pytest.raises(ParameterError, match=message) as error:
        with_map_from_file(vehicle_with(path))
    assert str(error.value).startswith(f"vehicle.motor.map_file: {path}: ")
    assert "\n" not in str(error.value)


def test_the_plant_opens_no_files(tmp_path):
    with pytest.raises(
        ParameterError, match=r"^vehicle.motor.map_file: map.csv has not been read into the map$"
    ):
        plant(vehicle_with("map.csv"))


def test_the_example_map_is_that_of_the_loss_model():
    """Its header names the model; the numbers have four digits."""
    motor = class_b(map_file="efficiency_maps/yasa_400.csv").motor
    efficiency = iter(motor.map_efficiency)
    for speed in motor.map_speed:
        for torque in motor.map_torque:
            power = speed * torque
            expected = power / (power + loss_power(motor, torque, speed))
            assert next(efficiency) == pytest.approx(expected, abs=0.51e-4)
    assert motor.map_speed[-1] == pytest.approx(motor.maximum_speed, rel=1e-6)
    assert motor.map_torque[-1] == motor.peak_torque
    assert max(motor.map_efficiency) == 0.9772  # as the vehicle file says


@pytest.mark.parametrize("initial_speed", [5.0, 0.0])
def test_a_drive_takes_the_same_energy_with_the_map_as_with_the_loss_model(initial_speed):
    """Within 1 % between the map's points.

    Accelerating from 5 m/s or from rest, then braking electrically.
    """
    loss = {}
    for file in ("", "efficiency_maps/yasa_400.csv"):
        car = plant(class_b(map_file=file), initial_speed=initial_speed)
        for torque in [900.0] * 500 + [-500.0] * 300:
            car.advance(WheelTorqueCommand(Wheels.front(torque, torque)), STRAIGHT)
        loss[file] = car.state[index("motor_loss")]
    by_model, by_map = loss.values()
    assert by_map == pytest.approx(by_model, rel=0.01)
    assert by_model > 1e4  # J


def test_a_vehicle_without_a_file_stays_as_it_is():
    car = dataclasses.replace(Vehicle(), mass=1000.0)
    assert with_map_from_file(car) is car
