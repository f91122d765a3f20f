"""Couplings between the motors and the wheels: individual, open, limited-slip, clutch."""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import tanh
from ev_msgs_py.vehicle.car import Car

COUPLINGS = ("individual", "open", "limited_slip", "clutch")
INDIVIDUAL, OPEN, LIMITED_SLIP, CLUTCH = range(len(COUPLINGS))


@inlined
def shaft_speeds(car: Car, wheel_speed: Sequence[float], shaft: MutableSequence[float]) -> None:
    """Speed of the shaft of each wheel's motor, at the wheel side of the gear [rad/s], into `shaft`.

    A differential turns at the mean of its wheels. Slipping clutches only pass torque from a faster to a slower
    shaft, so the one shaft before them turns with the fastest driven wheel. A motor of an axle or of the whole car
    is treated as equal parts, one for each wheel, on a common shaft.
    """
    coupling, driven = car.driveline.coupling, car.driven
    if coupling == CLUTCH:
        fastest = 0.0
        for i in range(4):
            if driven[i] == 1.0 and abs(wheel_speed[i]) > abs(fastest):
                fastest = wheel_speed[i]
        for i in range(4):
            shaft[i] = fastest
        return
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        shaft[left], shaft[right] = wheel_speed[left], wheel_speed[right]
        if coupling != INDIVIDUAL and driven[left] == 1.0 and driven[right] == 1.0:
            mean = 0.5 * (wheel_speed[left] + wheel_speed[right])
            shaft[left] = shaft[right] = mean


@inlined
def motor_commands(car: Car, command: Sequence[float], motor: MutableSequence[float]) -> None:
    """Torque asked of each motor, at the wheel side of the gear [N m], into `motor`.

    What is commanded at wheels without a motor is not delivered. Behind a differential only the sum of an axle
    counts, behind clutches only the sum of all.
    """
    coupling, driven = car.driveline.coupling, car.driven
    for i in range(4):
        motor[i] = command[i] * driven[i]
    if coupling == CLUTCH:
        count = (driven[0] + driven[1]) + (driven[2] + driven[3])
        total = (motor[0] + motor[1]) + (motor[2] + motor[3])
        for i in range(4):
            motor[i] = driven[i] * total / max(count, 1.0)
    elif coupling != INDIVIDUAL:
        for axle in range(2):
            left, right = 2 * axle, 2 * axle + 1
            if driven[left] == 1.0 and driven[right] == 1.0:
                motor[left] = motor[right] = 0.5 * (motor[left] + motor[right])


@inlined
def follow_shares(car: Car, command: Sequence[float], share: MutableSequence[float], approach: float) -> None:
    """Let the clutches follow the commanded shares h of the torque [1], in place.

    `approach` is 1 - exp(-dt/tau) of the clutch lag. Without torque the shares stay. Source: Zhileykin & Eranosyan
    2018, clutches of the front axle (h_n) and of the rear wheels (h_2, h_4).
    """
    driven = car.driven
    total = (command[0] * driven[0] + command[1] * driven[1]) + (command[2] * driven[2] + command[3] * driven[3])
    if total == 0.0:
        return
    for i in range(4):
        wanted = min(max(command[i] * driven[i] / total, 0.0), 1.0)
        share[i] += approach * (wanted - share[i])


@inlined
def wheel_torques(
    car: Car,
    motor: Sequence[float],
    wheel_speed: Sequence[float],
    share: Sequence[float],
    wheel: MutableSequence[float],
) -> None:
    """Drive torque of each wheel [N m], into `wheel`, from the torques behind the gears and the shares of the clutches.

    An open differential passes equal torques. A limited-slip differential adds the locking torque
    preload + locking_ratio |T| from the faster to the slower wheel, its sign smoothed over `locking_speed` [rad/s].
    """
    driveline, driven = car.driveline, car.driven
    if driveline.coupling == CLUTCH:
        total = (motor[0] + motor[1]) + (motor[2] + motor[3])
        for i in range(4):
            wheel[i] = share[i] * total
        return
    for i in range(4):
        wheel[i] = motor[i]
    if driveline.coupling == LIMITED_SLIP:
        for axle in range(2):
            left, right = 2 * axle, 2 * axle + 1
            if driven[left] == 1.0 and driven[right] == 1.0:
                locking = driveline.preload + driveline.locking_ratio * abs(motor[left] + motor[right])
                moved = 0.5 * locking * tanh((wheel_speed[left] - wheel_speed[right]) / driveline.locking_speed)
                wheel[left] -= moved
                wheel[right] += moved
