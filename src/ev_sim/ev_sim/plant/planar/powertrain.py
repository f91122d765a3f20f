"""Motors, driveline, brakes and battery of the planar plant, once per step before and after the body moves."""

from __future__ import annotations

import numpy as np

from ev_sim.battery.resistive import current_at_power, open_circuit_voltage, power_limits
from ev_sim.compiled import compiled
from ev_sim.driveline.couplings import CLUTCH, follow_shares, motor_commands, shaft_speeds, wheel_torques
from ev_sim.drives.drive import advance_drive
from ev_sim.drives.losses import loss_power, map_loss_power
from ev_sim.drives.torque_controlled import limited_torque
from ev_sim.plant.planar.body import WHEEL_SPEED
from ev_sim.plant.planar.state import index

MOTOR_TORQUE = index("motor_torque")
MOTOR_HEAT = index("motor_heat")
TORQUE_SHARE = index("torque_share")
STATE_OF_CHARGE = index("state_of_charge")
BATTERY_POWER = index("battery_power")
BATTERY_WORK = index("battery_work")
MOTOR_LOSS = index("motor_loss")
DRIVELINE_LOSS = index("driveline_loss")
AUXILIARY_WORK = index("auxiliary_work")
DRIVE_WORK = index("drive_work")


@compiled
def motor_loss(car, maps, torque: float, speed: float) -> float:
    """Loss of one motor with inverter [W] at its shaft torque [N m] and speed [rad/s]; `maps` is None without a map."""
    if maps is None:
        return loss_power(
            torque, speed, car.copper_loss, car.iron_loss, car.eddy_loss, car.inverter_loss, car.inverter_torque_loss
        )
    speeds, torques, efficiency = maps
    return map_loss_power(torque, speed, speeds, torques, efficiency)


@compiled
def apply_drives(
    state: np.ndarray, car, step, maps, voltages: np.ndarray, lags, brushless, h: float, work: np.ndarray
) -> None:
    """Set the drive and brake torques of the wheels for this step of h [s], in [N m].

    `lags` holds, for this step width, 1 - exp(-h/tau) and the mean of the decay over the step for the torque, and
    1 - exp(-h/tau) for the clutches and the motor heat. The torque held over the step is the mean of the lagged
    one, so its impulse is exact. `brushless` holds the states and the parameters of brushless DC drives, which take the
    terminal voltage of the step before. `work` of shape (4, 4) keeps shaft speeds, targets and the mean motor torques.
    """
    torque_approach, torque_mean, clutch_approach, heat_approach = lags
    wheel_speed = state[WHEEL_SPEED : WHEEL_SPEED + 4]
    share = state[TORQUE_SHARE : TORQUE_SHARE + 4]
    shaft, target, held, asked = work[0], work[1], work[2], work[3]
    for i in range(4):
        asked[i] = step.drive_command[i]
        if car.blend_brakes == 1:
            asked[i] -= _blended(car, wheel_speed[i], step.brake_command[i]) * car.driven[i]
    shaft_speeds(car.coupling, wheel_speed, car.driven, shaft)
    motor_commands(car.coupling, asked, car.driven, target)
    if car.coupling == CLUTCH:
        follow_shares(asked, car.driven, share, clutch_approach)
    for i in range(4):
        target[i] /= car.gear
        if car.brushless == 0 and car.driven[i] == 1.0:
            target[i] = limited_torque(
                target[i],
                shaft[i] * car.gear,
                state[MOTOR_HEAT + i],
                car.peak_torque,
                car.nominal_torque,
                car.peak_power,
                car.maximum_speed,
                car.generator_torque,
                car.generator_power,
            )
    scale = battery_scale(state, car, maps, voltages, shaft, target)
    for i in range(4):
        if car.driven[i] == 0.0:
            held[i] = target[i] = 0.0
            continue
        if car.brushless == 1:
            drives, parameters = brushless
            voltage = terminal_voltage(state, car, voltages)
            advance_drive(drives[i], parameters, scale * target[i], shaft[i] * car.gear, voltage, h)
            held[i] = drives[i].mean_torque
            state[MOTOR_TORQUE + i] = drives[i].torque
        else:
            gap = scale * target[i] - state[MOTOR_TORQUE + i]
            held[i] = state[MOTOR_TORQUE + i] + torque_mean * gap
            state[MOTOR_TORQUE + i] += torque_approach * gap
            use = held[i] / car.nominal_torque
            state[MOTOR_HEAT + i] += heat_approach * (use * use - state[MOTOR_HEAT + i])
        behind = held[i] * car.gear
        target[i] = behind * car.gear_efficiency if held[i] * shaft[i] >= 0.0 else behind / car.gear_efficiency
    wheel_torques(
        car.coupling, target, wheel_speed, car.driven, share, car.preload, car.locking_ratio, car.locking_speed,
        step.drive,
    )  # fmt: skip
    for i in range(4):
        step.brake[i] = step.brake_command[i]
        if car.blend_brakes == 1 and asked[i] != step.drive_command[i]:
            # The friction brake fills up what the motor does not deliver, because of its limits or its lag.
            delivered = step.drive_command[i] - step.drive[i]
            delivered = delivered if wheel_speed[i] > 0.0 else -delivered
            step.brake[i] -= min(max(delivered, 0.0), step.brake_command[i])


