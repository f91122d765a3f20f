"""Couplings between motors, or an engine, and the wheels: differentials with and without locks, and clutches."""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence

from ev_core.law import Car, inlined, tanh
from ev_core.vehicle.driveline import COUPLINGS

INDIVIDUAL, OPEN, LIMITED_SLIP, CLUTCH, CENTRE = range(len(COUPLINGS))


@inlined
def shaft_speeds(car: Car, wheel_speed: Sequence[float], shaft: MutableSequence[float]) -> None:
    """Speed of the shaft of each wheel's motor, at the wheel side of the gear [rad/s], into `shaft`.

    A differential turns at the mean of its wheels, a centre differential at that of its axles, each by its share of the
    torque. Slipping clutches only pass torque from a faster to a slower shaft, so the one shaft before them turns with
    the fastest driven wheel. A motor of an axle or of the whole car is treated as equal parts, one for each wheel, on a
    common shaft.
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
        if car.differential[axle] == 1.0:
            mean = 0.5 * (wheel_speed[left] + wheel_speed[right])
            shaft[left] = shaft[right] = mean
    if coupling == CENTRE:
        share = car.driveline.front_share
        mean = share * shaft[0] + (1.0 - share) * shaft[2]
        for i in range(4):
            shaft[i] = mean


@inlined
def shaft_yielding(car: Car, share: Sequence[float]) -> float:
    """What the one shaft of a car gains in acceleration per torque on it [1/(kg m^2)], wheels lifted off the road.

    Behind clutches it is that of the wheel that yields most, whichever is the fastest.
    """
    inertia, front = car.driven_wheel_inertia, car.driven[0]
    if car.driveline.coupling == CLUTCH:
        return max(max(share[0] / inertia[0], share[1] / inertia[1]), max(share[2] / inertia[2], share[3] / inertia[3]))
    if car.driveline.coupling == CENTRE:
        front = car.driveline.front_share
    front_part = 0.25 * front * front * (1.0 / inertia[0] + 1.0 / inertia[1])
    rear = 1.0 - front
    return front_part + 0.25 * rear * rear * (1.0 / inertia[2] + 1.0 / inertia[3])


@inlined
def motor_commands(car: Car, command: Sequence[float], motor: MutableSequence[float]) -> None:
    """Torque asked of each motor, at the wheel side of the gear [N m], into `motor`.

    What is commanded at wheels without a motor is not delivered. Behind a differential only the sum of an axle
    counts, behind clutches and a centre differential only the sum of all.
    """
    driven = car.driven
    for i in range(4):
        motor[i] = command[i] * driven[i]
    if car.one_input == 1.0:
        count = (driven[0] + driven[1]) + (driven[2] + driven[3])
        total = (motor[0] + motor[1]) + (motor[2] + motor[3])
        for i in range(4):
            motor[i] = driven[i] * total / max(count, 1.0)
        return
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        if car.differential[axle] == 1.0:
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
    car: Car, motor: Sequence[float], speed: Sequence[float], share: Sequence[float], wheel: MutableSequence[float]
) -> None:
    """Drive torque of each wheel [N m], into `wheel`, from the torques behind the gears and the shares of the clutches.

    An open differential passes equal torques, a centre one those of its share. One that locks moves half its locking
    torque, preload + share |T|, from the faster to the slower side; its sign is smoothed over `locking_speed` [rad/s].
    """
    driveline = car.driveline
    if driveline.coupling == CLUTCH:
        total = (motor[0] + motor[1]) + (motor[2] + motor[3])
        for i in range(4):
            wheel[i] = share[i] * total
        return
    for i in range(4):
        wheel[i] = motor[i]
    if driveline.coupling == CENTRE:
        total = (motor[0] + motor[1]) + (motor[2] + motor[3])
        apart = 0.5 * (speed[0] + speed[1]) - 0.5 * (speed[2] + speed[3])
        locking = car.centre_preload + car.centre_locking * abs(total)
        front = driveline.front_share * total - 0.5 * locking * tanh(apart / driveline.locking_speed)
        wheel[0] = wheel[1] = 0.5 * front
        wheel[2] = wheel[3] = 0.5 * (total - front)
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        if car.differential[axle] == 1.0 and car.axle_preload[axle] + car.axle_locking[axle] > 0.0:
            locking = car.axle_preload[axle] + car.axle_locking[axle] * abs(wheel[left] + wheel[right])
            moved = 0.5 * locking * tanh((speed[left] - speed[right]) / driveline.locking_speed)
            wheel[left] -= moved
            wheel[right] += moved
