"""Losses and battery of the planar plant: what the battery lets through, and the energies of a step."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.car import Car
from ev_sim.battery.cells import cell_power_limits, relaxed, temperature_share
from ev_sim.battery.resistive import current_at_power, open_circuit_voltage, power_limits
from ev_sim.driveline.couplings import shaft_speeds
from ev_sim.drives.field_weakening import weakening_loss
from ev_sim.drives.losses import loss_power, map_loss_power
from ev_sim.plant.planar.electrical import Electrical, heat_cells, heat_motors
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.parameters import TORQUE_CONTROLLED, PlanarParameters
from ev_sim.plant.planar.state import PlanarState


class EfficiencyMap(NamedTuple):
    """Shaft speeds [rad/s], shaft torques [N m], and for each speed a row of efficiencies [1]; empty without a map."""

    speed: tuple[float, ...]
    torque: tuple[float, ...]
    efficiency: tuple[float, ...]


class PowerConstants(NamedTuple):
    """Of battery and motors."""

    capacity: float  # charge between empty and full [A s]
    voltage: tuple[float, ...]  # open circuit, at equally spaced states of charge from empty to full [V]
    resistance: float  # of the battery, at once [ohm]
    map: EfficiencyMap
    electrical: Electrical
    gearbox: tuple[float, ...]  # ratios of an engine's gears


@inlined
def motor_loss(p: PlanarParameters, car: Car, map: EfficiencyMap, torque: float, speed: float) -> float:
    """Loss of one torque-controlled motor with inverter [W] at its shaft torque [N m] and speed [rad/s].

    Brushless drives bring their own losses.
    """
    if p.drive != TORQUE_CONTROLLED:
        return 0.0
    if len(map.efficiency) > 0:
        return map_loss_power(torque, speed, map.speed, map.torque, map.efficiency)
    return loss_power(car.motor, torque, speed)


@inlined
def source_voltage(s: PlanarState, power: PowerConstants) -> float:
    """Voltage of the battery without what its resistance takes at once [V]."""
    return open_circuit_voltage(power.voltage, s.state_of_charge) - s.relaxation


@inlined
def terminal_voltage(s: PlanarState, power: PowerConstants) -> float:
    """Voltage at the terminals of the battery under the power of the last step [V]."""
    source = source_voltage(s, power)
    return source - power.resistance * current_at_power(source, power.resistance, s.battery_power)


@inlined
def _limits(s: PlanarState, car: Car, power: PowerConstants) -> tuple[float, float]:
    """Largest power out of and into the battery [W]."""
    source = source_voltage(s, power)
    if power.electrical.modelled == 0.0:
        return power_limits(car.battery, source, s.state_of_charge)
    temperature = car.battery.cells.ambient + s.cells_rise
    discharging = temperature_share(power.electrical.discharge_temperature, temperature)
    charging = temperature_share(power.electrical.charge_temperature, temperature)
    return cell_power_limits(car.battery, source, power.resistance, s.state_of_charge, discharging, charging)


@inlined
def battery_scale(s: PlanarState, p: PlanarParameters, car: Car, power: PowerConstants, step: Step) -> float:
    """Factor on all motor torques [1] that keeps the battery within its limits.

    Losses are convex in the torque and at least the idle ones, so the factor errs on the safe side.
    """
    shaft, target = step.shaft, step.target
    mechanical = wanted = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_loss = drive_loss(p, car, power, step, left, target[left], shaft[left])
        right_loss = drive_loss(p, car, power, step, right, target[right], shaft[right])
        wanted += left_loss + right_loss
        powers = (target[left] * shaft[left] + target[right] * shaft[right]) * car.gear[left]
        mechanical += powers * car.motors[left]
    wanted += mechanical + car.battery.auxiliary_power
    give, take = _limits(s, car, power)
    give, take = s.faults.power * give, s.faults.power * take
    too_much_given, too_much_taken = wanted > give, wanted < -take and mechanical < 0.0
    if not too_much_given and not too_much_taken:
        return 1.0  # nearly always: the idle losses need not be looked up
    idle = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_idle = drive_loss(p, car, power, step, left, 0.0, shaft[left])
        idle += left_idle + drive_loss(p, car, power, step, right, 0.0, shaft[right])
    idle += car.battery.auxiliary_power
    if too_much_given and wanted > idle:
        return min(max((give - idle) / (wanted - idle), 0.0), 1.0)
    if too_much_taken:
        return min(max((-take - idle) / mechanical, 0.0), 1.0)
    return 1.0


@inlined
def drive_loss(
    p: PlanarParameters, car: Car, power: PowerConstants, step: Step, i: int, torque: float, shaft: float
) -> float:
    """Loss of the motors of wheel i [W], at the speed of the shaft behind the gear [rad/s]; none where there is none.

    A map knows what field weakening takes.
    """
    if car.driven[i] == 0.0:
        return 0.0
    speed = shaft * car.gear[i]
    loss = motor_loss(p, car, power.map, torque, speed)
    if power.electrical.modelled == 0.0 or len(power.map.efficiency) > 0:
        return loss * car.motors[i]
    return (loss + weakening_loss(car.motor, torque, step.voltage, speed)) * car.motors[i]


@inlined
def account(s: PlanarState, p: PlanarParameters, car: Car, power: PowerConstants, step: Step, h: float) -> None:
    """Book the energies of this step of h [s], in which the wheels have `turned`, and discharge the battery."""
    shaft, mean_speed, motor = step.shaft, step.mean_speed, step.motor
    for i in range(4):
        mean_speed[i] = step.turned[i] / h
    shaft_speeds(car, mean_speed, shaft)
    mechanical = loss = drive = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_speed, right_speed = shaft[left] * car.gear[left], shaft[right] * car.gear[right]
        mechanical += (motor[left] * left_speed + motor[right] * right_speed) * car.motors[left]
        left_loss = drive_loss(p, car, power, step, left, motor[left], shaft[left])
        loss += left_loss + drive_loss(p, car, power, step, right, motor[right], shaft[right])
        drive += step.drive[left] * mean_speed[left] + step.drive[right] * mean_speed[right]
    if p.drive != TORQUE_CONTROLLED:
        loss = 0.0
        for axle in range(2):
            loss += s.drives[2 * axle].electrical_power + s.drives[2 * axle + 1].electrical_power
        loss -= mechanical
    if car.engine_driven == 1.0:
        s.driveline_loss += (s.engine.taken - mechanical) * h
        loss = -mechanical  # of a battery that gives nothing to the engine
    given = mechanical + loss + car.battery.auxiliary_power
    current = current_at_power(source_voltage(s, power), power.resistance, given)
    if power.electrical.modelled == 1.0:
        electrical = power.electrical
        heat_motors(s, car, electrical, step)
        heat_cells(s, car, electrical, power.resistance, current)
        s.relaxation = relaxed(s.relaxation, current, electrical.relaxation_resistance, electrical.relaxation_share)
    s.state_of_charge -= current * h / power.capacity
    s.battery_power = given
    s.battery_work += given * h
    s.motor_loss += loss * h * (1.0 - car.engine_driven)
    s.driveline_loss += (mechanical - drive) * h
    s.auxiliary_work += car.battery.auxiliary_power * h
    s.drive_work += drive * h
