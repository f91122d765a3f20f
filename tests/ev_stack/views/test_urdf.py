"""The car as URDF: geometry, masses and joints of the vehicle file."""

from __future__ import annotations

from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest

from ev_core.parameters.data_file import files_in_config
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.commands.descriptions import print_urdf
from ev_stack.scenarios.files import vehicle_of
from ev_stack.views.urdf import urdf

VEHICLES = sorted(files_in_config("vehicles"))


def numbers(text: str) -> np.ndarray:
    return np.array([float(number) for number in text.split()])


def links(robot: Element) -> dict[str, tuple[np.ndarray, float, np.ndarray]]:
    """Centre of mass from base_link [m], mass [kg] and inertia there [kg m^2] of each link."""
    parents = {
        joint.find("child").get("link"): (
            joint.find("parent").get("link"),
            numbers(joint.find("origin").get("xyz")),
        )
        for joint in robot.findall("joint")
    }
    found = {}
    for link in robot.findall("link"):
        if (inertial := link.find("inertial")) is None:
            continue
        at, name = numbers(inertial.find("origin").get("xyz")), link.get("name")
        while name in parents:
            name, offset = parents[name]
            at = at + offset
        assert name == "base_link"
        moments = np.array(
            [float(inertial.find("inertia").get(axis)) for axis in ("ixx", "iyy", "izz")]
        )
        found[link.get("name")] = at, float(inertial.find("mass").get("value")), moments
    return found


@pytest.mark.parametrize("name", VEHICLES)
def test_the_parts_weigh_what_the_car_weighs(name):
    """Mass, its centre and yaw inertia of all links, by Steiner, are the vehicle's."""
    car = vehicle_of(name)
    parts = links(fromstring(urdf(car)))
    assert len(parts) == 1 + 2 * len(WHEEL_NAMES)
    mass = sum(each[1] for each in parts.values())
    centre = sum(each[1] * each[0] for each in parts.values()) / mass
    assert mass == pytest.approx(car.mass, rel=1e-7)  # nine digits are written
    assert centre == pytest.approx([0.0, 0.0, car.centre_of_mass_height], abs=1e-6)
    yaw = sum(moments[2] + m * (at[0] ** 2 + at[1] ** 2) for at, m, moments in parts.values())
    assert yaw == pytest.approx(car.yaw_inertia, rel=1e-6)
    for _, m, moments in parts.values():
        assert m > 0.0 and min(moments) > 0.0
        # as no body can have else
        assert all(2.0 * moment <= moments.sum() * (1.0 + 1e-6) for moment in moments)
    spins = [parts[f"{wheel}_wheel"][2][1] for wheel in WHEEL_NAMES]
    ratios = [
        1.0 if wheel in car.driven_wheels else car.undriven_inertia_ratio for wheel in WHEEL_NAMES
    ]
    assert spins == pytest.approx([car.wheel_inertia * ratio for ratio in ratios], rel=1e-7)


def test_the_urdf_has_the_geometry_of_the_vehicle_file(capsys):
    print_urdf(["audi_a2"])
    robot = fromstring(capsys.readouterr().out)
    joints = {joint.get("name"): joint for joint in robot.findall("joint")}
    assert {name: joints[name].get("type") for name in WHEEL_NAMES} == dict.fromkeys(
        WHEEL_NAMES, "continuous"
    )
    places = {
        name: numbers(joints[f"{name}_steering"].find("origin").get("xyz")) for name in WHEEL_NAMES
    }
    assert places["front_left"][0] - places["rear_left"][0] == pytest.approx(2.405)  # wheelbase, m
    assert places["front_left"][1] - places["front_right"][1] == pytest.approx(1.462)  # track, m
    assert places["rear_left"][0] == pytest.approx(-1.08225)  # the centre of mass is the origin
    assert {place[2] for place in places.values()} == {0.294}  # the wheels stand on the ground
    for link in robot.findall("link"):
        shapes = [link.find(use) for use in ("visual", "collision")]
        assert (shapes[0] is None) == (shapes[1] is None)


@pytest.mark.parametrize(
    ("car", "apart", "rear"),
    [
        (Vehicle(), False, 0.0),
        (Vehicle(), True, 0.7),
        (Vehicle(rear_steering_ratio=-0.2), False, 0.7),
    ],
    ids=["front steered", "steered rear axle", "rear wheels follow the front"],
)
def test_wheels_steer_as_far_as_the_car_lets_them(car, apart, rear):
    robot = fromstring(urdf(car, apart))
    for name in WHEEL_NAMES:
        joint = robot.find(f"joint[@name='{name}_steering']")
        assert (joint.get("type"), joint.find("axis").get("xyz")) == ("revolute", "0 0 1")
        largest = 0.7 if name.startswith("front") else rear
        assert [float(joint.find("limit").get(end)) for end in ("lower", "upper")] == [
            -largest,
            largest,
        ]


def test_an_unknown_vehicle_is_one_line():
    with pytest.raises(SystemExit, match="error: unknown vehicle 'audi'; did you mean audi_a2"):
        print_urdf(["audi"])
