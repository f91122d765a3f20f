"""Couplings between motors and wheels, and an engine with converter and gearbox.

How it works: a coupling is three functions, called in this order in each step of a plant. Speeds
go from the wheels to the shafts of the motors (`shaft_speeds`), commands from the wheels to the
motors (`motor_commands`), and torques from the motors back to the wheels (`wheel_torques`), so that
power in is power out but for what a clutch or a locking differential takes. An engine stands in the
place of the motors: its crankshaft drives the pump of a torque converter, the turbine drives the
gearbox. Only the converter is stiff, and `advance_engine` takes it implicitly.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, compilable, entry, inlined, tanh
from ev_core.vehicle.driveline import COUPLINGS
from ev_core.vehicle.motor import Engine, speed_fade

INDIVIDUAL, OPEN, LIMITED_SLIP, CLUTCH, CENTRE = range(len(COUPLINGS))


# Speed ratio at which the stator runs free: there the converter's two torques meet, and those of
# the coupling begin.
COUPLING_POINT = 0.8831
# The steepest change of either torque with either speed, of a converter of size 1 and over the
# faster speed [N m s^2/rad^2]: that of the coupling at equal speeds.
STEEPEST = 18.4858e-3


@inlined
def behind_gear(car: Car, torque: float, speed: float) -> float:
    """Torque behind a gear [N m] that turns at a speed [rad/s], from that without losses."""
    efficiency = car.motor.gear_efficiency
    # A braking wheel has the larger torque of both: the gear's loss helps to brake. Rest counts
    # as driving.
    return torque * efficiency if torque * speed >= 0.0 else torque / efficiency


@inlined
def before_gear(car: Car, torque: float, speed: float) -> float:
    """Torque without losses [N m] that gives a torque behind the gear: undoes `behind_gear`."""
    efficiency = car.motor.gear_efficiency
    return torque / efficiency if torque * speed >= 0.0 else torque * efficiency


@inlined
def shaft_speeds(car: Car, wheel_speed: Sequence[float], shaft: MutableSequence[float]) -> None:
    """Speed of each wheel's motor shaft, at the wheel side of the gear [rad/s], into `shaft`.

    A differential turns at the mean of its wheels, a centre differential at that of its axles, each
    by its share of the torque. Slipping clutches only pass torque from a faster to a slower shaft,
    so the one shaft before them turns with the fastest driven wheel. A motor of an axle or of the
    whole car is treated as equal parts, one for each wheel, on a common shaft.
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
        # Both wheels of an axle have its mean already, so either stands for it.
        share = car.driveline.front_share
        mean = share * shaft[0] + (1.0 - share) * shaft[2]
        for i in range(4):
            shaft[i] = mean


@inlined
def shaft_yielding(car: Car, share: Sequence[float]) -> float:
    """Gain in acceleration of a car's one shaft per torque on it [1/(kg m^2)].

    The wheels are lifted off the road. Behind clutches it is that of the wheel that yields most,
    whichever is the fastest.
    """
    inertia, front = car.driven_wheel_inertia, car.driven[0]
    if car.driveline.coupling == CLUTCH:
        return max(
            max(share[0] / inertia[0], share[1] / inertia[1]),
            max(share[2] / inertia[2], share[3] / inertia[3]),
        )
    if car.driveline.coupling == CENTRE:
        front = car.driveline.front_share
    front_part = 0.25 * front * front * (1.0 / inertia[0] + 1.0 / inertia[1])
    rear = 1.0 - front
    return front_part + 0.25 * rear * rear * (1.0 / inertia[2] + 1.0 / inertia[3])


