"""The planar plant with its driven machines on a test bench.

Their measurements drive the virtual car. Dissertation, section 4.1: the measured torque drives the
driveline of the virtual car, which sets the load machines; or these get a constant torque or speed
(section 4.2).

How it works: the measured torque, with the share of the rotor added, takes the place of the motors'
torque, and the measured power that of the battery. The load machine of a driven wheel is set to the
speed of the virtual wheel. It follows late, so two speeds differ: the wheel meets the road as the
load machine turned when the last period ended, and the set-point goes on from the last set-point.
`apart` is their difference, held over a period.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import (
    Car,
    Vehicle,
    compilable,
    entry,
    group,
    inlined,
    method,
    parameter,
    per_wheel,
    working_memory,
)
from ev_core.vehicle.driveline import has_equal_motors, has_own_motors
from ev_msgs_py.can.frames import SPEED_MODE, TORQUE_MODE
from ev_msgs_py.contract.optional_signals import (
    BenchElectrical,
    BenchShafts,
    BodyRoll,
    LoadCommand,
)
from ev_msgs_py.contract.signals import MotorStates
from ev_sim.drives.driveline import behind_gear
from ev_sim.plant.guard import Commanded, accepted
from ev_sim.plant.planar.given import PlanarParameters
from ev_sim.plant.planar.model import Plant
from ev_sim.plant.planar.planar import PLANAR, ROLLING, advance
from ev_sim.plant.planar.planar_state import STEP_MEMORY, VX, WHEEL_SPEED, PlanarState, wheels_from
from ev_sim.plant.planar.powertrain import discharge
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.shown import PLANAR_SIGNALS, Seen, begin, roll_of, seen

WHEEL_SPEEDS = ("virtual", "load_machine")
VIRTUAL, LOAD_MACHINE = range(len(WHEEL_SPEEDS))
LOADS = ("road", "torque", "speed")
ROAD, CONSTANT_TORQUE, CONSTANT_SPEED = range(len(LOADS))

# What a measurement is believed to be at most. A machine: so many times its largest torque, since
# the transducer may err.
_BEYOND = 2.0
_MOST_POWER = 1e7  # W, of the electrical measurement
_MOST_SPEED = 1e3  # rad/s, of a wheel
_MOST_APART = 100.0  # rad/s, of a wheel from the set-point of its load machine


@dataclass(frozen=True, slots=True)
class LoadParameters:
    """Load of the load machines, of both circuits together or each for itself (section 4.2)."""

    follows: str = parameter(
        "road",
        choices=LOADS,
        about="road: what wheel, road and brake ask for; torque, speed: a constant, whatever "
        "these ask for",
        source="dissertation, sections 4.1 and 4.2",
    )
    torque_left: float = parameter(
        0.0,
        unit="N m",
        low=-1000.0,
        high=1000.0,
        about="constant, at the shaft, positive against forwards",
    )
    torque_right: float = parameter(
        0.0, unit="N m", low=-1000.0, high=1000.0, about="the same of the right circuits"
    )
    speed_left: float = parameter(
        0.0,
        unit="rad/s",
        low=-1047.2,
        high=1047.2,
        about="constant, of the shaft, forwards positive",
    )
    speed_right: float = parameter(
        0.0, unit="rad/s", low=-1047.2, high=1047.2, about="the same of the right circuits"
    )


@dataclass(frozen=True, slots=True)
class PlanarOnBenchParameters(PlanarParameters):
    """The planar plant, and how it takes what the bench measures."""

    rotor_share: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the rotor's torque J w' that is added to the measured one: the virtual "
        "car's wheel has the "
        "rotor's inertia, but the torque behind the rotor, where the transducer sits, has moved "
        "the rotor already",
        source="assumption: the source drives the wheel with the measured torque and does not "
        "speak of the rotor",
    )
    wheel_speed: str = parameter(
        "load_machine",
        choices=WHEEL_SPEEDS,
        about="with which speed a driven wheel meets the road: load_machine: the one measured at "
        "its load machine; "
        "virtual: the one that the load machine is set to hold, the default behind a real bus",
        source="dissertation, section 4.1: the speed of the load machine is that of the virtual "
        "driven wheel",
    )
    load: LoadParameters = group(LoadParameters)


@dataclass(slots=True)
class PlanarOnBenchState(PlanarState):
    """The same, and what the bench has measured last."""

    measured_torque: list[float] = per_wheel(
        unit="N m", about="of the machine with its rotor, at the shaft"
    )
    measured_speed: list[float] = per_wheel(unit="rad/s", about="of the shaft")
    set_speed: list[float] = per_wheel(
        unit="rad/s", about="of the wheel, the last set-point of the load machine"
    )
    apart: list[float] = per_wheel(
        unit="rad/s", about="of the wheel: load machine less its set-point"
    )
    measured_power: float = entry(unit="W", about="that the machines took from the battery")


def at_start(p: PlanarOnBenchParameters, car: Car, c: PlanarConstants) -> PlanarOnBenchState:
    """Begin as the planar plant does; the shafts rest."""
    s: PlanarOnBenchState = begin(p, car, c, PlanarOnBenchState)
    for i in range(4):
        # As if the load machines had held the speed of the wheels before, so that nothing is apart
        # at first.
        s.set_speed[i] = s.motion[WHEEL_SPEED + i]
    return s


def individual_machines(_parameters: PlanarOnBenchParameters, vehicle: Vehicle) -> str:
    """Name what a car lacks: a machine behind each wheel, with the torque that laws ask for."""
    if not has_own_motors(vehicle):
        return "driveline.coupling individual"
    if not has_equal_motors(vehicle):
        return "equal motors and gears at all driven wheels, and no engine"
    return "blend_brakes false" if vehicle.blend_brakes else ""


@compilable
def outputs(
    p: PlanarOnBenchParameters, car: Car, c: PlanarConstants, s: PlanarOnBenchState
) -> tuple[*Seen, LoadCommand]:
    """All signals at the instant of the state; torque and speed of the motors are measured ones."""
    plant = Plant(p, car, c, s, working_memory(STEP_MEMORY)[0])
    wheels, _, imu, velocity, pose, battery, tires = seen(plant)
    motors = MotorStates(wheels_from(s.measured_speed, 0), wheels_from(s.measured_torque, 0))
    return wheels, motors, imu, velocity, pose, battery, tires, _load(plant)


@compilable
def rolling_outputs(
    p: PlanarOnBenchParameters, car: Car, c: PlanarConstants, s: PlanarOnBenchState
) -> tuple[*Seen, LoadCommand, BodyRoll]:
    """The same, and the roll of a body that rolls."""
    wheels, motors, imu, velocity, pose, battery, tires, load = outputs(p, car, c, s)
    return wheels, motors, imu, velocity, pose, battery, tires, load, roll_of(s)


@compilable
def _load(plant: Plant) -> LoadCommand:
    """Load that wheel, road and brake ask for: n = i w, M = (F_x r + M_f + M_brake)/i.

    Or a constant torque, beside the speed at which the shaft turns, or a constant speed, beside the
    torque of the road.
    """
    _, car, _, s, step = plant
    p = plant.p.load
    y = s.motion
    gear = car.gear_ratio
    rolling = car.constant_rolling_resistance + car.rolling_resistance_growth * y[VX] * y[VX]
    mode = step.asked
    speed = step.shaft
    torque = step.target
    for i in range(4):
        radius = step.radius[i]
        dry = s.guard.brake[i] + radius * step.load[i] * (rolling + step.tyre[i].rolling_resistance)
        mode[i] = car.driven[i] * SPEED_MODE
        speed[i] = car.driven[i] * gear * (y[WHEEL_SPEED + i] - s.apart[i])
        torque[i] = car.driven[i] * (radius * step.force_x[i] + step.motion[i] * dry) / gear
        if p.follows == CONSTANT_TORQUE:
            mode[i] = car.driven[i] * TORQUE_MODE
            speed[i] = s.measured_speed[i]
            torque[i] = car.driven[i] * (p.torque_left if i % 2 == 0 else p.torque_right)
        elif p.follows == CONSTANT_SPEED:
            speed[i] = car.driven[i] * (p.speed_left if i % 2 == 0 else p.speed_right)
    return LoadCommand(wheels_from(mode, 0), wheels_from(speed, 0), wheels_from(torque, 0))


class Measured(NamedTuple):
    """The commands, and the measurements of the bench."""

    commanded: Commanded
    shafts: BenchShafts
    electrical: BenchElectrical


@method(
    "plant",
    "planar_on_bench",
    needs=(individual_machines,),
    **PLANAR
    | {
        "state": PlanarOnBenchState,
        "start": at_start,
        "outputs": outputs,
        "writes": (*PLANAR_SIGNALS, LoadCommand),
        "options": {
            (ROLLING,): {
                "outputs": rolling_outputs,
                "writes": (*PLANAR_SIGNALS, LoadCommand, BodyRoll),
            }
        },
    },
)
@inlined
def planar_on_bench(
    p: PlanarOnBenchParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarOnBenchState,
    period: float,
    measured: Measured,
) -> None:
    """The planar plant, driven by the torque that a test bench measures, without drives of its own.

    Of the command it takes the brakes. Measured torque and power are those of the period before:
    that is what the exchange costs.
    """
    plant = Plant(p, car, c, s, working_memory(STEP_MEMORY)[0])
    for i in range(4):
        if car.driven[i] == 1.0:
            _take_shaft(plant, period, measured.shafts, i)
    power = _power(car, measured.electrical)
    s.measured_power = accepted(s.guard, power, 0.0, -_MOST_POWER, _MOST_POWER)
    advance(plant, period, measured.commanded, _apply_measured, _book_measured)


@inlined
def _take_shaft(plant: Plant, period: float, shafts: BenchShafts, i: int) -> None:
    """Take torque and speeds that the bench has measured for wheel i."""
    p, car, c, s, _ = plant
    # The acceleration of the shaft over the last period, w'.
    gained = (shafts.speed[i] - s.measured_speed[i]) / period
    torque = shafts.torque[i] + p.rotor_share * car.motor.rotor_inertia * gained
    most = _BEYOND * c.limits.drive[i] / car.gear_ratio
    s.measured_torque[i] = accepted(s.guard, torque, 0.0, -most, most)
    s.measured_speed[i] = shafts.speed[i]
    if p.wheel_speed == LOAD_MACHINE:
        # The wheel meets the road as its load machine turned when the last period ended. The
        # set-point of the load machine goes on from its last one, the speed
        # J w' = i M - F_x r - M_f - M_brake of the virtual wheel. One that follows a constant
        # ignores the wheel, which begins each period with the measured speed.
        speed = shafts.load_speed[i] / car.gear_ratio
        set_point = s.motion[WHEEL_SPEED + i] - s.apart[i]
        if p.load.follows != ROAD:
            set_point = accepted(s.guard, speed, set_point, -_MOST_SPEED, _MOST_SPEED)
            s.set_speed[i] = set_point
        # Against the set-point of the period before, which is the one that the load machine has
        # followed; where a constant is followed it is the measured speed, and nothing is apart.
        behind = speed - s.set_speed[i]
        s.apart[i] = accepted(s.guard, behind, 0.0, -_MOST_APART, _MOST_APART)
        s.set_speed[i] = set_point
        s.motion[WHEEL_SPEED + i] = set_point + s.apart[i]


@inlined
def _power(car: Car, electrical: BenchElectrical) -> float:
    """Power that the driven machines take [W]."""
    driven = car.driven
    voltage = electrical.voltage
    current = electrical.current
    front = driven[0] * voltage[0] * current[0] + driven[1] * voltage[1] * current[1]
    return front + (driven[2] * voltage[2] * current[2] + driven[3] * voltage[3] * current[3])


@inlined
def _apply_measured(plant: Plant) -> None:
    """Set the drive torques [N m] of the bench behind the gear, and the commanded brake torques."""
    car = plant.car
    s = plant.s
    step = plant.step
    for i in range(4):
        step.motor[i] = s.motor_torque[i] = s.measured_torque[i]
        step.drive[i] = behind_gear(car, step.motor[i] * car.gear_ratio, s.motion[WHEEL_SPEED + i])
        step.brake[i] = step.brake_command[i]


@inlined
def _book_measured(plant: Plant) -> None:
    """Book the energies of this step, and discharge the battery by the measured power."""
    _, car, c, s, step = plant
    mechanical = drive = 0.0
    for axle in range(2):
        left, right = 2 * axle, 2 * axle + 1
        left_speed, right_speed = step.turned[left] / c.h, step.turned[right] / c.h
        powers = step.motor[left] * left_speed + step.motor[right] * right_speed
        mechanical += powers * car.gear_ratio
        drive += step.drive[left] * left_speed + step.drive[right] * right_speed
    discharge(plant, s.measured_power + car.battery.auxiliary_power)
    s.motor_loss += (s.measured_power - mechanical) * c.h
    s.driveline_loss += (mechanical - drive) * c.h
    s.drive_work += drive * c.h
