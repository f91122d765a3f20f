"""Traction control as a method: what it does with one wheel is the law, the rest is shared.

How it works: in each step `know` goes on with the speed of the car and what each wheel would roll
at. `limit_wheels` then decides for each driven wheel whether it is limited at all, and asks the law
for its largest torque or speed. What the limits make of the request is `limited` for drives in
torque mode, and `set_points` for drives in speed mode. `traction_control` makes a method of all
that and the law.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple, TypeVar, get_type_hints

from ev_control.estimation import reference_speed
from ev_control.estimation.plausible import Sensors, is_plausible
from ev_control.estimation.wheel_dynamics import WheelMotion, start_again
from ev_control.shared.limp_mode import Limited, LostMotors, limp_mode_for, without_yaw
from ev_core.law import (
    NO_WHEELS,
    Car,
    Need,
    Wheels,
    WheelSpeedCommand,
    compilable,
    copysign,
    method,
)
from ev_core.methods.law import named_after
from ev_core.parameters.record import each_wheel, entry, part, per_wheel
from ev_msgs_py.compilable import FUNCTIONS
from ev_msgs_py.contract import signals

L = TypeVar("L", bound=Callable[..., float])

# Slower than this a car is about to pull away, perhaps on a hill: its drives, commanded ahead, do
# not brake it as it rolls back, and a brake that is still pressed is about to be released.
PULLING_AWAY = 0.3  # [m/s]
# Tread of a wheel that its brake still holds; far above the noise of wheel speeds [m/s].
HELD_SPEED = 0.1


@dataclass(slots=True)
class LimitedWheel:
    """State of a wheel in every traction control; each law adds what it needs besides."""

    limit: float = entry(inf, unit="N m", about="largest torque that it gets")


@dataclass(slots=True)
class TractionControlState:
    """State of the car in every traction control."""

    reference: reference_speed.ReferenceSpeedState = part(reference_speed.ReferenceSpeedState)
    velocity: list[float] = per_wheel(unit="rad/s", about="last wheel speeds")
    measured: bool = entry(False, unit="1", about="whether there are last wheel speeds")
    direction: list[float] = per_wheel(
        unit="1", about="sign of the request that is watched; 0 where it just passes"
    )
    motors: LostMotors = part(LostMotors)


class Measured(NamedTuple):
    """Request and measurements, as every traction control reads them."""

    request: signals.WheelTorqueRequest
    sensors: Sensors


class Known(NamedTuple):
    """Everything about a step that is the same for all wheels."""

    period: float  # [s]
    measured: Measured
    rolling: Wheels  # speeds at which the wheels would roll [rad/s]
    is_braked: bool


@compilable
def know(
    p: reference_speed.ReferenceSpeedParameters,
    car: Car,
    s: TractionControlState,
    period: float,
    measured: Measured,
) -> Known:
    """Go on with the speed of the car by what was measured."""
    request, drive = measured.request, measured.request.drive
    is_braked = request.brake != NO_WHEELS
    asked = sign((drive[0] + drive[1]) + (drive[2] + drive[3]))
    direction = -sign(s.reference.speed) if is_braked else asked
    rolling = reference_speed.rolling_speeds(
        p, car, s.reference, period, measured.sensors, direction
    )
    return Known(period, measured, rolling, is_braked)


@compilable
def limit_wheels(
    limit_of: Callable[..., float],
    forget: Callable[..., None],
    p: Any,
    car: Car,
    s: Any,
    now: Known,
) -> None:
    """Set the limits of the wheels for this step.

    A wheel has no limit, and the law forgets it, where nothing is asked for, where any wheel of a
    car that moves is braked, and where a torque works against the travel of the car (regeneration).
    About rest, under a brake, a wheel that its brake holds keeps its limit, and one that turns is
    limited: it spins as the brake is released. Everything is counted in the direction of the
    request, so reverse mirrors forward.

    The state has `control`, a TractionControlState, and `wheels`, each of which has what a
    LimitedWheel has. `limit_of(p, car, wheel, period, motion, wanted)` goes on with the state of a
    wheel of which `wanted` [N m], above zero, is asked, and gives its largest torque [N m], or
    infinity. `forget(p, wheel)` puts it back to the start.
    """
    known, speed = s.control, s.control.reference.speed
    request, velocity = now.measured.request, now.measured.sensors.wheels.velocity
    for i in range(4):
        if not car.driven[i]:
            continue
        ahead = sign(request.drive[i])
        # A brake works against the travel, whichever way the drive pushes.
        against = -abs(speed) if now.is_braked else ahead * speed
        if against < -PULLING_AWAY:
            ahead = 0.0
        wheel = s.wheels[i]
        # Another direction is another regulation: what was learnt of the slip has the wrong sign.
        if ahead != known.direction[i]:
            known.direction[i] = ahead
            forget(p, wheel)
        # A wheel that its brake holds cannot slip, and its limit is still needed as it is released.
        is_held = now.is_braked and ahead * velocity[i] * car.wheel_radius < HELD_SPEED
        if ahead != 0.0 and not is_held:
            motion = motion_of(known, now, i, ahead)
            wanted = abs(request.drive[i])
            wheel.limit = max(limit_of(p, car, wheel, now.period, motion, wanted), 0.0)


@compilable
def motion_of(s: TractionControlState, now: Known, i: int, ahead: float) -> WheelMotion:
    """Measured motion of wheel i, in the direction of its request."""
    sensors, request = now.measured.sensors, now.measured.request
    velocity, imu = sensors.wheels.velocity[i], sensors.imu
    # Without a last speed there is no acceleration yet.
    before = s.velocity[i] if s.measured else velocity
    return WheelMotion(
        ahead * velocity,
        ahead * now.rolling[i],
        ahead * (velocity - before) / now.period,
        ahead * sensors.wheels.effort[i] - request.brake[i],
        ahead * imu.longitudinal_acceleration,
        imu.longitudinal_acceleration,
        imu.lateral_acceleration,
        i,
        ahead,
        s.reference.speed,
        imu.yaw_rate,
        sensors.column.road_wheel_angle,
    )


@compilable
def limited(
    home: Any, car: Car, s: Any, period: float, measured: Measured
) -> signals.WheelTorqueCommand:
    """Requested torques [N m] within the limits of the wheels, none of the other sign.

    With `limp.watch` of the parameters the partner of a lost motor mirrors it, within its own
    limit.
    """
    limp = home.limp
    request = measured.request
    drive = measured.request.drive
    torques = Wheels(
        within(drive[0], s.wheels[0].limit),
        within(drive[1], s.wheels[1].limit),
        within(drive[2], s.wheels[2].limit),
        within(drive[3], s.wheels[3].limit),
    )
    if limp.watch:
        asked = Limited(request, torques, measured.sensors.wheels)
        return without_yaw(limp.plausibility, car, s.control.motors, period, asked)
    return signals.WheelTorqueCommand(torques, request.brake)


@compilable
def set_points(
    _home: Any, car: Car, s: Any, _period: float, measured: Measured
) -> tuple[signals.WheelTorqueCommand, WheelSpeedCommand]:
    """Requested torques [N m] as they are, and set-points [rad/s] in their direction.

    The set-point of a slipping wheel is its limit. For all others it is the largest speed of the
    motor, out of reach, which leaves the torque to the request.
    """
    drive, fastest = measured.request.drive, car.motor.maximum_speed
    speeds = Wheels(
        copysign(min(s.wheels[0].limit, fastest / car.gear[0]), drive[0]),
        copysign(min(s.wheels[1].limit, fastest / car.gear[1]), drive[1]),
        copysign(min(s.wheels[2].limit, fastest / car.gear[2]), drive[2]),
        copysign(min(s.wheels[3].limit, fastest / car.gear[3]), drive[3]),
    )
    command = signals.WheelTorqueCommand(drive, measured.request.brake)
    return command, WheelSpeedCommand(speeds)


@compilable
def limit_unknown_wheels(forget: Callable[..., None], p: Any, car: Car, s: Any) -> None:
    """Limit a driven wheel of unknown speed to the least limit of the others.

    Where all sensors are lost, torques pass.
    """
    lost, least = s.control.reference.trust.lost, inf
    for i in range(4):
        if car.driven[i] and not lost[i] and s.control.direction[i] != 0.0:
            least = min(least, s.wheels[i].limit)
    for i in range(4):
        if car.driven[i] and lost[i]:
            forget(p, s.wheels[i])
            s.wheels[i].limit = least


@compilable
def within(torque: float, limit: float) -> float:
    """A torque, not larger than its limit in either direction [N m]."""
    return copysign(limit, torque) if abs(torque) > limit else torque


@compilable
def sign(number: float) -> float:
    """-1, 0 or 1."""
    if number > 0.0:
        return 1.0
    return -1.0 if number < 0.0 else 0.0


@compilable
def itself(p: Any) -> Any:
    """Home of the parameters of reference speed and limp mode in a law that has them itself."""
    return p


@compilable
def its_regulator(p: Any) -> Any:
    """Home of these parameters in a law that regulates a slip."""
    return p.regulator


def traction_control(
    name: str,
    forget: Callable[..., None] | None = None,
    reference: str = "reference",
    speed_mode: bool = False,
    needs: tuple[Need, ...] = (),
) -> Callable[[L], L]:
    """Register the law of one wheel as a method of the asr, under its docstring.

    The law is `(p, car, w, period, motion, wanted)` and gives the largest torque of the wheel [N
    m], as in `limit_wheels`. The annotation of `p` names its parameters, that of `w` the record of
    a wheel, a LimitedWheel with more; it is put back to its start by `forget(p, w)`, without one by
    its declaration. `reference` names the parameters of the reference speed among its own, and
    `limp` beside them are those of the limp mode. The method runs compiled if law and `forget` are
    compilable.

    With `speed_mode` the law gives the largest speed of the wheel [rad/s] for drives in speed mode
    (`set_points`), and has no limp mode. `needs` are what it asks of the vehicle besides.
    """
    home_of = its_regulator if reference == "regulator.reference" else itself
    how: dict[str, Any] = {"writes": (signals.WheelTorqueCommand,)}
    lacks: tuple[Need, ...] = (*needs, reference_speed.free_wheels_for(reference))
    answer: Callable[..., Any] = limited
    if speed_mode:
        answer = set_points
        how = {
            "writes": (signals.WheelTorqueCommand, WheelSpeedCommand),
            "requires": {"plant.speed_mode": True},
        }
    else:
        lacks = (*lacks, limp_mode_for(f"{reference.rpartition('.')[0]}.limp".lstrip(".")))

    def register(limit_of: L) -> L:
        wheel = get_type_hints(limit_of)["w"]
        begin = forget or _beginning(wheel)

        # Its wheels have the record of this law, so each law has a state class of its own.
        @dataclass(slots=True)
        class State:
            """State of the car and of its wheels."""

            control: TractionControlState = part(TractionControlState)
            wheels: list[Any] = each_wheel(wheel)

        def start(p: Any) -> State:
            state = State()
            for each in state.wheels:
                begin(p, each)
            return state

        def law(p: Any, car: Car, s: Any, period: float, measured: Measured) -> Any:
            home = home_of(p)
            if is_plausible(measured.sensors):
                now = know(home.reference, car, s.control, period, measured)
                limit_wheels(limit_of, begin, p, car, s, now)
                if home.reference.trust.watch:
                    limit_unknown_wheels(begin, p, car, s)
                s.control.velocity[:] = measured.sensors.wheels.velocity
                s.control.measured = True
            else:  # a measurement that is not finite, or absurd: the last limits stay
                s.control.measured = False
            return answer(home, car, s, period, measured)

        # Users know the method by name and docstring of the law of a wheel.
        named_after(law, limit_of)
        # A part that only plain Python can run keeps the whole method there.
        if limit_of in FUNCTIONS and begin in FUNCTIONS:
            compilable(law)
        parameters = get_type_hints(limit_of)["p"]
        method(
            "asr",
            name,
            parameters=parameters,
            state=State,
            start=start,
            needs=lacks,
            mirrored=True,
            **how,
        )(law)
        return limit_of

    return register


def _beginning(wheel: type) -> Callable[..., None]:
    again = start_again(wheel)

    @compilable
    def forget(p: Any, w: Any) -> None:
        again(w)

    return forget
