"""The signals of the planar plant: what sensors show of its state."""

from __future__ import annotations

from typing import get_args

from ev_core.elementary import asin, cos, sin
from ev_core.law import Car, CellCondition, MotorElectrics, MotorTemperatures, Wheels, compilable, working_memory
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    InertialMeasurement,
    MotorStates,
    TireForces,
    WheelStates,
)
from ev_sim.drives.couplings import shaft_speeds
from ev_sim.drives.electrical_side import coolant_outlet_temperature, current_at_power
from ev_sim.drives.synchronous_motor import phase_values
from ev_sim.plant.planar import planar_state as state
from ev_sim.plant.planar.body import rates, steer
from ev_sim.plant.planar.car_faults import deflate
from ev_sim.plant.planar.contact import find_road, slips
from ev_sim.plant.planar.energy import drive_loss, source_voltage, terminal_voltage
from ev_sim.plant.planar.given import PlanarParameters
from ev_sim.plant.planar.planar_state import STEP, PlanarState, Step
from ev_sim.plant.planar.prepare import PlanarConstants

Seen = tuple[WheelStates, MotorStates, InertialMeasurement, BodyVelocity, BodyPose, BatteryCondition, TireForces]
PLANAR_SIGNALS: tuple[type, ...] = get_args(Seen)


@compilable
def outputs(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState) -> Seen:
    """All signals at the instant of the state; drive torques are means over the period before it."""
    return seen(p, car, c, s, working_memory(STEP))


@compilable
def seen(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, steps: list[Step]) -> Seen:
    """The same, with what acts in memory that is handed over, of one record."""
    y, step = s.motion, steps[0]
    step.imposed_acceleration = s.imposed_acceleration
    find_road(y, c.body, step, c.road, True)
    if s.faults.is_struck == 1.0:
        deflate(s.faults, p, car, c.body, step)
    steer(car, step, s.road_wheel_angle, s.rear_angle)
    rates(y, step.stages.k1, p, car, c.body, step, True)
    shaft_speeds(car, y[state.WHEEL_SPEED : state.WHEEL_SPEED + 4], step.shaft)
    slip_x, slip_y = step.asked, step.target  # memory that nothing else needs here
    for i in range(4):
        step.shaft[i] = step.shaft[i] * car.driven[i] * car.gear[i]
        step.motor[i] = s.motor_torque[i] * car.motors[i]
        slip_x[i], sine = slips(y, car, c.body, step.contact, i)
        slip_y[i] = -asin(min(max(sine, -1.0), 1.0))
    tyre, power, soc = step.tyre, c.power, s.state_of_charge
    source, capacity = source_voltage(s, power), power.capacity / 3600.0
    current = current_at_power(source, power.resistance, s.battery_power)
    return (
        WheelStates(wheels_from(y, state.WHEEL_ANGLE), wheels_from(y, state.WHEEL_SPEED), wheels_from(s.mean_drive, 0)),
        MotorStates(wheels_from(step.shaft, 0), wheels_from(step.motor, 0)),
        InertialMeasurement(y[state.YAW_RATE], step.acceleration_x, step.acceleration_y),
        BodyVelocity(y[state.VX], y[state.VY], y[state.YAW_RATE]),
        BodyPose(s.x, s.y, sin(y[state.HEADING] / 2), cos(y[state.HEADING] / 2)),
        # Under the power of the last step; the current counts into the battery.
        BatteryCondition(source - power.resistance * current, -current, soc * capacity, capacity, soc),
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
def wheels_from(values: list[float], place: int) -> Wheels:
    """Four values from a place on."""
    return Wheels(values[place], values[place + 1], values[place + 2], values[place + 3])


Electrics = tuple[MotorElectrics, MotorTemperatures, CellCondition]
SeenWithElectrics = tuple[*Seen, *Electrics]
ELECTRICAL_SIGNALS = (*PLANAR_SIGNALS, *get_args(Electrics))


@compilable
def electrical_outputs(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState) -> SeenWithElectrics:
    """Those of `planar`, and of motors, inverters and cells at the instant of the state; voltages in steady state."""
    return _with_electrics(p, car, c, s, working_memory(STEP))


@compilable
def _with_electrics(
    p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, steps: list[Step]
) -> SeenWithElectrics:
    wheels, motors, imu, velocity, pose, battery, tires = outputs(p, car, c, s)
    step, motor, thermal, cells = steps[0], car.motor, car.motor.thermal, car.battery.cells
    step.voltage = terminal_voltage(s, c.power)
    shaft_speeds(car, s.motion[state.WHEEL_SPEED : state.WHEEL_SPEED + 4], step.shaft)
    # Memory that nothing else needs here.
    current, voltage, power = step.asked, step.target, step.motor
    winding, inverter, inlet, outlet, flow = step.load, step.force_x, step.force_y, step.turned, step.mean_speed
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        torque, speed = s.motor_torque[i], step.shaft[i] * car.gear[i]
        current[i], voltage[i] = phase_values(motor, torque, step.voltage, speed)
        power[i] = torque * speed * car.motors[i] + drive_loss(p, car, c.power, step, i, torque, step.shaft[i])
        winding[i] = thermal.coolant + s.winding_rise[i]
        inverter[i] = thermal.coolant + s.inverter_rise[i]
        inlet[i] = thermal.coolant
        outlet[i] = coolant_outlet_temperature(thermal, s.winding_rise[i], s.inverter_rise[i])
        flow[i] = thermal.coolant_flow
    electrics = MotorElectrics(wheels_from(current, 0), wheels_from(voltage, 0), wheels_from(power, 0))
    temperatures = MotorTemperatures(
        wheels_from(winding, 0),
        wheels_from(inverter, 0),
        wheels_from(inlet, 0),
        wheels_from(outlet, 0),
        wheels_from(flow, 0),
    )
    cell = CellCondition(step.voltage / cells.in_series, cells.ambient + s.cells_rise)
    return wheels, motors, imu, velocity, pose, battery, tires, electrics, temperatures, cell
