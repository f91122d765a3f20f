"""Battery, motors, driveline and brakes of the planar plant, step by step.

How it works: `apply_drives` turns the commanded torques of a step into those that motors or engine
can give, leads them through gears, differentials and clutches to the wheels, and lets the friction
brakes do the rest. The limits come one after the other: speed and heat of the motor, voltage and
temperatures where the electrical side is modelled, faults, the power of the battery, the lag.
The torques are then held while body and wheels are integrated. `account` afterwards books the
energies by the angles through which the wheels have really turned.
"""

from __future__ import annotations

from ev_core.law import Car, inlined
from ev_core.vehicle import losses
from ev_sim.drives import driveline, electrical_side
from ev_sim.drives.drive import advance_drive
from ev_sim.drives.driveline import before_gear, behind_gear
from ev_sim.drives.synchronous_motor import limited_torque, voltage_limited_torque, weakening_loss
from ev_sim.plant.planar.given import TORQUE_CONTROLLED, strike_motors
from ev_sim.plant.planar.model import Plant
from ev_sim.plant.planar.planar_state import WHEEL_SPEED, PlanarState, Step, wheels_from
from ev_sim.plant.planar.prepare import PowerConstants


@inlined
def within_electrical_limits(
    s: PlanarState, car: Car, i: int, torque: float, voltage: float, speed: float
) -> float:
    """Limit the torque of a motor of wheel i [N m] by voltage [V] and temperatures.

    `speed` is that of the shaft [rad/s].
    """
    thermal = car.motor.thermal
    winding = thermal.coolant + s.winding_rise[i]
    inverter = thermal.coolant + s.inverter_rise[i]
    share = electrical_side.derating_share(thermal, winding, inverter)
    # The limits by voltage and temperature are the same in both directions.
    most = voltage_limited_torque(car.motor.winding, voltage, speed)
    most = min(most, car.motor.peak_torque * share)
    return min(max(torque, -most), most)


@inlined
def source_voltage(s: PlanarState, power: PowerConstants) -> float:
    """Voltage of the battery without what its resistance takes at once [V]."""
    return electrical_side.open_circuit_voltage(power.voltage, s.state_of_charge) - s.relaxation


@inlined
def terminal_voltage(s: PlanarState, power: PowerConstants) -> float:
    """Voltage at the terminals of the battery under the power of the last step [V]."""
    source = source_voltage(s, power)
    current = electrical_side.current_at_power(source, power.resistance, s.battery_power)
    return source - power.resistance * current


@inlined
def battery_scale(plant: Plant) -> float:
    """Factor on all motor torques [1] that keeps the battery within its limits.

    Losses are convex in the torque and at least the idle ones, so the factor errs on the safe side.
    """
    _, car, _, s, step = plant
    shaft, target = step.shaft, step.target
    mechanical = wanted = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_loss = drive_loss(plant, left, target[left], shaft[left])
        right_loss = drive_loss(plant, right, target[right], shaft[right])
        wanted += left_loss + right_loss
        powers = (target[left] * shaft[left] + target[right] * shaft[right]) * car.gear[left]
        mechanical += powers * car.motors[left]
    wanted += mechanical + car.battery.auxiliary_power
    give, take = _battery_limits(plant)
    give, take = s.faults.power * give, s.faults.power * take
    too_much_given = wanted > give
    too_much_taken = wanted < -take and mechanical < 0.0
    if not too_much_given and not too_much_taken:
        return 1.0  # nearly always: the idle losses need not be looked up
    idle = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_idle = drive_loss(plant, left, 0.0, shaft[left])
        idle += left_idle + drive_loss(plant, right, 0.0, shaft[right])
    idle += car.battery.auxiliary_power
    # A convex power lies below its chord from idle to wanted, so what is given stays within the
    # limit.
    if too_much_given and wanted > idle:
        return min(max((give - idle) / (wanted - idle), 0.0), 1.0)
    # mechanical < 0 scales alike, and losses above idle only leave less for the battery to take.
    if too_much_taken:
        return min(max((-take - idle) / mechanical, 0.0), 1.0)
    return 1.0