@inlined
def motor_commands(car: Car, command: Sequence[float], motor: MutableSequence[float]) -> None:
    """Torque asked of each motor, at the wheel side of the gear [N m], into `motor`.

    What is commanded at wheels without a motor is not delivered. Behind a differential only the sum
    of an axle counts, behind clutches and a centre differential only the sum of all.
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
def follow_shares(
    car: Car, command: Sequence[float], share: MutableSequence[float], approach: float
) -> None:
    """Let the clutches follow the commanded shares h of the torque [1], in place.

    `approach` is 1 - exp(-dt/tau) of the clutch lag. Without torque the shares stay. Source:
    Zhileykin & Eranosyan 2018, clutches of the front axle (h_n) and of the rear wheels (h_2, h_4).
    """
    driven = car.driven
    total = (command[0] * driven[0] + command[1] * driven[1]) + (
        command[2] * driven[2] + command[3] * driven[3]
    )
    # 0/0 has no shares; a coasting driver does not move the clutches.
    if total == 0.0:
        return
    for i in range(4):
        wanted = min(max(command[i] * driven[i] / total, 0.0), 1.0)
        share[i] += approach * (wanted - share[i])


@inlined
def wheel_torques(
    car: Car,
    motor: Sequence[float],
    speed: Sequence[float],
    share: Sequence[float],
    wheel: MutableSequence[float],
) -> None:
    """Drive torque of each wheel [N m], into `wheel`.

    It follows from the torques behind the gears and the shares of the clutches. An open
    differential passes equal torques, a centre one those of its share. One that locks moves half
    its locking torque, preload + share |T|, from the faster to the slower side; its sign is
    smoothed over `locking_speed` [rad/s].
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
        # Positive where the front axle is faster: then it loses torque to the rear one.
        apart = 0.5 * (speed[0] + speed[1]) - 0.5 * (speed[2] + speed[3])
        locking = car.centre_preload + car.centre_locking * abs(total)
        front = driveline.front_share * total - 0.5 * locking * tanh(
            apart / driveline.locking_speed
        )
        wheel[0] = wheel[1] = 0.5 * front
        wheel[2] = wheel[3] = 0.5 * (total - front)
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        if car.differential[axle] == 1.0 and car.axle_preload[axle] + car.axle_locking[axle] > 0.0:
            locking = car.axle_preload[axle] + car.axle_locking[axle] * abs(
                wheel[left] + wheel[right]
            )
            moved = 0.5 * locking * tanh((speed[left] - speed[right]) / driveline.locking_speed)
            wheel[left] -= moved
            wheel[right] += moved


@compilable
def converter_torques(size: float, pump: float, turbine: float) -> tuple[float, float]:
    """Torques that the pump takes and the turbine gives [N m], at their speeds [rad/s].

    Kotwicki, "Dynamic models for torque converter equipped vehicles", SAE 820393 (1982): two
    quadratic forms in both speeds up to the coupling point, one beyond it; `size` [1] scales them.
    A turbine that turns faster than the pump drives it as a coupling does, at most as at the
    coupling point (assumption: the source ends at equal speeds). One that turns backwards counts as
    at rest (assumption).
    """
    # The fits hold for a turbine that turns forwards, up to their coupling point.
    slow = max(turbine, 0.0)
    if slow < COUPLING_POINT * pump:
        taken = 3.4325e-3 * pump * pump + 2.2210e-3 * pump * slow - 4.6041e-3 * slow * slow
        given = 5.7656e-3 * pump * pump + 0.3107e-3 * pump * slow - 5.4323e-3 * slow * slow
        return size * taken, size * given
    if slow <= pump:
        passed = size * _coupled(pump, slow)
        return passed, passed
    passed = -size * _coupled(slow, max(pump, COUPLING_POINT * slow))
    return passed, passed


@compilable
def _coupled(fast: float, slow: float) -> float:
    """Torque from the faster to the slower side beyond the coupling point [N m], at size 1."""
    return max(-6.7644e-3 * fast * fast + 32.0024e-3 * fast * slow - 25.2441e-3 * slow * slow, 0.0)


@dataclass(slots=True)
class EngineState:
    """Crankshaft, gear, and the work that they have done."""

    speed: float = entry(unit="rad/s", about="of crankshaft and pump")
    torque: float = entry(unit="N m", about="of the engine at its crankshaft")
    gear: float = entry(1.0, unit="1", about="that is in, from 1 on; -1 is the reverse gear")
    since_shift: float = entry(unit="s", about="time that it has been in")
    work: float = entry(unit="J", about="given by the engine at its crankshaft")
    taken: float = entry(unit="W", about="by the converter, mean over the last step")
    shaft: float = entry(
        unit="rad/s", about="speed of the gearbox' output when the last step began"
    )
    output: float = entry(unit="N m", about="of the gearbox' output over the last step")
    refused: float = entry(
        unit="", about="1 if more was asked against a gear than the drag, too fast for the selector"
    )


@compilable
def full_load_torque(e: Engine, speed: float) -> float:
    """Largest torque of the engine [N m] at a speed [rad/s].

    M = P/w_P (1 + w/w_P - (w/w_P)^2) of a spark ignition engine, from the power P at w_P alone
    (Genta, Motor Vehicle Dynamics, 1997, section on the engine's characteristics); it fades where
    fuel is cut off.
    """
    over = speed / e.peak_power_speed
    torque = max(e.peak_power / e.peak_power_speed * (1.0 + over - over * over), 0.0)
    return torque * speed_fade(e.maximum_speed, speed)


@compilable
def gear_ratio(e: Engine, ratios: tuple[float, ...], gear: float) -> float:
    """Speed of the turbine over that of the gearbox' output [1], negative in reverse."""
    return -e.gearbox.reverse if gear < 0.0 else ratios[int(gear) - 1]


