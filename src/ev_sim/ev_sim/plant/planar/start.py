"""The planar plant at the start of a run."""

from __future__ import annotations

from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.equilibrium import begin_driven
from ev_sim.plant.planar.lift import note_lifted
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.road_under_wheels import gravity_at
from ev_sim.plant.planar.state import (
    BODY_DISTANCE,
    DEFLECTION_X,
    DEFLECTION_Y,
    HEADING,
    TRANSFER_X,
    TRANSFER_Y,
    VX,
    WHEEL_SPEED,
    PlanarState,
)


def at_start(p: PlanarParameters, car: Car, c: PlanarConstants) -> PlanarState:
    """Rolling straight ahead, freely or driven, or, without speed, parked: the carcasses hold the car on its slope."""
    s = PlanarState(x=p.initial_x, y=p.initial_y, state_of_charge=car.battery.state_of_charge)
    y = s.motion
    y[VX], y[HEADING] = p.initial_speed, p.initial_heading
    front = car.centre_of_mass_to_rear_axle / car.wheelbase
    gravity_x, gravity_y, _ = gravity_at(c.road.slope, y[BODY_DISTANCE])
    if p.initial_speed == 0.0:
        y[TRANSFER_X], y[TRANSFER_Y] = -gravity_x, -gravity_y
    for i in range(4):
        y[WHEEL_SPEED + i] = p.initial_speed / c.body.wheel_radius[i]
        s.torque_share[i] = car.driven[i] / max(car.number_driven, 1.0)
        if p.initial_speed == 0.0:
            share = 0.5 * (front if i < 2 else 1.0 - front)
            y[DEFLECTION_X + i] = -share * car.mass * gravity_x / car.tyre.longitudinal_stiffness
            y[DEFLECTION_Y + i] = -share * car.mass * gravity_y / car.tyre.lateral_stiffness
    if any(c.initial_drive_torque):
        begin_driven(s, car, c)
    note_lifted(s, car, c.road)
    return s
