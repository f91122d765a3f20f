"""Newton-Euler for the body in the plane and its four wheels.

Frame: x forward, y left, z up, at the centre of mass. Equations: dissertation, eqs 2.20-2.26, and Ge & Ni 2005, with
the signs of one right-handed frame.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ev_sim.compiled import compiled
from ev_sim.plant.planar.loads import wheel_loads
from ev_sim.plant.planar.state import index
from ev_sim.tyres.carcass import force_and_rate
from ev_sim.tyres.combined import STILL, slip_vector, uncoupled

VX = index("longitudinal_velocity")
VY = index("lateral_velocity")
YAW_RATE = index("yaw_rate")
HEADING = index("heading")
TRANSFER_X = index("longitudinal_transfer")
TRANSFER_Y = index("lateral_transfer")
WHEEL_SPEED = index("wheel_speed")
DEFLECTION_X = index("longitudinal_deflection")
DEFLECTION_Y = index("lateral_deflection")
WHEEL_ANGLE = index("wheel_angle")
DISTANCE = index("distance")
BODY_DISTANCE = index("body_distance")
TYRE_WORK = index("tyre_work")
FRICTION_WORK = index("friction_work")
DRAG_WORK = index("drag_work")
GRAVITY_WORK = index("gravity_work")
HOLDING_WORK = index("holding_work")


@compiled
def secants(car, tyre, slip_x: float, slip_y: float, rim: float, along: float, speed: float, i: int):
    """Friction per slip and transport velocity, for both directions of wheel i.

    Slip velocities, rim speed, speed along the wheel and speed of its centre [m/s]; the transport velocity is the
    larger of rim and ground speed, which gives 1 - V/(r w) in traction and (r w - V)/V in braking.
    """
    c0, c1, c2, c3 = tyre[i, 0], tyre[i, 1], tyre[i, 2], tyre[i, 3]
    if car.uncoupled == 0:
        transport = max(abs(rim), speed, STILL)
        along_secant, across_secant = slip_vector(
            car.curve, slip_x, slip_y, transport, car.lateral_ratio, c0, c1, c2, c3
        )
        return along_secant, across_secant, transport, transport
    transport_x = max(abs(rim), abs(along), STILL)
    transport_y = max(speed, STILL)
    along_secant, across_secant = uncoupled(
        car.curve, slip_x, slip_y, transport_x, transport_y, car.lateral_ratio, c0, c1, c2, c3
    )
    if car.linear_lateral == 1:
        across_secant = car.cornering_stiffness[i]
    return along_secant, across_secant, transport_x, transport_y


@compiled
def rates(y: np.ndarray, dy: np.ndarray, car, step, starts: bool) -> None:
    """Time derivative of the integrated part of the state, into `dy`; forces and slips go into `step`.

    `y` and `dy` have at least `INTEGRATED_SIZE` elements. Dry friction (brakes and rolling resistance, set-valued at
    rest) opposes one direction during a step; an evaluation that `starts` a step decides which: that of the wheel's
    rotation, for a resting wheel that of the torque if it exceeds the friction, else the wheel is held.
    Sums go over left and right first, so that a mirrored state has exactly mirrored rates.
    """
    vx, vy, yaw_rate = y[VX], y[VY], y[YAW_RATE]
    load = step.load
    load[0], load[1], load[2], load[3] = wheel_loads(
        car.mass * step.gravity_z,
        car.height * car.mass * y[TRANSFER_X],
        car.height * car.mass * y[TRANSFER_Y],
        car.rear_arm,
        car.wheelbase,
        car.front_track,
        car.rear_track,
        car.offset,
        car.front_roll_share,
    )
    rolling = car.rolling + car.rolling_speed * vx * vx
    radius = car.radius
    force_x, force_y, tyre = step.force_x, step.force_y, step.tyre
    # Forces and powers of the wheels, summed as (front left + front right) + (rear left + rear right).
    sum_x = sum_y = moment = tyre_power = friction_power = 0.0
    for axle in range(2):
        axle_x = axle_y = axle_moment = axle_tyre_power = axle_friction_power = 0.0
        for side in range(2):
            i = 2 * axle + side
            cosine, sine = step.cos_steer[i], step.sin_steer[i]
            ground_x = vx - car.wheel_y[i] * yaw_rate
            ground_y = vy + car.wheel_x[i] * yaw_rate
            along = ground_x * cosine + ground_y * sine
            across = ground_y * cosine - ground_x * sine
            speed = sqrt(along * along + across * across)
            wheel_speed = y[WHEEL_SPEED + i]
            if not starts and step.motion[i] * wheel_speed < 0.0:
                wheel_speed = 0.0  # the brake stops the wheel within this step, it cannot turn it back
            rim = radius * wheel_speed
            slip_x, slip_y = rim - along, -across
            secant_x, secant_y, transport_x, transport_y = secants(
                car, tyre, slip_x, slip_y, rim, along, speed, i
            )
            normal = load[i]
            along_force, dy[DEFLECTION_X + i] = force_and_rate(
                y[DEFLECTION_X + i], slip_x, transport_x, normal * secant_x, car.stiffness_x, car.damping_x
            )
            across_force, dy[DEFLECTION_Y + i] = force_and_rate(
                y[DEFLECTION_Y + i], slip_y, transport_y, normal * secant_y, car.stiffness_y, car.damping_y
            )
            force_x[i], force_y[i] = along_force, across_force

            torque = step.drive[i] - radius * along_force
            dry = step.brake[i] + radius * normal * (rolling + tyre[i, 4])
            if starts:
                decide_motion(step, i, wheel_speed, torque, dry)
            if step.held[i] == 1.0:
                dy[WHEEL_SPEED + i] = 0.0
            else:
                dy[WHEEL_SPEED + i] = (torque - step.motion[i] * dry) / car.wheel_inertia[i]
            dy[WHEEL_ANGLE + i] = wheel_speed
            dy[DISTANCE + i] = along

            body_x = along_force * cosine - across_force * sine
            body_y = along_force * sine + across_force * cosine
            axle_x += body_x
            axle_y += body_y
            axle_moment += car.wheel_x[i] * body_y - car.wheel_y[i] * body_x
            axle_tyre_power += along_force * slip_x + across_force * slip_y
            axle_friction_power += step.motion[i] * dry * wheel_speed
        sum_x += axle_x
        sum_y += axle_y
        moment += axle_moment
        tyre_power += axle_tyre_power
        friction_power += axle_friction_power

    specific_x, specific_y = sum_x / car.mass, sum_y / car.mass
    drag = car.drag * abs(vx) * vx
    step.acceleration_x = specific_x - drag / car.mass + step.gravity_x
    holding = 0.0  # [N/kg], in the plane of the road below the centre of mass: it neither turns nor pitches the car
    if car.imposed_speed == 1:
        wanted = step.imposed_acceleration - yaw_rate * vy
        holding = wanted - step.acceleration_x
        step.acceleration_x = wanted
    step.acceleration_y = specific_y + step.gravity_y
    dy[VX] = step.acceleration_x + yaw_rate * vy
    dy[VY] = step.acceleration_y - yaw_rate * vx
    dy[YAW_RATE] = moment / car.yaw_inertia
    dy[HEADING] = yaw_rate
    dy[TRANSFER_X] = (specific_x + holding - y[TRANSFER_X]) / car.transfer_lag
    dy[TRANSFER_Y] = (specific_y - y[TRANSFER_Y]) / car.transfer_lag
    dy[BODY_DISTANCE] = vx
    dy[TYRE_WORK] = tyre_power
    dy[FRICTION_WORK] = friction_power
    dy[DRAG_WORK] = drag * vx
    dy[GRAVITY_WORK] = -car.mass * (step.gravity_x * vx + step.gravity_y * vy)
    dy[HOLDING_WORK] = -car.mass * holding * vx


@compiled
def decide_motion(step, i: int, wheel_speed: float, torque: float, dry: float) -> None:
    """Which direction dry friction opposes at wheel i during this step (Coulomb's law, set-valued at rest).

    `torque` and `dry` are the other torques and the largest friction torque on the wheel [N m].
    """
    step.held[i] = 0.0
    if dry == 0.0:
        step.motion[i] = 0.0
    elif wheel_speed != 0.0:
        step.motion[i] = 1.0 if wheel_speed > 0.0 else -1.0
    elif abs(torque) > dry:
        step.motion[i] = 1.0 if torque > 0.0 else -1.0
    else:
        step.motion[i] = 0.0
        step.held[i] = 1.0