@inlined
def _battery_limits(plant: Plant) -> tuple[float, float]:
    """Largest power out of and into the battery [W], without faults."""
    battery = plant.car.battery
    s = plant.s
    power = plant.c.power
    electrical = power.electrical
    source = source_voltage(s, power)
    if electrical.modelled == 0.0:
        return electrical_side.power_limits(battery, source, s.state_of_charge)
    temperature = battery.cells.ambient + s.cells_rise
    share = electrical_side.temperature_share
    discharging = share(electrical.discharge_temperature, temperature)
    charging = share(electrical.charge_temperature, temperature)
    return electrical_side.cell_power_limits(
        battery, source, power.resistance, s.state_of_charge, discharging, charging
    )


@inlined
def drive_loss(plant: Plant, i: int, torque: float, shaft: float) -> float:
    """Loss of the motors of wheel i [W] at a torque each [N m]; none where there is none.

    `shaft` is the speed behind the gear [rad/s]. A map contains what field weakening takes.
    """
    car, power = plant.car, plant.c.power
    if car.driven[i] == 0.0:
        return 0.0
    speed, table = shaft * car.gear[i], power.map
    if plant.p.drive != TORQUE_CONTROLLED:  # brushless drives bring their own losses
        loss = 0.0
    elif len(table.efficiency) > 0:
        loss = losses.map_loss_power(torque, speed, table.speed, table.torque, table.efficiency)
    else:
        loss = losses.loss_power(car.motor, torque, speed)
    if power.electrical.modelled == 0.0 or len(table.efficiency) > 0:
        return loss * car.motors[i]
    loss += weakening_loss(car.motor, torque, plant.step.voltage, speed)
    return loss * car.motors[i]


@inlined
def _heat(plant: Plant, current: float) -> None:
    """Heat windings, power stages and cells over a step, and relax the cells.

    The current is that of the cells [A]. Copper loss heats windings, and what grows with the torque
    heats power stages.
    """
    _, car, c, s, step = plant
    motor, cells = car.motor, car.battery.cells
    electrical, heated = c.power.electrical, electrical_side.heated
    for i in range(4):
        torque, speed = step.motor[i], step.shaft[i] * car.gear[i]
        copper = motor.copper_loss * torque * torque * car.driven[i]
        if car.driven[i] == 1.0:
            copper += weakening_loss(motor, torque, step.voltage, speed)
        stage = motor.inverter_torque_loss * abs(torque)
        s.winding_rise[i] = heated(
            s.winding_rise[i], copper, motor.thermal.winding_resistance, electrical.winding_left
        )
        s.inverter_rise[i] = heated(
            s.inverter_rise[i], stage, motor.thermal.inverter_resistance, electrical.inverter_left
        )
    resistance = electrical.relaxation_resistance
    heat = c.power.resistance * current * current
    if resistance > 0.0:
        heat += s.relaxation * s.relaxation / resistance
    s.cells_rise = heated(
        s.cells_rise, heat / cells.in_series, cells.thermal_resistance, electrical.cells_left
    )
    s.relaxation = electrical_side.relaxed(
        s.relaxation, current, resistance, electrical.relaxation_share
    )


