"""The planar plant at the start of a run."""

from __future__ import annotations

from ev_msgs_py.vehicle.car import Car
from ev_sim.drives.engine import begin_engine
from ev_sim.plant.planar.contact import look, within_friction
from ev_sim.plant.planar.equilibrium import begin_driven
from ev_sim.plant.planar.loads import loads
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.notes import keep_noted
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.road_under_wheels import find_road
from ev_sim.plant.planar.state import (
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
    s = PlanarState()
    begin(s, p, car, c)
    return s


def begin(s: PlanarState, p: PlanarParameters, car: Car, c: PlanarConstants) -> None:
    """Set a new state to the start."""
    s.x, s.y, s.state_of_charge = p.initial_x, p.initial_y, car.battery.state_of_charge
    y = s.motion
    y[VX], y[HEADING] = p.initial_speed, p.initial_heading
    for i in range(4):
        y[WHEEL_SPEED + i] = p.initial_speed / c.body.wheel_radius[i]
        s.torque_share[i] = car.driven[i] / max(car.number_driven, 1.0)
    if car.engine_driven == 1.0:
        turning = (car.gear[i] * y[WHEEL_SPEED + i] for i in range(4) if car.driven[i] == 1.0)
        begin_engine(s.engine, car.engine, c.power.gearbox, next(turning))
    if p.initial_speed == 0.0:
        _park(s, car, c)
    if any(c.initial_drive_torque):
        begin_driven(s, car, c)
    keep_noted(s, car, c.road)


def _park(s: PlanarState, car: Car, c: PlanarConstants) -> None:
    """Load the carcasses by the slope, each as far as its friction goes: a car on too steep a slope slides at once."""
    y, step, front = s.motion, Step(), car.centre_of_mass_to_rear_axle / car.wheelbase
    find_road(y, c.body, step, c.road, True)
    y[TRANSFER_X], y[TRANSFER_Y] = -step.gravity_x, -step.gravity_y
    step.load = list(loads(y, car, step.gravity_z))
    look(y, car, c.body, step, True)
    for i in range(4):
        share = 0.5 * (front if i < 2 else 1.0 - front)
        force_x, force_y = -share * car.mass * step.gravity_x, -share * car.mass * step.gravity_y
        scale_x, scale_y = within_friction(car, step.contact, i, force_x, force_y)
        y[DEFLECTION_X + i] = scale_x * force_x / car.tyre.longitudinal_stiffness
        y[DEFLECTION_Y + i] = scale_y * force_y / car.tyre.lateral_stiffness