@compilable
def begin_engine(s: EngineState, e: Engine, ratios: tuple[float, ...], shaft: float) -> None:
    """Set an engine without torque to a gearbox with a turning output [rad/s].

    The highest gear above its downshift is in.
    """
    s.gear = -1.0 if shaft < 0.0 else 1.0
    while 0.0 < s.gear < len(ratios) and ratios[int(s.gear)] * shaft > e.gearbox.downshift_speed:
        s.gear += 1.0
    s.since_shift = e.gearbox.dwell
    # Without slip in the converter, unless it would stall the engine.
    s.speed = max(gear_ratio(e, ratios, s.gear) * shaft, e.idle_speed)
    s.shaft = shaft


class GearboxLoad(NamedTuple):
    """The output of the gearbox: the torque asked of it, its speed, and what resists it."""

    wanted: float  # [N m]
    shaft: float  # [rad/s]
    yielding: float  # the most that its acceleration gains per torque [1/(kg m^2)]


@compilable
def advance_engine(
    s: EngineState, e: Engine, ratios: tuple[float, ...], load: GearboxLoad, h: float
) -> float:
    """Advance the engine by h [s]; the torque of the gearbox' output [N m] over that time.

    The pedal asks for a torque as in a car with an engine control by torques: the engine goes, with
    its lag, for what gives the wanted torque through gear and converter, between its drag and full
    load; below idle speed the idle control pulls it up.
    """
    wanted, shaft, yielding = load
    _shift(s, e, ratios, wanted, shaft, h)
    ratio = gear_ratio(e, ratios, s.gear)
    turbine = ratio * shaft
    taken, given = converter_torques(e.converter_size, s.speed, turbine)
    # Below the coupling point the stator multiplies the torque, so the engine has to give less.
    multiplied = given / taken if given > taken > 0.0 else 1.0
    asked = wanted / ratio
    # Losses in the gearbox: more to drive with, less to brake with.
    asked = asked / e.gearbox.efficiency if asked >= 0.0 else asked * e.gearbox.efficiency
    most, least = full_load_torque(e, s.speed), -(e.drag_torque + e.drag_growth * s.speed)
    target = max(
        asked / multiplied,
        least,
        e.idle_gain * (e.idle_speed - s.speed) if s.speed < e.idle_speed else least,
    )
    if asked < least and turbine > abs(ratio) * e.gearbox.selector_speed:
        s.refused = 1.0
    # Implicit Euler: stable for any lag, also one of zero.
    s.torque += h / (e.torque_lag + h) * (min(target, most) - s.torque)
    gain = ratio * (e.gearbox.efficiency if given * turbine >= 0.0 else 1.0 / e.gearbox.efficiency)
    # Geared low, or large, a converter is stiffer than any step suits: its torques are then those
    # at the speeds that they lead to, by one linearly implicit step. The steepest slope for all of
    # them, so that no kink is overshot, leaves it of first order and right in steady state. The
    # load of the shaft is that of the last step. A converter that the step suits changes by as good
    # as nothing.
    slope = e.converter_size * STEEPEST * max(s.speed, ratio * shaft) * h
    turning = (shaft - s.shaft) / h + yielding * (given * gain - s.output)
    parting = (s.torque - taken) / e.inertia - ratio * turning
    stiffness = slope * (1.0 / e.inertia + ratio * gain * yielding)
    squared = stiffness * stiffness
    # Faded in with the square of the stiffness, see above: a soft converter stays explicit.
    moved = slope * parting / (1.0 + stiffness) * (squared / (1.0 + squared))
    taken, given = taken + moved, given + moved
    before = s.speed
    s.speed = max(before + h * (s.torque - taken) / e.inertia, 0.0)
    mean = 0.5 * (before + s.speed)
    s.work += s.torque * mean * h
    s.taken = taken * mean
    passed = (
        given * e.gearbox.efficiency if given * turbine >= 0.0 else given / e.gearbox.efficiency
    )
    s.shaft, s.output = shaft, passed * ratio
    return s.output


@compilable
def _shift(
    s: EngineState, e: Engine, ratios: tuple[float, ...], wanted: float, shaft: float, h: float
) -> None:
    """Change gear by the speed of the turbine, and the direction near rest by what is wanted."""
    s.since_shift += h
    # Half a step, because a sum of steps is now above, now below the time that it stands for.
    if s.since_shift < e.gearbox.dwell - 0.5 * h:
        return
    gear = s.gear
    turbine = gear_ratio(e, ratios, s.gear) * shaft
    slow = e.gearbox.selector_speed
    if gear < 0.0:
        if wanted > 0.0 and shaft > -slow:
            s.gear = 1.0
    elif wanted < 0.0 and shaft < slow:
        s.gear = -1.0
    elif turbine > e.gearbox.upshift_speed and gear < len(ratios):
        s.gear += 1.0
    elif turbine < e.gearbox.downshift_speed and gear > 1.0:
        s.gear -= 1.0
    if s.gear != gear:
        s.since_shift = 0.0
