"""The signals of the planar plant: what sensors show of its state."""

from __future__ import annotations

from typing import get_args

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import working_memory
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    TireForces,
    WheelStates,
)
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.elementary import asin, cos, sin
from ev_msgs_py.vehicle.car import Car
from ev_sim.battery.resistive import current_at_power
from ev_sim.driveline.couplings import shaft_speeds
from ev_sim.plant.planar.body import rates
from ev_sim.plant.planar.contact import slips
from ev_sim.plant.planar.energy import PowerConstants, source_voltage
from ev_sim.plant.planar.faults.striking import deflate
from ev_sim.plant.planar.memory import STAGES, STEP, Stages, Step
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.road_under_wheels import find_road
from ev_sim.plant.planar.state import HEADING, VX, VY, WHEEL_ANGLE, WHEEL_SPEED, YAW_RATE, PlanarState
from ev_sim.plant.planar.steering import steer

Seen = tuple[WheelStates, MotorStates, InertialMeasurement, BodyVelocity, BodyPose, BatteryCondition, TireForces]
SIGNALS: tuple[type, ...] = get_args(Seen)


@compilable
def outputs(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState) -> Seen:
    """All signals at the instant of the state; drive torques are means over the period before it."""
    return seen(p, car, c, s, working_memory(STEP), working_memory(STAGES))


@compilable
def seen(
    p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, steps: list[Step], stages: list[Stages]
) -> Seen:
    """The same, with what acts in memory that is handed over, of one record each."""
    y, step = s.motion, steps[0]
    step.imposed_acceleration = s.imposed_acceleration
    find_road(y, c.body, step, c.road, True)
    if s.faults.is_struck == 1.0:
        deflate(s.faults, p, car, c.body, step)
    steer(car, step, s.road_wheel_angle, s.rear_angle)
    rates(y, stages[0].k1, p, car, c.body, step, True)
    shaft_speeds(car, y[WHEEL_SPEED : WHEEL_SPEED + 4], step.shaft)
    slip_x, slip_y = step.asked, step.target  # memory that nothing else needs here
    for i in range(4):
        step.shaft[i] = step.shaft[i] * car.driven[i] * car.gear[i]
        step.motor[i] = s.motor_torque[i] * car.motors[i]
        slip_x[i], sine = slips(y, car, c.body, step.contact, i)
        slip_y[i] = -asin(min(max(sine, -1.0), 1.0))
    tyre = step.tyre
    return (
        WheelStates(wheels_from(y, WHEEL_ANGLE), wheels_from(y, WHEEL_SPEED), wheels_from(s.mean_drive, 0)),
        MotorStates(wheels_from(step.shaft, 0), wheels_from(step.motor, 0)),
        InertialMeasurement(y[YAW_RATE], step.acceleration_x, step.acceleration_y),
        BodyVelocity(y[VX], y[VY], y[YAW_RATE]),
        BodyPose(s.x, s.y, sin(y[HEADING] / 2), cos(y[HEADING] / 2)),
        battery_condition(s, c.power),
        TireForces(
            wheels_from(step.force_x, 0),
            wheels_from(step.force_y, 0),
            wheels_from(step.load, 0),
            wheels_from(slip_x, 0),
            wheels_from(slip_y, 0),
            Wheels(tyre[0].friction, tyre[1].friction, tyre[2].friction, tyre[3].friction),
        ),
    )


@compilable
def battery_condition(s: PlanarState, power: PowerConstants) -> BatteryCondition:
    """Terminal values under the power of the last step; the current counts into the battery."""
    source, resistance = source_voltage(s, power), power.resistance
    current = current_at_power(source, resistance, s.battery_power)
    capacity = power.capacity / 3600.0
    return BatteryCondition(
        source - resistance * current, -current, s.state_of_charge * capacity, capacity, s.state_of_charge
    )


@compilable
def wheels_from(values: list[float], place: int) -> Wheels:
    """Four values from a place on."""
    return Wheels(values[place], values[place + 1], values[place + 2], values[place + 3])
