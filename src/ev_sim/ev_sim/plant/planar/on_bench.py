"""The planar plant with its driven machines on a test bench: what is measured there drives the virtual car.

Dissertation, section 4.1: the measured torque drives the driveline of the virtual car, which sets the load machines; or
these get a constant torque or speed (section 4.2).
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, Vehicle, compilable, entry, group, inlined, method, parameter, per_wheel, working_memory
from ev_core.vehicle.driveline import has_equal_motors, has_own_motors
from ev_msgs_py.can.frames import SPEED_MODE, TORQUE_MODE
from ev_msgs_py.contract.optional_signals import BenchElectrical, BenchShafts, LoadCommand
from ev_msgs_py.contract.signals import MotorStates, SteeringColumnState, WheelTorqueCommand
from ev_sim.drives.electrical_side import current_at_power
from ev_sim.plant.guard import accepted
from ev_sim.plant.planar.given import PlanarParameters
from ev_sim.plant.planar.planar import PLANAR, advance
from ev_sim.plant.planar.planar_state import STEP_MEMORY, VX, WHEEL_SPEED, PlanarState, Step
from ev_sim.plant.planar.powertrain import behind_gear, source_voltage
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.shown import PLANAR_SIGNALS, Seen, begin, seen, wheels_from

WHEEL_SPEEDS = ("virtual", "load_machine")
VIRTUAL, LOAD_MACHINE = range(len(WHEEL_SPEEDS))
LOADS = ("road", "torque", "speed")
ROAD, CONSTANT_TORQUE, CONSTANT_SPEED = range(len(LOADS))


@dataclass(frozen=True, slots=True)
class LoadParameters:
    """What the load machines follow; those of both circuits work together or each for itself (section 4.2)."""

    follows: str = parameter(
        "road",
        choices=LOADS,
        about="road: what wheel, road and brake ask for; torque, speed: a constant, whatever these ask for",
        source="dissertation, sections 4.1 and 4.2",
    )
    torque_left: float = parameter(
        0.0, unit="N m", low=-1000.0, high=1000.0, about="constant, at the shaft, positive against forwards"
    )
    torque_right: float = parameter(0.0, unit="N m", low=-1000.0, high=1000.0, about="the same of the right circuits")
    speed_left: float = parameter(
        0.0, unit="rad/s", low=-1047.2, high=1047.2, about="constant, of the shaft, forwards positive"
    )
    speed_right: float = parameter(0.0, unit="rad/s", low=-1047.2, high=1047.2, about="the same of the right circuits")


@dataclass(frozen=True, slots=True)
class PlanarOnBenchParameters(PlanarParameters):
    """The planar plant, and how it takes what the bench measures."""

    rotor_share: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the rotor's torque J w' that is added to the measured one: the virtual car's wheel has the "
        "rotor's inertia, but the torque behind the rotor, where the transducer sits, has moved the rotor already",
        source="assumption: the source drives the wheel with the measured torque and does not speak of the rotor",
    )
    wheel_speed: str = parameter(
        "load_machine",
        choices=WHEEL_SPEEDS,
        about="with which speed a driven wheel meets the road: load_machine: the one measured at its load machine; "
        "virtual: the one that the load machine is set to hold, the default behind a real bus",
        source="dissertation, section 4.1: the speed of the load machine is that of the virtual driven wheel",
    )
    load: LoadParameters = group(LoadParameters)


_BEYOND = 2.0  # times its largest torque is what a machine is believed to give: the transducer may err
_MOST_POWER = 1e7  # W, believed of the electrical measurement
_MOST_SPEED = 1e3  # rad/s, believed of a wheel
_MOST_APART = 100.0  # rad/s that a wheel is believed to be away from the set-point of its load machine


@dataclass(slots=True)
class PlanarOnBenchState(PlanarState):
    """The same, and what the bench has measured last."""

    measured_torque: list[float] = per_wheel(unit="N m", about="of the machine with its rotor, at the shaft")
    measured_speed: list[float] = per_wheel(unit="rad/s", about="of the shaft")
    set_speed: list[float] = per_wheel(unit="rad/s", about="of the wheel, the last set-point of the load machine")
    apart: list[float] = per_wheel(unit="rad/s", about="of the wheel: load machine less its set-point")
    measured_power: float = entry(unit="W", about="that the machines took from the battery")


def at_start(p: PlanarOnBenchParameters, car: Car, c: PlanarConstants) -> PlanarOnBenchState:
    """As the planar plant begins; the shafts rest."""
    s: PlanarOnBenchState = begin(p, car, c, PlanarOnBenchState)
    for i in range(4):
        s.set_speed[i] = s.motion[WHEEL_SPEED + i]
    return s


def individual_machines(_parameters: PlanarOnBenchParameters, vehicle: Vehicle) -> str:
    """A circuit of the bench is one machine behind one wheel, and its torque is what the laws ask for."""
    if not has_own_motors(vehicle):
        return "driveline.coupling individual"
    if not has_equal_motors(vehicle):
        return "equal motors and gears at all driven wheels, and no engine"
    return "blend_brakes false" if vehicle.blend_brakes else ""


@compilable
def outputs(
    p: PlanarOnBenchParameters, car: Car, c: PlanarConstants, s: PlanarOnBenchState
) -> tuple[*Seen, LoadCommand]:
    """All signals at the instant of the state; torque and speed of the motors are those that were measured."""
    steps = working_memory(STEP_MEMORY)
    plain = seen(p, car, c, s, steps)
    motors = MotorStates(wheels_from(s.measured_speed, 0), wheels_from(s.measured_torque, 0))
    return plain[0], motors, plain[2], plain[3], plain[4], plain[5], plain[6], _load(p.load, car, c, s, steps[0])


@compilable
def _load(p: LoadParameters, car: Car, c: PlanarConstants, s: PlanarOnBenchState, step: Step) -> LoadCommand:
    """What wheel, road and brake ask of the load machines: n = i w, M = (F_x r + M_f + M_brake)/i (section 4.1).

    Or a constant torque, beside the speed at which the shaft turns, or a constant speed, beside the torque of the road.
    """
    y, gear = s.motion, car.gear_ratio
    rolling = car.constant_rolling_resistance + car.rolling_resistance_growth * y[VX] * y[VX]
    mode, speed, torque = step.asked, step.shaft, step.target
    for i in range(4):
        radius = c.body.wheel_radius[i]
        dry = s.guard.brake[i] + radius * step.load[i] * (rolling + step.tyre[i].rolling_resistance)
        mode[i] = car.driven[i] * SPEED_MODE
        speed[i] = car.driven[i] * gear * (y[WHEEL_SPEED + i] - s.apart[i])
        torque[i] = car.driven[i] * (radius * step.force_x[i] + step.motion[i] * dry) / gear
        if p.follows == CONSTANT_TORQUE:
            mode[i], speed[i] = car.driven[i] * TORQUE_MODE, s.measured_speed[i]
            torque[i] = car.driven[i] * (p.torque_left if i % 2 == 0 else p.torque_right)
        elif p.follows == CONSTANT_SPEED:
            speed[i] = car.driven[i] * (p.speed_left if i % 2 == 0 else p.speed_right)
    return LoadCommand(wheels_from(mode, 0), wheels_from(speed, 0), wheels_from(torque, 0))


@method(
    "plant",
    "planar_on_bench",
    needs=(individual_machines,),
    **PLANAR
    | {"state": PlanarOnBenchState, "start": at_start, "outputs": outputs, "writes": (*PLANAR_SIGNALS, LoadCommand)},
)
@inlined
def planar_on_bench(
    p: PlanarOnBenchParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarOnBenchState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    shafts: BenchShafts,
    electrical: BenchElectrical,
) -> None:
    """The planar plant, driven by the torque that a test bench measures, without a drive model of its own.

    Of the command it takes the brakes. Measured torque and power are those of the period before: that is what the
    exchange costs.
    """
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        gained = (shafts.speed[i] - s.measured_speed[i]) / period
        torque = shafts.torque[i] + p.rotor_share * car.motor.rotor_inertia * gained
        most = _BEYOND * c.limits.drive[i] / car.gear_ratio
        s.measured_torque[i] = accepted(s.guard, torque, 0.0, -most, most)
        s.measured_speed[i] = shafts.speed[i]
        if p.wheel_speed == LOAD_MACHINE:
            # The wheel meets the road as its load machine turned when the last period ended. The set-point of the load
            # machine goes on from its last one, the speed J w' = i M - F_x r - M_f - M_brake of the virtual wheel. The
            # difference between both, held over a period, is what the load machine does not follow. One that follows
            # a constant ignores the wheel, which begins each period with the measured speed.
            speed, set_point = shafts.load_speed[i] / car.gear_ratio, s.motion[WHEEL_SPEED + i] - s.apart[i]
            if p.load.follows != ROAD:
                set_point = s.set_speed[i] = accepted(s.guard, speed, set_point, -_MOST_SPEED, _MOST_SPEED)
            behind = speed - s.set_speed[i]
            s.apart[i], s.set_speed[i] = accepted(s.guard, behind, 0.0, -_MOST_APART, _MOST_APART), set_point
            s.motion[WHEEL_SPEED + i] = set_point + s.apart[i]
    driven, voltage, current = car.driven, electrical.voltage, electrical.current
    front = driven[0] * voltage[0] * current[0] + driven[1] * voltage[1] * current[1]
    power = front + (driven[2] * voltage[2] * current[2] + driven[3] * voltage[3] * current[3])
    s.measured_power = accepted(s.guard, power, 0.0, -_MOST_POWER, _MOST_POWER)
    advance(p, car, c, s, period, command, column, _apply, _book, working_memory(STEP_MEMORY))


@inlined
def _apply(p: PlanarOnBenchParameters, car: Car, c: PlanarConstants, s: PlanarOnBenchState, step: Step) -> None:
    """Set drive and brake torques of the wheels [N m]: those of the bench behind the gear, and of the brakes."""
    for i in range(4):
        step.motor[i] = s.motor_torque[i] = s.measured_torque[i]
        step.drive[i] = behind_gear(car, step.motor[i] * car.gear_ratio, s.motion[WHEEL_SPEED + i])
        step.brake[i] = step.brake_command[i]


@inlined
def _book(p: PlanarOnBenchParameters, car: Car, c: PlanarConstants, s: PlanarOnBenchState, step: Step) -> None:
    """Book the energies of this step, and discharge the battery by the measured power."""
    mechanical, drive, power, h = 0.0, 0.0, c.power, c.h
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_speed, right_speed = step.turned[left] / h, step.turned[right] / h
        mechanical += (step.motor[left] * left_speed + step.motor[right] * right_speed) * car.gear_ratio
        drive += step.drive[left] * left_speed + step.drive[right] * right_speed
    given = s.measured_power + car.battery.auxiliary_power
    current = current_at_power(source_voltage(s, power), power.resistance, given)
    s.state_of_charge -= current * h / power.capacity
    s.battery_power = given
    s.battery_work += given * h
    s.motor_loss += (s.measured_power - mechanical) * h
    s.driveline_loss += (mechanical - drive) * h
    s.auxiliary_work += car.battery.auxiliary_power * h
    s.drive_work += drive * h
