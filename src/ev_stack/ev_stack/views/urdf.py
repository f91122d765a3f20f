"""A car as URDF: links with inertia and collision, wheels that steer and turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ev_core.vehicle.description import Vehicle
from ev_stack.views.car import Wheel, wheels_of

BASE, BODY = "base_link", "body"  # on the road below the centre of mass, and what is no wheel
ROLL = "body_roll"  # the joint of a body that rolls
_LARGEST_ROLL = 1.0  # rad, far beyond what springs allow
# m, of the body that is drawn; the vehicle file has nothing about its looks
_HEIGHT, _OVERHANG = 1.0, 1.35
_WIDTH = 0.64  # of a wheel that is drawn, over its radius
_HEAVIEST = 0.05  # a wheel's share of the car's mass at most
# what steers a wheel over the wheel, in mass and inertia: simulators take no link without mass
_CARRIER = 1e-3
_LEAST_YAW = 0.1  # share of the car's yaw inertia that the body has at least
_UPRIGHT, _SIDEWAYS = "0 0 0", "1.5707963267948966 0 0"  # a cylinder stands along z
_BODY_COLOUR, _WHEEL_COLOUR = "0.78 0.82 0.85 0.6", "0.1 0.12 0.14 1"

_Numbers = Sequence[float]
_HERE = (0.0, 0.0, 0.0)


def steering_of(wheel: str) -> str:
    """The joint that steers a wheel, and the link that it turns, which does not roll."""
    return f"{wheel}_steering"


def body_height(car: Vehicle) -> float:
    """Height of the frame of the body [m]: of the centre of mass, or of the axis of a roll."""
    if car.suspension.rolls:
        return car.suspension.axis_height(car.front_load_share)
    return car.centre_of_mass_height


def wheel_link(wheel: str) -> str:
    """The link that rolls; its joint has the name of the wheel, as in `wheel_states`."""
    return f"{wheel}_wheel"


class _Mass(NamedTuple):
    """A part of the car: place from below the centre of mass [m], mass [kg], inertias [kg m^2]."""

    at: tuple[float, float, float]
    mass: float
    inertia: tuple[float, float, float]


def urdf(car: Vehicle, rear_is_steered: bool = False) -> str:
    """The text of the file.

    Mass, centre of mass, yaw inertia and spin inertias of the whole are those of the vehicle file.
    A body that rolls turns on a joint at the height of the roll axis, where wheels and axles stay.
    What it does not have is assumed: a wheel is a solid cylinder of its spin inertia, with a limit
    to its mass; the pitch inertia of the body is its yaw inertia; its roll inertia, where the
    vehicle file has none, is that of the box that is drawn.
    """
    robot = Element("robot", name=car.name)
    SubElement(robot, "link", name=BASE)
    wheels = wheels_of(car)
    rolling = [_rolling(car, wheel) for wheel in wheels]
    carriers = [_Mass(each.at, _CARRIER * each.mass, _scaled(each.inertia)) for each in rolling]
    _body(robot, car, wheels, [*rolling, *carriers])
    place = (0.0, 0.0, body_height(car))
    if car.suspension.rolls:
        roll = _joint(robot, ROLL, "revolute", (BASE, BODY), place, "1 0 0")
        limit = f"{_LARGEST_ROLL:g}"
        SubElement(roll, "limit", lower=f"-{limit}", upper=limit, effort="1e9", velocity="1e9")
    else:
        _joint(robot, f"{BASE}_to_{BODY}", "fixed", (BASE, BODY), place)
    largest = car.maximum_road_wheel_angle
    rear = largest if rear_is_steered or car.rear_steering_ratio else 0.0
    for wheel, of_wheel, of_carrier in zip(wheels, rolling, carriers, strict=True):
        steered, turned = steering_of(wheel.name), wheel_link(wheel.name)
        _inertial(SubElement(robot, "link", name=steered), of_carrier, _HERE)
        link = SubElement(robot, "link", name=turned)
        _inertial(link, of_wheel, _HERE)
        size = {"radius": f"{wheel.radius:.6g}", "length": f"{_WIDTH * wheel.radius:.6g}"}
        _shape(link, "cylinder", size, _HERE, _SIDEWAYS, _WHEEL_COLOUR)
        joint = _joint(
            robot, steered, "revolute", (BASE, steered), (wheel.x, wheel.y, wheel.radius), "0 0 1"
        )
        angle = f"{largest if wheel.x > 0.0 else rear:.6g}"
        # URDF asks for limits of effort and speed: these are none.
        SubElement(joint, "limit", lower=f"-{angle}", upper=angle, effort="1e9", velocity="1e9")
        _joint(robot, wheel.name, "continuous", (steered, turned), _HERE, "0 1 0")
    indent(robot)
    return tostring(robot, encoding="unicode") + "\n"


def _rolling(car: Vehicle, wheel: Wheel) -> _Mass:
    spin = car.wheel_inertia * (
        1.0 if wheel.name in car.driven_wheels else car.undriven_inertia_ratio
    )
    # J = m r^2/2 of a solid cylinder; the spin of a motor behind gears would make it too heavy.
    mass = min(2.0 * spin / wheel.radius**2, _HEAVIEST * car.mass)
    # Of a solid cylinder about a diameter, m (3 r^2 + l^2)/12.
    across = mass * (3.0 * wheel.radius**2 + (_WIDTH * wheel.radius) ** 2) / 12.0
    # as a body has at least; a motor behind gears has more spin than its mass allows
    across = max(across, spin / 2.0)
    return _Mass((wheel.x, wheel.y, wheel.radius), mass, (across, spin, across))


def _scaled(inertia: _Numbers) -> tuple[float, float, float]:
    x, y, z = (_CARRIER * each for each in inertia)
    return x, y, z


def _body(robot: Element, car: Vehicle, wheels: Sequence[Wheel], others: Sequence[_Mass]) -> None:
    """The car without its other parts, in a frame at `body_height`."""
    height = body_height(car)
    mass = car.mass - sum(each.mass for each in others)
    # The body has its centre of mass where all parts together have that of the car.
    x, y, z = (-sum(each.mass * each.at[axis] for each in others) / mass for axis in range(3))
    z += car.mass * car.centre_of_mass_height / mass
    # Parallel axes: each part adds m d^2 and its own inertia, and the body has what is left.
    far = [(each.mass * (each.at[0] ** 2 + each.at[1] ** 2), each.inertia[2]) for each in others]
    yaw = car.yaw_inertia - sum(map(sum, far)) - mass * (x**2 + y**2)
    # Heavy wheels far out may leave less than nothing, which no simulator takes.
    yaw = max(yaw, _LEAST_YAW * car.yaw_inertia)
    xs, ys = [wheel.x for wheel in wheels], [wheel.y for wheel in wheels]
    length, width = max(xs) - min(xs) + _OVERHANG, max(ys) - min(ys)
    roll = car.suspension.roll_inertia or mass * (width**2 + _HEIGHT**2) / 12.0
    roll = min(roll, 2.0 * yaw)  # no body has more
    link = SubElement(robot, "link", name=BODY)
    _inertial(link, _Mass(_HERE, mass, (roll, yaw, yaw)), (x, y, z - height))
    middle = (
        (max(xs) + min(xs)) / 2,
        (max(ys) + min(ys)) / 2,
        car.wheel_radius + _HEIGHT / 2 - height,
    )
    _shape(link, "box", {"size": _words((length, width, _HEIGHT))}, middle, _UPRIGHT, _BODY_COLOUR)


def _words(values: _Numbers) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _joint(
    robot: Element,
    name: str,
    kind: str,
    links: tuple[str, str],
    xyz: _Numbers,
    axis: str | None = None,
) -> Element:
    joint = SubElement(robot, "joint", name=name, type=kind)
    for end, link in zip(("parent", "child"), links, strict=True):
        SubElement(joint, end, link=link)
    SubElement(joint, "origin", xyz=_words(xyz), rpy=_UPRIGHT)
    if axis is not None:
        SubElement(joint, "axis", xyz=axis)
    return joint


def _inertial(link: Element, part: _Mass, xyz: _Numbers) -> None:
    inertial = SubElement(link, "inertial")
    SubElement(inertial, "origin", xyz=_words(xyz), rpy=_UPRIGHT)
    SubElement(inertial, "mass", value=f"{part.mass:.9g}")
    diagonal = {
        axis: f"{moment:.9g}"
        for axis, moment in zip(("ixx", "iyy", "izz"), part.inertia, strict=True)
    }
    SubElement(inertial, "inertia", diagonal | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))


def _shape(
    link: Element, kind: str, size: dict[str, str], xyz: _Numbers, rpy: str, colour: str
) -> None:
    """The same to be seen and to collide."""
    for use in ("visual", "collision"):
        shape = SubElement(link, use)
        SubElement(shape, "origin", xyz=_words(xyz), rpy=rpy)
        SubElement(SubElement(shape, "geometry"), kind, size)
        if use == "visual":
            material = SubElement(shape, "material", name=f"{link.get('name')}_colour")
            SubElement(material, "color", rgba=colour)