@compiled
def terminal_voltage(state: np.ndarray, car, voltages: np.ndarray) -> float:
    """Voltage at the terminals of the battery under the power of the last step [V]."""
    source = open_circuit_voltage(voltages, state[STATE_OF_CHARGE])
    return source - car.battery_resistance * current_at_power(source, car.battery_resistance, state[BATTERY_POWER])


@compiled
def _blended(car, wheel_speed: float, brake: float) -> float:
    """The part of a brake torque that the motor is asked for, with the sign of the wheel speed [N m]."""
    fade = min(abs(wheel_speed) / car.blend_fade_speed, 1.0)
    limit = min(car.generator_torque, car.generator_power / max(abs(wheel_speed) * car.gear, 1e-9)) * car.gear
    part = min(brake, limit * fade)
    return part if wheel_speed >= 0.0 else -part


@compiled
def battery_scale(state: np.ndarray, car, maps, voltages: np.ndarray, shaft: np.ndarray, target: np.ndarray) -> float:
    """Factor on all motor torques [1] that keeps the battery within its limits.

    Losses are convex in the torque and at least the idle ones, so the factor errs on the safe side.
    """
    idle = mechanical = wanted = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_idle, left_loss = _idle_and_loss(car, maps, target[left], shaft[left], car.driven[left])
        right_idle, right_loss = _idle_and_loss(car, maps, target[right], shaft[right], car.driven[right])
        idle += left_idle + right_idle
        wanted += left_loss + right_loss
        mechanical += (target[left] * shaft[left] + target[right] * shaft[right]) * car.gear
    idle += car.auxiliary_power
    wanted += mechanical + car.auxiliary_power
    charge = state[STATE_OF_CHARGE]
    give, take = power_limits(
        open_circuit_voltage(voltages, charge), car.battery_resistance, charge, car.discharge_power, car.charge_power
    )
    if wanted > give and wanted > idle:
        return min(max((give - idle) / (wanted - idle), 0.0), 1.0)
    if wanted < -take and mechanical < 0.0:
        return min(max((-take - idle) / mechanical, 0.0), 1.0)
    return 1.0


@compiled
def _idle_and_loss(car, maps, torque: float, shaft: float, driven: float) -> tuple[float, float]:
    if driven == 0.0:
        return 0.0, 0.0
    speed = shaft * car.gear
    return motor_loss(car, maps, 0.0, speed), motor_loss(car, maps, torque, speed)


@compiled
def account(
    state: np.ndarray, car, step, maps, voltages: np.ndarray, brushless, turned: np.ndarray, h: float, work: np.ndarray
) -> None:
    """Book the energies of this step of h [s] and discharge the battery; `turned` [rad] are the wheels' angles."""
    shaft, mean_speed, held = work[0], work[1], work[2]
    for i in range(4):
        mean_speed[i] = turned[i] / h
    shaft_speeds(car.coupling, mean_speed, car.driven, shaft)
    mechanical = loss = drive = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_speed, right_speed = shaft[left] * car.gear, shaft[right] * car.gear
        mechanical += held[left] * left_speed + held[right] * right_speed
        loss += car.driven[left] * motor_loss(car, maps, held[left], left_speed) + car.driven[right] * motor_loss(
            car, maps, held[right], right_speed
        )
        drive += step.drive[left] * mean_speed[left] + step.drive[right] * mean_speed[right]
    if car.brushless == 1:
        drives, _ = brushless
        loss = 0.0
        for axle in range(2):
            loss += drives[2 * axle].electrical_power + drives[2 * axle + 1].electrical_power
        loss -= mechanical
    power = mechanical + loss + car.auxiliary_power
    current = current_at_power(open_circuit_voltage(voltages, state[STATE_OF_CHARGE]), car.battery_resistance, power)
    state[STATE_OF_CHARGE] -= current * h / car.battery_charge
    state[BATTERY_POWER] = power
    state[BATTERY_WORK] += power * h
    state[MOTOR_LOSS] += loss * h
    state[DRIVELINE_LOSS] += (mechanical - drive) * h
    state[AUXILIARY_WORK] += car.auxiliary_power * h
    state[DRIVE_WORK] += drive * h
