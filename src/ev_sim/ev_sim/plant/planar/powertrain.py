"""Battery, motors, driveline and brakes of the planar plant: torques held over a step, and its energies."""

from __future__ import annotations

from ev_core.law import Car, Wheels, inlined
from ev_core.vehicle import losses
from ev_sim.drives import driveline, electrical_side
from ev_sim.drives.drive import advance_drive
from ev_sim.drives.synchronous_motor import limited_torque, voltage_limited_torque, weakening_loss
from ev_sim.plant.planar.given import TORQUE_CONTROLLED, PlanarParameters, strike_motors
from ev_sim.plant.planar.planar_state import WHEEL_SPEED, PlanarState, Step
from ev_sim.plant.planar.prepare import PlanarConstants, PowerConstants


@inlined
def within_electrical_limits(s: PlanarState, car: Car, i: int, torque: float, voltage: float, speed: float) -> float:
    """The torque [N m] of the motor of wheel i that voltage [V] and temperatures leave at a shaft speed [rad/s]."""
    thermal = car.motor.thermal
    winding, inverter = thermal.coolant + s.winding_rise[i], thermal.coolant + s.inverter_rise[i]
    most = voltage_limited_torque(car.motor.winding, voltage, speed)
    most = min(most, car.motor.peak_torque * electrical_side.derating_share(thermal, winding, inverter))
    return min(max(torque, -most), most)


@inlined
def source_voltage(s: PlanarState, power: PowerConstants) -> float:
    """Voltage of the battery without what its resistance takes at once [V]."""
    return electrical_side.open_circuit_voltage(power.voltage, s.state_of_charge) - s.relaxation


@inlined
def terminal_voltage(s: PlanarState, power: PowerConstants) -> float:
    """Voltage at the terminals of the battery under the power of the last step [V]."""
    source = source_voltage(s, power)
    return source - power.resistance * electrical_side.current_at_power(source, power.resistance, s.battery_power)


@inlined
def battery_scale(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, step: Step) -> float:
    """Factor on all motor torques [1] that keeps the battery within its limits.

    Losses are convex in the torque and at least the idle ones, so the factor errs on the safe side.
    """
    shaft, target, power, electrical = step.shaft, step.target, c.power, c.power.electrical
    mechanical = wanted = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_loss = drive_loss(p, car, power, step, left, target[left], shaft[left])
        right_loss = drive_loss(p, car, power, step, right, target[right], shaft[right])
        wanted += left_loss + right_loss
        powers = (target[left] * shaft[left] + target[right] * shaft[right]) * car.gear[left]
        mechanical += powers * car.motors[left]
    wanted += mechanical + car.battery.auxiliary_power
    source = source_voltage(s, power)
    if electrical.modelled == 0.0:
        give, take = electrical_side.power_limits(car.battery, source, s.state_of_charge)
    else:
        temperature = car.battery.cells.ambient + s.cells_rise
        discharging = electrical_side.temperature_share(electrical.discharge_temperature, temperature)
        charging = electrical_side.temperature_share(electrical.charge_temperature, temperature)
        give, take = electrical_side.cell_power_limits(
            car.battery, source, power.resistance, s.state_of_charge, discharging, charging
        )
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
    speed, table = shaft * car.gear[i], power.map
    if p.drive != TORQUE_CONTROLLED:  # brushless drives bring their own losses
        loss = 0.0
    elif len(table.efficiency) > 0:
        loss = losses.map_loss_power(torque, speed, table.speed, table.torque, table.efficiency)
    else:
        loss = losses.loss_power(car.motor, torque, speed)
    if power.electrical.modelled == 0.0 or len(table.efficiency) > 0:
        return loss * car.motors[i]
    return (loss + weakening_loss(car.motor, torque, step.voltage, speed)) * car.motors[i]


