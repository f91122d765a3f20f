"""Couplings between the motors and the wheels: individual, open, limited-slip, clutch."""

from __future__ import annotations

from math import tanh

import numpy as np

from ev_sim.compiled import compiled

COUPLINGS = ("individual", "open", "limited_slip", "clutch")

INDIVIDUAL = COUPLINGS.index("individual")
OPEN = COUPLINGS.index("open")
LIMITED_SLIP = COUPLINGS.index("limited_slip")
CLUTCH = COUPLINGS.index("clutch")


@compiled
def shaft_speeds(coupling: int, wheel_speed: np.ndarray, driven: np.ndarray, shaft: np.ndarray) -> None:
    """Speed of the shaft of each wheel's motor, at the wheel side of the gear [rad/s], into `shaft`, shape (4,).

    A differential turns at the mean of its wheels. Slipping clutches only pass torque from a faster to a slower
    shaft, so the one shaft before them turns with the fastest driven wheel. A motor of an axle or of the whole car
    is treated as equal parts, one for each wheel, on a common shaft.
    """
    if coupling == CLUTCH:
        fastest = 0.0
        for i in range(4):
            if driven[i] == 1.0 and abs(wheel_speed[i]) > abs(fastest):
                fastest = wheel_speed[i]
        shaft[0] = shaft[1] = shaft[2] = shaft[3] = fastest
        return
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        shaft[left], shaft[right] = wheel_speed[left], wheel_speed[right]
        if coupling != INDIVIDUAL and driven[left] == 1.0 and driven[right] == 1.0:
            mean = 0.5 * (wheel_speed[left] + wheel_speed[right])
            shaft[left] = shaft[right] = mean


@compiled
def motor_commands(coupling: int, command: np.ndarray, driven: np.ndarray, motor: np.ndarray) -> None:
    """Torque asked of each motor, at the wheel side of the gear [N m], into `motor`; all of shape (4,).

    What is commanded at wheels without a motor is not delivered. Behind a differential only the sum of an axle
    counts, behind clutches only the sum of all.
    """
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


@compiled
def follow_shares(command: np.ndarray, driven: np.ndarray, share: np.ndarray, approach: float) -> None:
    """Let the clutches follow the commanded shares h of the torque [1], in place; all of shape (4,).

    `approach` is 1 - exp(-dt/tau) of the clutch lag. Without torque the shares stay. Source: Zhileykin & Eranosyan
    2018, clutches of the front axle (h_n) and of the rear wheels (h_2, h_4).
    """
    total = (command[0] * driven[0] + command[1] * driven[1]) + (command[2] * driven[2] + command[3] * driven[3])
    if total == 0.0:
        return
    for i in range(4):
        wanted = min(max(command[i] * driven[i] / total, 0.0), 1.0)
        share[i] += approach * (wanted - share[i])


@compiled
def wheel_torques(
    coupling: int,
    motor: np.ndarray,
    wheel_speed: np.ndarray,
    driven: np.ndarray,
    share: np.ndarray,
    preload: float,
    locking_ratio: float,
    locking_speed: float,
    wheel: np.ndarray,
) -> None:
    """Drive torque of each wheel [N m], into `wheel`, from the torques behind the gears; all arrays of shape (4,).

    An open differential passes equal torques. A limited-slip differential adds the locking torque
    preload + locking_ratio |T| from the faster to the slower wheel, its sign smoothed over `locking_speed` [rad/s].
    """
    if coupling == CLUTCH:
        total = (motor[0] + motor[1]) + (motor[2] + motor[3])
        for i in range(4):
            wheel[i] = share[i] * total
        return
    for i in range(4):
        wheel[i] = motor[i]
    if coupling == LIMITED_SLIP:
        for axle in range(2):
            left, right = 2 * axle, 2 * axle + 1
            if driven[left] == 1.0 and driven[right] == 1.0:
                locking = preload + locking_ratio * abs(motor[left] + motor[right])
                moved = 0.5 * locking * tanh((wheel_speed[left] - wheel_speed[right]) / locking_speed)
                wheel[left] -= moved
                wheel[right] += moved
