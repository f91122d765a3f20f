"""What follows from the vehicle description and stays for a whole run."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import GRAVITY, ParameterError, Vehicle, entry, part, per_wheel
from ev_core.vehicle.drive_train import wheel_inertias
from ev_core.vehicle.tyre import MfTyres, mf_tyres
from ev_sim.tyres.mf_tyre import is_plain


@dataclass(slots=True)
class BodyConstants:
    """Numbers of body, wheels and tyres that the vehicle description does not say itself."""

    wheel_x: list[float] = per_wheel(unit="m", about="of the wheel centre from the centre of mass")
    wheel_y: list[float] = per_wheel(unit="m", about="of the wheel centre from the centre of mass")
    wheel_radius: list[float] = per_wheel(unit="m", about="true rolling radius")
    wheel_inertia: list[float] = per_wheel(unit="kg m^2", about="with the part of the rotor behind its gear")
    cornering_stiffness: list[float] = per_wheel(
        unit="1/rad", about="over static load, of a linear lateral curve; itself [N/rad] of a constant stiffness"
    )
    number_of_wheels: float = entry(4.0, unit="1")
    mf: MfTyres = part(MfTyres)
    mf_is_plain: float = entry(unit="1", about="what `is_plain` says of the tyres")
    damping_x: float = entry(unit="N s/m", about="of the carcass, along the wheel")
    damping_y: float = entry(unit="N s/m", about="of the carcass, across the wheel")
    drag: float = entry(unit="N s^2/m^2", about="rho c_d A / 2")
    side_drag: float = entry(unit="N s^2/m^2", about="rho C_wy F_side / 2")


def wheel_places(vehicle: Vehicle) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The x and the y of the four wheel centres from the centre of mass [m]."""
    rear = -vehicle.centre_of_mass_to_rear_axle
    front = vehicle.wheelbase + rear
    front_half, rear_half, offset = vehicle.front_track / 2, vehicle.rear_track / 2, vehicle.centre_of_mass_offset
    y = (front_half - offset, -front_half - offset, rear_half - offset, -rear_half - offset)
    return (front, front, rear, rear), y


def body_constants(vehicle: Vehicle) -> BodyConstants:
    """The constants of a vehicle; ParameterError if a file that it names has not been read."""
    v, tyre = vehicle, vehicle.tyre
    front_load = v.mass * GRAVITY * v.centre_of_mass_to_rear_axle / v.wheelbase
    rear_load = v.mass * GRAVITY - front_load
    front_stiffness, rear_stiffness = tyre.front_cornering_stiffness, tyre.rear_cornering_stiffness
    if tyre.lateral_curve == "linear":
        front_stiffness = 2 * front_stiffness / max(front_load, 1.0)
        rear_stiffness = 2 * rear_stiffness / max(rear_load, 1.0)
    for axle, file in (("front", tyre.front_file), ("rear", tyre.rear_file)):
        if file:
            raise ParameterError(f"vehicle.tyre.{axle}_file: {file} has not been read into {axle}_mf")
    x, y = wheel_places(v)
    mf = mf_tyres(tyre.front_mf, tyre.rear_mf)
    return BodyConstants(
        wheel_x=list(x),
        wheel_y=list(y),
        wheel_radius=[v.wheel_radius * ratio for ratio in v.wheel_radius_ratio],
        wheel_inertia=wheel_inertias(v),
        cornering_stiffness=[front_stiffness, front_stiffness, rear_stiffness, rear_stiffness],
        mf=mf,
        mf_is_plain=float(is_plain(mf)),
        damping_x=tyre.longitudinal_stiffness * tyre.longitudinal_damping_time,
        damping_y=tyre.lateral_stiffness * tyre.lateral_damping_time,
        drag=0.5 * v.air_density * v.drag_coefficient * v.frontal_area,
        side_drag=0.5 * v.air_density * v.side_drag_coefficient * v.side_area,
    )