@inlined
def _heat(car: Car, power: PowerConstants, s: PlanarState, step: Step, current: float) -> None:
    """Heat windings by copper loss, power stages by what grows with the torque, cells by a current [A]; relax these."""
    c, motor, cells, heated = power.electrical, car.motor, car.battery.cells, electrical_side.heated
    for i in range(4):
        torque, speed = step.motor[i], step.shaft[i] * car.gear[i]
        copper = motor.copper_loss * torque * torque * car.driven[i]
        if car.driven[i] == 1.0:
            copper += weakening_loss(motor, torque, step.voltage, speed)
        stage = motor.inverter_torque_loss * abs(torque)
        s.winding_rise[i] = heated(s.winding_rise[i], copper, motor.thermal.winding_resistance, c.winding_left)
        s.inverter_rise[i] = heated(s.inverter_rise[i], stage, motor.thermal.inverter_resistance, c.inverter_left)
    heat = power.resistance * current * current
    if c.relaxation_resistance > 0.0:
        heat += s.relaxation * s.relaxation / c.relaxation_resistance
    s.cells_rise = heated(s.cells_rise, heat / cells.in_series, cells.thermal_resistance, c.cells_left)
    s.relaxation = electrical_side.relaxed(s.relaxation, current, c.relaxation_resistance, c.relaxation_share)


@inlined
def account(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, step: Step) -> None:
    """Book the energies of this step, in which the wheels have `turned`, and discharge the battery."""
    shaft, mean_speed, motor, power, h = step.shaft, step.mean_speed, step.motor, c.power, c.h
    for i in range(4):
        mean_speed[i] = step.turned[i] / h
    driveline.shaft_speeds(car, mean_speed, shaft)
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
    current = electrical_side.current_at_power(source_voltage(s, power), power.resistance, given)
    if power.electrical.modelled == 1.0:
        _heat(car, power, s, step, current)
    s.state_of_charge -= current * h / power.capacity
    s.battery_power = given
    s.battery_work += given * h
    s.motor_loss += loss * h * (1.0 - car.engine_driven)
    s.driveline_loss += (mechanical - drive) * h
    s.auxiliary_work += car.battery.auxiliary_power * h
    s.drive_work += drive * h


@inlined
def apply_drives(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, step: Step) -> None:
    """Set the drive and brake torques of the wheels for this step, in [N m].

    The torque held over the step is the mean of the lagged one, so its impulse is exact. Brushless DC drives take the
    terminal voltage of the step before.
    """
    shaft, target, asked = step.shaft, step.target, step.asked
    motion = s.motion
    wheel_speed = Wheels(motion[WHEEL_SPEED], motion[WHEEL_SPEED + 1], motion[WHEEL_SPEED + 2], motion[WHEEL_SPEED + 3])
    for i in range(4):
        asked[i] = step.drive_command[i]
        if car.blend_brakes == 1.0 and car.driven[i] == 1.0 and step.brake_command[i] > 0.0:
            wanted = behind_gear(car, asked[i], wheel_speed[i])
            wanted -= _blended(car, i, wheel_speed[i], step.brake_command[i])
            asked[i] = before_gear(car, wanted, wheel_speed[i])
    driveline.shaft_speeds(car, wheel_speed, shaft)
    driveline.motor_commands(car, asked, target)
    if car.driveline.coupling == driveline.CLUTCH:
        driveline.follow_shares(car, asked, s.torque_share, c.lags.clutch)
    if car.engine_driven == 1.0:
        _drive_by_engine(car, c, s, step)
    else:
        _drive_by_motors(p, car, c, s, step)
    driveline.wheel_torques(car, target, wheel_speed, s.torque_share, step.drive)
    for i in range(4):
        step.brake[i] = step.brake_command[i]
        if car.blend_brakes == 1.0 and car.driven[i] == 1.0 and step.brake_command[i] > 0.0:
            # The friction brake fills up what the motor does not deliver, because of its limits or its lag.
            delivered = behind_gear(car, step.drive_command[i], wheel_speed[i]) - step.drive[i]
            delivered = delivered if wheel_speed[i] > 0.0 else -delivered
            step.brake[i] -= min(max(delivered, 0.0), step.brake_command[i])


