"""Straight running at constant speed under drive torques: where a run may begin instead of with free wheels."""

from __future__ import annotations

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.loads import loads
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.road_under_wheels import find_road
from ev_sim.plant.planar.state import DEFLECTION_X, SLIP_X, TRANSFER_X, VX, WHEEL_SPEED, PlanarState
from ev_sim.tyres.curve import CURVES, Coefficients, friction, peak_slip

_HALVINGS = 60  # of an interval of at most 1: to rounding


def begin_driven(s: PlanarState, car: Car, c: PlanarConstants) -> None:
    """Set wheels, carcasses and motors to what holds `c.initial_drive_torque` against the road at the car's speed.

    The body does not accelerate: whatever holds its speed until the run begins takes the force of the tyres
    in the plane of the road, so that drag and slope alone pitch it.
    ParameterError if a tyre cannot hold its torque.
    """
    y, step, radius, speed = s.motion, Step(), c.body.wheel_radius, s.motion[VX]
    find_road(y, c.body, step, c.road, True)
    y[TRANSFER_X] = c.body.drag * abs(speed) * speed / car.mass - step.gravity_x
    load = loads(y, car, step.gravity_z)
    rolling = car.rolling_resistance + car.rolling_resistance_growth * speed * speed
    for i in range(4):
        asked, tyre, efficiency = c.initial_drive_torque[i], step.tyre[i], car.motor.gear_efficiency
        torque = asked * efficiency if asked * speed > 0.0 else asked / efficiency
        resistance = load[i] * (rolling + tyre.rolling_resistance)
        force = torque / radius[i] - (resistance if speed > 0.0 else -resistance)
        slip = _slip_at(car, Coefficients(tyre.c0, tyre.c1, tyre.c2, tyre.c3), abs(force) / max(load[i], 1e-9))
        if slip is None:
            raise ParameterError(
                f"initial_drive_torque is {asked:g} N m at {WHEEL_NAMES[i]}, "
                f"allowed is what its tyre holds, {tyre.friction * load[i] * radius[i]:.5g} N m"
            )
        # Slip is over the faster one of rim and road.
        y[WHEEL_SPEED + i] = (speed / (1.0 - slip) if force * speed > 0.0 else speed * (1.0 - slip)) / radius[i]
        y[SLIP_X + i] = slip if force >= 0.0 else -slip
        y[DEFLECTION_X + i] = force / car.tyre.longitudinal_stiffness
        s.motor_torque[i] = asked / car.gear[i] / car.motors[i]
        s.mean_drive[i] = torque


def _slip_at(car: Car, curve: Coefficients, use: float) -> float | None:
    """The slip [1] on the rising part of the friction curve at a friction use [1]; None beyond its peak."""
    kind = car.tyre.curve
    low, high = 0.0, peak_slip(CURVES[int(kind)], tuple(curve))
    if use > friction(kind, high, curve):
        return None
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if friction(kind, middle, curve) < use:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
