"""ev-stack urdf VEHICLE: a car as URDF on standard output."""

from __future__ import annotations

from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError
from ev_sim.command_line.refusal import Parser, refuse
from ev_sim.dashboard.ros_views import urdf
from ev_sim.scenarios.about import VEHICLE, vehicle_file


def main(argv: list[str] | None = None) -> None:
    """ev-stack urdf VEHICLE"""
    parser = Parser(prog="ev-stack urdf", description="A car as URDF, for RViz and Foxglove.")
    parser.add_argument("vehicle", help="name of a vehicle, or path of a vehicle file")
    given = parser.parse_args(argv)
    prefix = f"{VEHICLE}."
    try:
        said = vehicle_file(given.vehicle).values_for("/ev/plant")
        car = build(Vehicle, {name: value for name, value in said.items() if name.startswith(prefix)}, prefix)
    except (ParameterError, OSError) as error:
        refuse(error)
    print(urdf(car), end="")