@inlined
def _drive_by_engine(car: Car, c: PlanarConstants, s: PlanarState, step: Step) -> None:
    """Set `step.motor`, equal parts of what the gearbox gives, and `step.target`, those behind the final drive."""
    shaft, target, motor, driven, gear = step.shaft, step.target, step.motor, car.driven, car.gear
    wanted = turning = yielding = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        wanted += target[left] / gear[left] + target[right] / gear[right]
        if driven[left] == 1.0 or driven[right] == 1.0:
            turning = shaft[left] * gear[left]
            yielding = (
                gear[left] * gear[left] / car.motor.gear_efficiency * driveline.shaft_yielding(car, s.torque_share)
            )
    output = driveline.advance_engine(s.engine, car.engine, c.power.gearbox, wanted, turning, yielding, c.h)
    for i in range(4):
        motor[i] = s.motor_torque[i] = output / car.number_driven * driven[i]
        target[i] = behind_gear(car, motor[i] * gear[i], shaft[i])


@inlined
def _drive_by_motors(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, step: Step) -> None:
    """Set `step.motor`, the mean torque of each motor over the step, and `step.target`, what comes out behind gears."""
    shaft, target, motor, gear, power = step.shaft, step.target, step.motor, car.gear, c.power
    modelled = power.electrical.modelled == 1.0
    if modelled:
        step.voltage = terminal_voltage(s, power)
    for i in range(4):
        target[i] = target[i] / gear[i] / car.motors[i]
        if p.drive == TORQUE_CONTROLLED and car.driven[i] == 1.0:
            heat = 0.0 if modelled else s.motor_heat[i]  # temperatures decide how long the peak torque lasts
            target[i] = limited_torque(car.motor, target[i], shaft[i] * gear[i], heat)
            if modelled:
                target[i] = within_electrical_limits(s, car, i, target[i], step.voltage, shaft[i] * gear[i])
    if s.faults.is_struck == 1.0:
        strike_motors(s, p, car, step)
    scale = battery_scale(p, car, c, s, step)
    for i in range(4):
        if car.driven[i] == 0.0:
            motor[i] = target[i] = 0.0
            continue
        if p.drive == TORQUE_CONTROLLED:
            gap = scale * target[i] - s.motor_torque[i]
            motor[i] = s.motor_torque[i] + c.lags.torque_mean * gap
            s.motor_torque[i] += c.lags.torque * gap
            use = motor[i] / car.motor.nominal_torque
            s.motor_heat[i] += c.lags.heat * (use * use - s.motor_heat[i])
        else:
            drive = s.drives[i]
            voltage = terminal_voltage(s, power)
            advance_drive(drive, p, scale * target[i], shaft[i] * gear[i], voltage, c.h)
            motor[i] = drive.mean_torque
            s.motor_torque[i] = drive.torque
        target[i] = behind_gear(car, motor[i] * car.motors[i] * gear[i], shaft[i])


@inlined
def behind_gear(car: Car, torque: float, speed: float) -> float:
    """The torque behind a gear [N m] that turns at a speed [rad/s], from what it would be without losses."""
    efficiency = car.motor.gear_efficiency
    return torque * efficiency if torque * speed >= 0.0 else torque / efficiency


@inlined
def before_gear(car: Car, torque: float, speed: float) -> float:
    """The inverse of `behind_gear`."""
    efficiency = car.motor.gear_efficiency
    return torque / efficiency if torque * speed >= 0.0 else torque * efficiency


@inlined
def _blended(car: Car, i: int, wheel_speed: float, brake: float) -> float:
    """The part of a brake torque that the motors of wheel i are asked for, with the sign of the wheel speed [N m]."""
    motor, gear = car.motor, car.gear[i]
    fade = min(abs(wheel_speed) / car.blend_fade_speed, 1.0)
    limit = (
        min(motor.generator_torque, motor.generator_power / max(abs(wheel_speed) * gear, 1e-9)) * gear * car.motors[i]
    )
    part = min(brake, limit * fade)
    return part if wheel_speed >= 0.0 else -part