@inlined
def account(plant: Plant) -> None:
    """Book the energies of a step, in which the wheels have `turned`, and discharge the battery."""
    p, car, c, s, step = plant
    shaft = step.shaft
    mean_speed = step.mean_speed
    motor = step.motor
    for i in range(4):
        mean_speed[i] = step.turned[i] / c.h
    driveline.shaft_speeds(car, mean_speed, shaft)
    mechanical = loss = drive = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_speed, right_speed = shaft[left] * car.gear[left], shaft[right] * car.gear[right]
        powers = motor[left] * left_speed + motor[right] * right_speed
        mechanical += powers * car.motors[left]
        left_loss = drive_loss(plant, left, motor[left], shaft[left])
        loss += left_loss + drive_loss(plant, right, motor[right], shaft[right])
        drive += step.drive[left] * mean_speed[left] + step.drive[right] * mean_speed[right]
    if p.drive != TORQUE_CONTROLLED:
        loss = 0.0
        for axle in range(2):
            left, right = s.drives[2 * axle], s.drives[2 * axle + 1]
            loss += left.electrical_power + right.electrical_power
        # A brushless drive books its electrical power; what is not mechanical of it is loss.
        loss -= mechanical
    if car.engine_driven == 1.0:
        # The converter, from pump to the output of the gearbox.
        s.driveline_loss += (s.engine.taken - mechanical) * c.h
        loss = -mechanical  # of a battery that gives nothing to the engine
    s.motor_loss += loss * c.h * (1.0 - car.engine_driven)
    s.driveline_loss += (mechanical - drive) * c.h
    s.drive_work += drive * c.h
    given = mechanical + loss + car.battery.auxiliary_power
    current = discharge(plant, given)
    if c.power.electrical.modelled == 1.0:
        _heat(plant, current)


@inlined
def discharge(plant: Plant, given: float) -> float:
    """Take a power [W] from the battery over a step, and book it; its current [A]."""
    _, car, c, s, _ = plant
    power = c.power
    current = electrical_side.current_at_power(source_voltage(s, power), power.resistance, given)
    s.state_of_charge -= current * c.h / power.capacity
    s.battery_power = given
    s.battery_work += given * c.h
    s.auxiliary_work += car.battery.auxiliary_power * c.h
    return current


@inlined
def apply_drives(plant: Plant) -> None:
    """Set the drive and brake torques of the wheels for this step, in [N m].

    The torque held over the step is the mean of the lagged one, so its impulse is exact. Brushless
    DC drives take the terminal voltage of the step before.
    """
    _, car, c, s, step = plant
    target, asked = step.target, step.asked
    wheel_speed = wheels_from(s.motion, WHEEL_SPEED)
    for i in range(4):
        asked[i] = step.drive_command[i]
        if _is_blended(car, step, i):
            # Drive and regenerative torque meet at the wheel, and the motor is asked for both in
            # one.
            wanted = behind_gear(car, asked[i], wheel_speed[i])
            wanted -= _blended(car, i, wheel_speed[i], step.brake_command[i])
            asked[i] = before_gear(car, wanted, wheel_speed[i])
    driveline.shaft_speeds(car, wheel_speed, step.shaft)
    driveline.motor_commands(car, asked, target)
    if car.driveline.coupling == driveline.CLUTCH:
        driveline.follow_shares(car, asked, s.torque_share, c.lags.clutch)
    if car.engine_driven == 1.0:
        _drive_by_engine(plant)
    else:
        _drive_by_motors(plant)
    driveline.wheel_torques(car, target, wheel_speed, s.torque_share, step.drive)
    for i in range(4):
        step.brake[i] = step.brake_command[i]
        if _is_blended(car, step, i):
            # The friction brake fills up what the motor does not deliver, by its limits or its lag.
            delivered = behind_gear(car, step.drive_command[i], wheel_speed[i]) - step.drive[i]
            # Positive where it slows the wheel down, whichever way this turns.
            delivered = delivered if wheel_speed[i] > 0.0 else -delivered
            step.brake[i] -= min(max(delivered, 0.0), step.brake_command[i])


@inlined
def _is_blended(car: Car, step: Step, i: int) -> bool:
    """True if the motors of wheel i take part in its braking."""
    return car.blend_brakes == 1.0 and car.driven[i] == 1.0 and step.brake_command[i] > 0.0


