"""A traction control as a method: what it does with one wheel is the law, the rest is the same for all of them.

Here stands which wheels are limited, when torques pass, what is measured, and what the limits make of the request.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple, TypeVar, get_type_hints

from ev_control.estimation import reference_speed
from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.wheel_dynamics import WheelMotion, start_again
from ev_control.shared.limp_mode import LostMotors, limp_mode_for, without_yaw
from ev_core.law import NO_WHEELS, Car, Need, Wheels, WheelSpeedCommand, compilable, copysign, method
from ev_core.methods.law import named_after
from ev_core.parameters.record import each_wheel, entry, part, per_wheel
from ev_msgs_py.compilable import FUNCTIONS
from ev_msgs_py.contract import signals

L = TypeVar("L", bound=Callable[..., float])

# Slower than this a car is about to pull away, perhaps on a hill: its drives, commanded ahead, do not brake it as it
# rolls back, and a brake that is still pressed is about to be released.
PULLING_AWAY = 0.3  # [m/s]
HELD_SPEED = 0.1  # tread of a wheel that its brake still holds; far above the noise of wheel speeds [m/s]


@dataclass(slots=True)
class LimitedWheel:
    """What every traction control knows of a wheel; each law adds what it knows besides."""

    limit: float = entry(inf, unit="N m", about="largest torque that it gets")


@dataclass(slots=True)
class TractionControlState:
    """What every traction control knows of the car."""

    reference: reference_speed.ReferenceSpeedState = part(reference_speed.ReferenceSpeedState)
    velocity: list[float] = per_wheel(unit="rad/s", about="last wheel speeds")
    measured: float = entry(unit="1", about="whether there are last wheel speeds")
    direction: list[float] = per_wheel(unit="1", about="sign of the request that is watched; 0 where it just passes")
    motors: LostMotors = part(LostMotors)


class Measured(NamedTuple):
    """What a traction control is asked for, and what it measures."""

    request: signals.WheelTorqueRequest
    column: signals.SteeringColumnState
    wheels: signals.WheelStates
    imu: signals.InertialMeasurement


@compilable
def watch(
    limit_of: Callable[..., float],
    forget: Callable[..., None],
    reference: reference_speed.ReferenceSpeedParameters,
    p: Any,
    car: Car,
    s: Any,
    period: float,
    measured: Measured,
) -> None:
    """Go on with the state by what was measured; the limits of the wheels are then those of this step.

    A wheel has no limit, and the law forgets it, where nothing is asked for, where any wheel of a car that moves is
    braked, and where a torque works against the travel of the car (regeneration). About rest, under a brake, a wheel
    that its brake holds keeps its limit, and one that turns is limited: it spins as the brake is released. Everything
    is counted in the direction of the request, so reverse mirrors forward. A measurement that is not finite or absurd
    changes nothing: the last limits stay. A driven wheel whose speed sensor is lost (`reference.trust`) gets at most
    the least limit of the others; where all are lost, torques pass.

    The state has `control`, a TractionControlState, and `wheels`, each of which has what a LimitedWheel has.
    `limit_of(p, car, wheel, period, motion, wanted)` goes on with the state of a wheel of which `wanted` [N m], above
    zero, is asked, and gives its largest torque [N m], or infinity. `forget(p, wheel)` puts it back to the start.
    """
    request, column, wheels, imu = measured
    known, drive, velocity, effort = s.control, request.drive, wheels.velocity, wheels.effort
    if not is_plausible(column, wheels, imu):
        known.measured = 0.0
        return
    is_braked = request.brake != NO_WHEELS
    asked = sign((drive[0] + drive[1]) + (drive[2] + drive[3]))
    direction = -sign(known.reference.speed) if is_braked else asked
    rolling = reference_speed.rolling_speeds(
        reference, car, known.reference, period, velocity, column.road_wheel_angle, imu, direction
    )
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        ahead = sign(drive[i])
        against = -abs(known.reference.speed) if is_braked else ahead * known.reference.speed
        if against < -PULLING_AWAY:
            ahead = 0.0
        wheel = s.wheels[i]
        if ahead != known.direction[i]:
            known.direction[i] = ahead
            forget(p, wheel)
        is_held = is_braked and ahead * velocity[i] * car.wheel_radius < HELD_SPEED
        if ahead != 0.0 and not is_held:
            before = known.velocity[i] if known.measured == 1.0 else velocity[i]
            motion = WheelMotion(
                ahead * velocity[i],
                ahead * rolling[i],
                ahead * (velocity[i] - before) / period,
                ahead * effort[i] - request.brake[i],
                ahead * imu.longitudinal_acceleration,
                imu.longitudinal_acceleration,
                imu.lateral_acceleration,
                i,
                ahead,
                known.reference.speed,
                imu.yaw_rate,
                column.road_wheel_angle,
            )
            wheel.limit = max(limit_of(p, car, wheel, period, motion, abs(drive[i])), 0.0)
    if reference.trust.watch == 1.0:
        limit_unknown_wheels(forget, p, car, s)
    known.velocity[:] = velocity
    known.measured = 1.0


@compilable
def limited(home: Any, car: Car, s: Any, period: float, measured: Measured) -> signals.WheelTorqueCommand:
    """The requested torques [N m], those of wheels with a limit not above it: never more, and never of the other sign.

    With `limp.watch` of the parameters the partner of a lost motor mirrors it, within its own limit.
    """
    limp, request, drive = home.limp, measured.request, measured.request.drive
    torques = Wheels(
        within(drive[0], s.wheels[0].limit),
        within(drive[1], s.wheels[1].limit),
        within(drive[2], s.wheels[2].limit),
        within(drive[3], s.wheels[3].limit),
    )
    if limp.watch == 1.0:
        return without_yaw(limp.plausibility, car, s.control.motors, period, request, torques, measured.wheels)
    return signals.WheelTorqueCommand(torques, request.brake)


@compilable
def set_points(
    _home: Any, car: Car, s: Any, _period: float, measured: Measured
) -> tuple[signals.WheelTorqueCommand, WheelSpeedCommand]:
    """The requested torques [N m] as they are, and set-points [rad/s] in their direction: for slipping wheels a limit.

    For all others it is the largest speed of the motor, out of reach, which leaves the torque to the request. The state
    is as in `watch`.
    """
    drive, fastest = measured.request.drive, car.motor.maximum_speed
    speeds = Wheels(
        copysign(min(s.wheels[0].limit, fastest / car.gear[0]), drive[0]),
        copysign(min(s.wheels[1].limit, fastest / car.gear[1]), drive[1]),
        copysign(min(s.wheels[2].limit, fastest / car.gear[2]), drive[2]),
        copysign(min(s.wheels[3].limit, fastest / car.gear[3]), drive[3]),
    )
    return signals.WheelTorqueCommand(drive, measured.request.brake), WheelSpeedCommand(speeds)


@compilable
def limit_unknown_wheels(forget: Callable[..., None], p: Any, car: Car, s: Any) -> None:
    """A driven wheel whose speed nobody knows gets at most what the most slippery of the others gets."""
    lost, least = s.control.reference.trust.lost, inf
    for i in range(4):
        if car.driven[i] == 1.0 and lost[i] == 0.0 and s.control.direction[i] != 0.0:
            least = min(least, s.wheels[i].limit)
    for i in range(4):
        if car.driven[i] == 1.0 and lost[i] == 1.0:
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
    """Where the parameters of reference speed and limp mode are, of a law that has them itself."""
    return p


@compilable
def its_regulator(p: Any) -> Any:
    """Where those of a law are that regulates a slip."""
    return p.regulator


HOMES = {"reference": itself, "regulator.reference": its_regulator}


def traction_control(
    name: str,
    forget: Callable[..., None] | None = None,
    reference: str = "reference",
    speed_mode: bool = False,
    needs: tuple[Need, ...] = (),
) -> Callable[[L], L]:
    """Register the law of one wheel as a method of the asr, under its docstring.

    The law is `(p, car, w, period, motion, wanted)` and gives the largest torque of the wheel
    [N m], as `watch` says. The annotation of `p` names its parameters, that of `w` the record of a
    wheel, a LimitedWheel with more; it is put back to its start by `forget(p, w)`, without one by
    its declaration. `reference` names the parameters of the reference speed among its own, and
    `limp` beside them are those of the limp mode. The method runs compiled if law and `forget` are
    compilable.

    With `speed_mode` the law gives the largest speed of the wheel [rad/s] for drives in speed mode, as
    `set_points` says, and has no limp mode. `needs` are what it asks of the vehicle besides.
    """
    home_of = HOMES[reference]
    how: dict[str, Any] = {"writes": (signals.WheelTorqueCommand,)}
    lacks: tuple[Need, ...] = (*needs, reference_speed.free_wheels_for(reference))
    answer: Callable[..., Any] = limited
    if speed_mode:
        answer = set_points
        how = {"writes": (signals.WheelTorqueCommand, WheelSpeedCommand), "requires": {"plant": "planar_speed_mode"}}
    else:
        lacks = (*lacks, limp_mode_for(f"{reference.rpartition('.')[0]}.limp".lstrip(".")))

    def register(limit_of: L) -> L:
        wheel = get_type_hints(limit_of)["w"]
        begin = forget or _beginning(wheel)

        @dataclass(slots=True)
        class State:
            """What lasts between steps."""

            control: TractionControlState = part(TractionControlState)
            wheels: list[Any] = each_wheel(wheel)

        def start(p: Any) -> State:
            state = State()
            for each in state.wheels:
                begin(p, each)
            return state

        def law(
            p: Any,
            car: Car,
            s: Any,
            period: float,
            request: signals.WheelTorqueRequest,
            column: signals.SteeringColumnState,
            wheels: signals.WheelStates,
            imu: signals.InertialMeasurement,
        ) -> Any:
            home, measured = home_of(p), Measured(request, column, wheels, imu)
            watch(limit_of, begin, home.reference, p, car, s, period, measured)
            return answer(home, car, s, period, measured)

        named_after(law, limit_of)
        if limit_of in FUNCTIONS and begin in FUNCTIONS:
            compilable(law)
        parameters = get_type_hints(limit_of)["p"]
        method("asr", name, parameters=parameters, state=State, start=start, needs=lacks, mirrored=True, **how)(law)
        return limit_of

    return register


def _beginning(wheel: type) -> Callable[..., None]:
    again = start_again(wheel)

    @compilable
    def forget(p: Any, w: Any) -> None:
        again(w)

    return forget
