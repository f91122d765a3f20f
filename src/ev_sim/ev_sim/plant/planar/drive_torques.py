"""Motors, driveline and brakes of the planar plant: the torques that are held over a step."""

from __future__ import annotations

from ev_core.law import Car, inlined
from ev_sim.drives.combustion_engine import advance_engine
from ev_sim.drives.couplings import CLUTCH, follow_shares, motor_commands, shaft_speeds, shaft_yielding, wheel_torques
from ev_sim.drives.drive import advance_drive
from ev_sim.drives.synchronous_motor import limited_torque
from ev_sim.plant.planar.car_faults import strike_motors
from ev_sim.plant.planar.energy import battery_scale, terminal_voltage, within_electrical_limits
from ev_sim.plant.planar.given import TORQUE_CONTROLLED, PlanarParameters
from ev_sim.plant.planar.planar_state import WHEEL_SPEED, PlanarState, Step
from ev_sim.plant.planar.prepare import PlanarConstants


@inlined
def apply_drives(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState, step: Step) -> None:
    """Set the drive and brake torques of the wheels for this step, in [N m].

    The torque held over the step is the mean of the lagged one, so its impulse is exact. Brushless DC drives take the
    terminal voltage of the step before.
    """
    shaft, target, asked = step.shaft, step.target, step.asked
    wheel_speed = s.motion[WHEEL_SPEED : WHEEL_SPEED + 4]
    for i in range(4):
        asked[i] = step.drive_command[i]
        if car.blend_brakes == 1.0 and car.driven[i] == 1.0 and step.brake_command[i] > 0.0:
            wanted = behind_gear(car, asked[i], wheel_speed[i])
            wanted -= _blended(car, i, wheel_speed[i], step.brake_command[i])
            asked[i] = before_gear(car, wanted, wheel_speed[i])
    shaft_speeds(car, wheel_speed, shaft)
    motor_commands(car, asked, target)
    if car.driveline.coupling == CLUTCH:
        follow_shares(car, asked, s.torque_share, c.lags.clutch)
    if car.engine_driven == 1.0:
        _drive_by_engine(car, c, s, step)
    else:
        _drive_by_motors(p, car, c, s, step)
    wheel_torques(car, target, wheel_speed, s.torque_share, step.drive)
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
            yielding = gear[left] * gear[left] / car.motor.gear_efficiency * shaft_yielding(car, s.torque_share)
    output = advance_engine(s.engine, car.engine, c.power.gearbox, wanted, turning, yielding, c.h)
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
