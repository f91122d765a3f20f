"""A car as URDF: body and wheels where the vehicle file has them, the centre of mass over the origin, on the ground."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.page.top_view import car_of

_HEIGHT, _OVERHANG = 1.0, 1.35  # m, of the body that is drawn; the vehicle file says nothing of its looks
_WIDTH = 0.64  # of a wheel that is drawn, over its radius


def urdf(car: Vehicle) -> str:
    """The text of the file; joints have the names of the wheels, as in `wheel_states`."""
    shape = car_of(car)
    radius = shape["radius"]
    robot = Element("robot", name=car.name)
    body = SubElement(robot, "link", name="base_link")
    xs, ys = zip(*(wheel["place"] for wheel in shape["wheels"]), strict=True)
    centre = f"{(max(xs) + min(xs)) / 2:.6g} {(max(ys) + min(ys)) / 2:.6g} {radius + _HEIGHT / 2:.6g}"
    size = f"{max(xs) - min(xs) + _OVERHANG:.6g} {max(ys) - min(ys):.6g} {_HEIGHT:.6g}"
    _visual(body, "box", {"size": size}, centre, "0 0 0", "0.78 0.82 0.85 0.6")
    for wheel in shape["wheels"]:
        name = wheel["name"].replace(" ", "_")
        link = SubElement(robot, "link", name=f"{name}_wheel")
        cylinder = {"radius": f"{radius:.6g}", "length": f"{_WIDTH * radius:.6g}"}
        _visual(link, "cylinder", cylinder, "0 0 0", "1.5707963 0 0", "0.1 0.12 0.14 1")
        joint = SubElement(robot, "joint", name=name, type="continuous")
        SubElement(joint, "parent", link="base_link")
        SubElement(joint, "child", link=f"{name}_wheel")
        x, y = wheel["place"]
        SubElement(joint, "origin", xyz=f"{x:.6g} {y:.6g} {radius:.6g}", rpy="0 0 0")
        SubElement(joint, "axis", xyz="0 1 0")
    indent(robot)
    return tostring(robot, encoding="unicode") + "\n"


def _visual(link: Element, kind: str, size: dict[str, str], xyz: str, rpy: str, colour: str) -> None:
    visual = SubElement(link, "visual")
    SubElement(visual, "origin", xyz=xyz, rpy=rpy)
    SubElement(SubElement(visual, "geometry"), kind, size)
    material = SubElement(visual, "material", name=f"{link.get('name')}_colour")
    SubElement(material, "color", rgba=colour)
