"""The vehicle with everything that its description leaves to files."""

from __future__ import annotations

from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.efficiency_map import with_map_from_file
from ev_msgs_py.vehicle.tyre_property_file import with_tyres_from_files


def with_files(vehicle: Vehicle) -> Vehicle:
    """The vehicle with the numbers of its files in place of their names; ParameterError, in one line, as they raise."""
    return with_tyres_from_files(with_map_from_file(vehicle))