@inlined
def _drive_by_engine(plant: Plant) -> None:
    """Set `step.motor`, equal parts of the engine's torque, and `step.target`, behind gears."""
    _, car, c, s, step = plant
    shaft = step.shaft
    target = step.target
    motor = step.motor
    gear = car.gear
    wanted = turning = yielding = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        wanted += target[left] / gear[left] + target[right] / gear[right]
        if car.driven[left] == 1.0 or car.driven[right] == 1.0:
            # One shaft drives all: any driven axle shows its speed.
            turning = shaft[left] * gear[left]
            yielding = gear[left] * gear[left] / car.motor.gear_efficiency
            yielding *= driveline.shaft_yielding(car, s.torque_share)
    load = driveline.GearboxLoad(wanted, turning, yielding)
    output = driveline.advance_engine(s.engine, car.engine, c.power.gearbox, load, c.h)
    for i in range(4):
        motor[i] = s.motor_torque[i] = output / car.number_driven * car.driven[i]
        target[i] = behind_gear(car, motor[i] * gear[i], shaft[i])


@inlined
def _drive_by_motors(plant: Plant) -> None:
    """Set `step.motor`, the mean motor torque over the step, and `step.target`, behind gears."""
    p, car, c, s, step = plant
    shaft = step.shaft
    target = step.target
    motor = step.motor
    gear = car.gear
    _limit_motors(plant)
    if s.faults.is_struck == 1.0:
        strike_motors(s, p, car, step)
    scale = battery_scale(plant)
    for i in range(4):
        if car.driven[i] == 0.0:
            motor[i] = target[i] = 0.0
            continue
        if p.drive == TORQUE_CONTROLLED:
            # The mean comes first, since it starts from the torque at the beginning of the step.
            gap = scale * target[i] - s.motor_torque[i]
            motor[i] = s.motor_torque[i] + c.lags.torque_mean * gap
            s.motor_torque[i] += c.lags.torque * gap
            use = motor[i] / car.motor.nominal_torque
            s.motor_heat[i] += c.lags.heat * (use * use - s.motor_heat[i])
        else:
            drive = s.drives[i]
            voltage = terminal_voltage(s, c.power)
            advance_drive(drive, p, scale * target[i], shaft[i] * gear[i], voltage, c.h)
            motor[i] = drive.mean_torque
            s.motor_torque[i] = drive.torque
        target[i] = behind_gear(car, motor[i] * car.motors[i] * gear[i], shaft[i])


@inlined
def _limit_motors(plant: Plant) -> None:
    """Turn `step.target` into torques of single motors, within their limits."""
    p, car, c, s, step = plant
    shaft = step.shaft
    target = step.target
    gear = car.gear
    modelled = c.power.electrical.modelled == 1.0
    if modelled:
        step.voltage = terminal_voltage(s, c.power)
    for i in range(4):
        target[i] = target[i] / gear[i] / car.motors[i]
        if p.drive == TORQUE_CONTROLLED and car.driven[i] == 1.0:
            speed = shaft[i] * gear[i]
            # Where temperatures are modelled they decide how long the peak torque lasts.
            heat = 0.0 if modelled else s.motor_heat[i]
            target[i] = limited_torque(car.motor, target[i], speed, heat)
            if modelled:
                target[i] = within_electrical_limits(s, car, i, target[i], step.voltage, speed)


@inlined
def _blended(car: Car, i: int, wheel_speed: float, brake: float) -> float:
    """Part of a brake torque [N m] that the motors of wheel i are asked for.

    It has the sign of the wheel speed.
    """
    motor, gear = car.motor, car.gear[i]
    fade = min(abs(wheel_speed) / car.blend_fade_speed, 1.0)
    # At rest a power allows any torque; the 1e-9 keeps the division.
    at_power = motor.generator_power / max(abs(wheel_speed) * gear, 1e-9)
    limit = min(motor.generator_torque, at_power) * gear * car.motors[i]
    part = min(brake, limit * fade)
    return part if wheel_speed >= 0.0 else -part
