"""The signals of the electrical side, in `planar_electrical` only."""

from __future__ import annotations

from typing import get_args

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.electrical_signals import CellCondition, MotorElectrics, MotorTemperatures
from ev_msgs_py.contract.record import working_memory
from ev_msgs_py.vehicle.car import Car
from ev_sim.driveline.couplings import shaft_speeds
from ev_sim.drives.field_weakening import phase_values
from ev_sim.drives.temperatures import coolant_outlet_temperature
from ev_sim.plant.planar.energy import drive_loss, terminal_voltage
from ev_sim.plant.planar.memory import STEP, Step
from ev_sim.plant.planar.outputs import SIGNALS, Seen, outputs, wheels_from
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.state import WHEEL_SPEED, PlanarState

Electrics = tuple[MotorElectrics, MotorTemperatures, CellCondition]
SeenWithElectrics = tuple[*Seen, *Electrics]
ELECTRICAL_SIGNALS = (*SIGNALS, *get_args(Electrics))


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
    shaft_speeds(car, s.motion[WHEEL_SPEED : WHEEL_SPEED + 4], step.shaft)
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
