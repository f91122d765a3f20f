"""The planar plant at the start of a run, its signals at an instant, and its notes.

How it works: `begin` makes the state of the start: rolling, in the equilibrium of given drive
torques, or parked on a slope. `outputs` evaluates the rates once at the instant of the state, which
leaves forces, slips and accelerations in the step. `keep_noted` marks events in the state, of which
`notes` makes lines after the run.
"""

from __future__ import annotations

from typing import Any, get_args

from ev_core.law import (
    Car,
    InertialMeasurement,
    ParameterError,
    asin,
    compilable,
    cos,
    inlined,
    sin,
    working_memory,
)
from ev_msgs_py.contract.optional_signals import (
    BodyRoll,
    CellCondition,
    MotorElectrics,
    MotorTemperatures,
)
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    MotorStates,
    TireForces,
    WheelStates,
)
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_sim.drives.driveline import begin_engine, shaft_speeds
from ev_sim.drives.electrical_side import coolant_outlet_temperature, current_at_power
from ev_sim.drives.synchronous_motor import phase_values
from ev_sim.plant.guard import guard_notes
from ev_sim.plant.planar import planar_state as state
from ev_sim.plant.planar.body import bear, loads, rates, steer
from ev_sim.plant.planar.contact import (
    find_road,
    gravity_at,
    look,
    slips,
    speed_resistance,
    within_friction,
)
from ev_sim.plant.planar.given import PlanarParameters, deflate
from ev_sim.plant.planar.model import Mechanics, Plant
from ev_sim.plant.planar.planar_state import STEP_MEMORY, PlanarState, Step, wheels_from
from ev_sim.plant.planar.powertrain import drive_loss, source_voltage, terminal_voltage
from ev_sim.plant.planar.prepare import PlanarConstants, PowerConstants
from ev_sim.tyres.curve import FRICTION_CURVES, Coefficients, friction, peak_slip

Seen = tuple[
    WheelStates,
    MotorStates,
    InertialMeasurement,
    BodyVelocity,
    BodyPose,
    BatteryCondition,
    TireForces,
]
PLANAR_SIGNALS: tuple[type, ...] = get_args(Seen)
Electrics = tuple[MotorElectrics, MotorTemperatures, CellCondition]
SeenWithElectrics = tuple[*Seen, *Electrics]
ELECTRICAL_SIGNALS = (*PLANAR_SIGNALS, *get_args(Electrics))
ROLLING_SIGNALS = (*PLANAR_SIGNALS, BodyRoll)
ELECTRICAL_ROLLING_SIGNALS = (*ELECTRICAL_SIGNALS, BodyRoll)

_HALVINGS = 60  # of an interval of at most 1: to rounding
_REFUSED = (
    "more torque was asked against the gear than the engine's drag: the gear stayed, the selector "
    "moves below "
    "vehicle.engine.gearbox.selector_speed"
)


@inlined
def keep_noted(s: PlanarState, car: Car, c: PlanarConstants) -> None:
    """Keep which wheels are off the ground in this state, and whether the battery is empty."""
    if s.state_of_charge <= 0.0:
        s.battery_empty = 1.0
    _, _, gravity_z, _ = gravity_at(c.road.slope, s.motion[state.BODY_DISTANCE], 0)
    load = loads(s.motion, car, c.body, gravity_z)
    for i in range(4):
        # Exactly zero, as `wheel_loads` has it of a lifted wheel.
        if load[i] == 0.0:
            s.lifted[i] = 1.0


def notes(s: PlanarState) -> tuple[str, ...]:
    """Lines about commands that were not taken as they came, by powers of ten, and about events."""
    lifted = (
        f"{name} wheel left the ground"
        for name, was in zip(WHEEL_NAMES, s.lifted, strict=True)
        if was
    )
    empty = ("the battery was empty: no drive torque from it",) if s.battery_empty else ()
    refused = (_REFUSED,) if s.engine.refused else ()
    return (*guard_notes(s.guard), *lifted, *empty, *refused)


def begin_driven(s: PlanarState, car: Car, c: PlanarConstants) -> None:
    """Set wheels, carcasses and motors to hold `c.initial_drive_torque` at the car's speed.

    The body does not accelerate: a force in the plane of the road holds its speed until the run
    begins, against that of the tyres, so that drag and slope alone pitch it. ParameterError if a
    tyre cannot hold its torque.
    """
    y, step = s.motion, Step()
    radius, speed = step.radius, s.motion[state.VX]
    find_road(y, c.body, step, c.road, True)
    # At constant speed the forces at the road balance drag and slope.
    y[state.TRANSFER_X] = speed_resistance(car, c.body, speed) / car.mass - step.gravity_x
    bear(y, car, c.body, step)
    load = step.load
    rolling = car.constant_rolling_resistance + car.rolling_resistance_growth * speed * speed
    efficiency = car.motor.gear_efficiency
    for i in range(4):
        asked, tyre = c.initial_drive_torque[i], step.tyre[i]
        # Behind the gear, as `behind_gear`: less of what drives, more of what brakes.
        torque = asked * efficiency if asked * speed > 0.0 else asked / efficiency
        resistance = load[i] * (rolling + tyre.rolling_resistance)
        force = torque / radius[i] - (resistance if speed > 0.0 else -resistance)
        curve = Coefficients(tyre.c0, tyre.c1, tyre.c2, tyre.c3)
        slip = _slip_at(car, curve, abs(force) / max(load[i], 1e-9))
        if slip is None:
            raise ParameterError(
                f"initial_drive_torque is {asked:g} N m at {WHEEL_NAMES[i]}, "
                f"expected what its tyre holds, {tyre.friction * load[i] * radius[i]:.5g} N m"
            )
        # Slip is over the faster one of rim and road.
        rim = speed / (1.0 - slip) if force * speed > 0.0 else speed * (1.0 - slip)
        y[state.WHEEL_SPEED + i] = rim / radius[i]
        y[state.SLIP_X + i] = slip if force >= 0.0 else -slip
        y[state.DEFLECTION_X + i] = force / car.tyre.longitudinal_stiffness
        s.motor_torque[i] = asked / car.gear[i] / car.motors[i]
        s.mean_drive[i] = torque


def _slip_at(car: Car, curve: Coefficients, use: float) -> float | None:
    """Slip [1] before the peak of the friction curve at a friction use [1]; None if none has it."""
    kind = car.tyre.curve
    low, high = 0.0, peak_slip(FRICTION_CURVES[int(kind)], tuple(curve))
    if use > friction(kind, high, curve):
        return None
    # By halving, for any curve: up to its peak each of them rises.
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if friction(kind, middle, curve) < use:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def begin(
    p: PlanarParameters, car: Car, c: PlanarConstants, kind: type[PlanarState] = PlanarState
) -> Any:
    """Begin rolling straight ahead, freely or driven; without speed parked.

    The carcasses of a parked car hold it on its slope.
    """
    s = kind()
    s.x, s.y = p.initial_x, p.initial_y
    s.state_of_charge = car.battery.state_of_charge
    y = s.motion
    y[state.VX], y[state.HEADING] = p.initial_speed, p.initial_heading
    y[state.VY], y[state.YAW_RATE] = p.initial_lateral_velocity, p.initial_yaw_rate
    for i in range(4):
        y[state.WHEEL_SPEED + i] = p.initial_speed / c.body.wheel_radius[i]
        s.torque_share[i] = car.driven[i] / max(car.number_driven, 1.0)
    if car.engine_driven == 1.0:
        turning = (car.gear[i] * y[state.WHEEL_SPEED + i] for i in range(4) if car.driven[i] == 1.0)
        begin_engine(s.engine, car.engine, c.power.gearbox, next(turning))
    if p.initial_speed == 0.0:
        _park(s, car, c)
    if any(c.initial_drive_torque):
        begin_driven(s, car, c)
    keep_noted(s, car, c)
    return s


def _park(s: PlanarState, car: Car, c: PlanarConstants) -> None:
    """Load the carcasses by the slope, each as far as its friction goes.

    A car on too steep a slope slides at once.
    """
    y = s.motion
    step = Step()
    front = car.centre_of_mass_to_rear_axle / car.wheelbase
    find_road(y, c.body, step, c.road, True)
    # At rest the forces at the road hold the slope, and they move the loads.
    y[state.TRANSFER_X], y[state.TRANSFER_Y] = -step.gravity_x, -step.gravity_y
    roll = c.body.roll
    if roll.rolls == 1.0:
        # A body leans down the slope until its springs hold it.
        held = roll.stiffness - roll.weight * step.gravity_z
        y[state.ROLL_ANGLE] = roll.weight * y[state.TRANSFER_Y] / held
    bear(y, car, c.body, step)
    look(y, car, c.body, step, True)
    for i in range(4):
        share = 0.5 * (front if i < 2 else 1.0 - front)
        force_x, force_y = -share * car.mass * step.gravity_x, -share * car.mass * step.gravity_y
        scale_x, scale_y = within_friction(car, step.contact, i, force_x, force_y)
        y[state.DEFLECTION_X + i] = scale_x * force_x / car.tyre.longitudinal_stiffness
        y[state.DEFLECTION_Y + i] = scale_y * force_y / car.tyre.lateral_stiffness


@compilable
def outputs(p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState) -> Seen:
    """All signals at the instant of the state; drive torques are means over the last period."""
    return seen(Plant(p, car, c, s, working_memory(STEP_MEMORY)[0]))


@compilable
def seen(plant: Plant) -> Seen:
    """The signals of `outputs`; what acts at this instant is left in the step."""
    p, car, c, s, step = plant
    y = s.motion
    step.imposed_acceleration = s.imposed_acceleration
    find_road(y, c.body, step, c.road, True)
    if s.faults.is_struck == 1.0:
        deflate(s.faults, p, car, c.body, step)
    steer(car, step, s.road_wheel_angle, s.rear_angle)
    # As the first evaluation of the next step will: dry friction is decided for this instant.
    rates(y, step.stages.k1, Mechanics(p, car, c.body, step), True)
    shaft_speeds(car, wheels_from(y, state.WHEEL_SPEED), step.shaft)
    slip_x, slip_y = step.asked, step.target  # memory that nothing else needs here
    for i in range(4):
        step.shaft[i] = step.shaft[i] * car.driven[i] * car.gear[i]
        step.motor[i] = s.motor_torque[i] * car.motors[i]
        slip_x[i], sine = slips(y, car, c.body, step.contact, i)
        # A slip angle points where the wheel slides, against the side force that is counted here.
        slip_y[i] = -asin(min(max(sine, -1.0), 1.0))
    tyre = step.tyre
    return (
        WheelStates(
            wheels_from(y, state.WHEEL_ANGLE),
            wheels_from(y, state.WHEEL_SPEED),
            wheels_from(s.mean_drive, 0),
        ),
        MotorStates(wheels_from(step.shaft, 0), wheels_from(step.motor, 0)),
        InertialMeasurement(y[state.YAW_RATE], step.acceleration_x, step.acceleration_y),
        BodyVelocity(y[state.VX], y[state.VY], y[state.YAW_RATE]),
        BodyPose(s.x, s.y, sin(y[state.HEADING] / 2), cos(y[state.HEADING] / 2)),
        _battery(s, c.power),
        TireForces(
            wheels_from(step.force_x, 0),
            wheels_from(step.force_y, 0),
            wheels_from(step.load, 0),
            wheels_from(slip_x, 0),
            wheels_from(slip_y, 0),
            Wheels(tyre[0].friction, tyre[1].friction, tyre[2].friction, tyre[3].friction),
        ),
    )


@compilable
def _battery(s: PlanarState, power: PowerConstants) -> BatteryCondition:
    """The battery under the power of the last step; the current counts into it."""
    source, soc = source_voltage(s, power), s.state_of_charge
    capacity = power.capacity / 3600.0
    current = current_at_power(source, power.resistance, s.battery_power)
    voltage = source - power.resistance * current
    return BatteryCondition(voltage, -current, soc * capacity, capacity, soc)


@compilable
def electrical_outputs(
    p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState
) -> SeenWithElectrics:
    """The signals of `planar`, and of motors, inverters and cells; voltages in steady state."""
    wheels, motors, imu, velocity, pose, battery, tires = outputs(p, car, c, s)
    plant = Plant(p, car, c, s, working_memory(STEP_MEMORY)[0])
    electrics, temperatures, cell = electrics_of(plant)
    return wheels, motors, imu, velocity, pose, battery, tires, electrics, temperatures, cell


@compilable
def roll_of(s: PlanarState) -> BodyRoll:
    """The roll of the body at the instant of the state."""
    angle = s.motion[state.ROLL_ANGLE]
    return BodyRoll(sin(angle / 2), cos(angle / 2), s.motion[state.ROLL_RATE])


@compilable
def rolling_outputs(
    p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState
) -> tuple[*Seen, BodyRoll]:
    """The signals of `planar`, and the roll of a body that rolls."""
    wheels, motors, imu, velocity, pose, battery, tires = outputs(p, car, c, s)
    return wheels, motors, imu, velocity, pose, battery, tires, roll_of(s)


@compilable
def electrical_rolling_outputs(
    p: PlanarParameters, car: Car, c: PlanarConstants, s: PlanarState
) -> tuple[*SeenWithElectrics, BodyRoll]:
    """The signals of both."""
    seen_at = electrical_outputs(p, car, c, s)
    wheels, motors, imu, velocity, pose, battery, tires, electrics, temperatures, cell = seen_at
    roll = roll_of(s)
    return wheels, motors, imu, velocity, pose, battery, tires, electrics, temperatures, cell, roll


@compilable
def electrics_of(plant: Plant) -> Electrics:
    """Signals of motors, inverters and cells at the instant of the state."""
    _, car, c, s, step = plant
    motor = car.motor
    thermal = car.motor.thermal
    cells = car.battery.cells
    step.voltage = terminal_voltage(s, c.power)
    shaft_speeds(car, wheels_from(s.motion, state.WHEEL_SPEED), step.shaft)
    # Memory that nothing else needs here; a wheel without a motor keeps its zeros.
    current = step.asked
    voltage = step.target
    power = step.motor
    winding, inverter = step.load, step.force_x
    inlet = step.force_y
    outlet = step.turned
    flow = step.mean_speed
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        torque, speed = s.motor_torque[i], step.shaft[i] * car.gear[i]
        current[i], voltage[i] = phase_values(motor, torque, step.voltage, speed)
        loss = drive_loss(plant, i, torque, step.shaft[i])
        power[i] = torque * speed * car.motors[i] + loss
        winding[i] = thermal.coolant + s.winding_rise[i]
        inverter[i] = thermal.coolant + s.inverter_rise[i]
        inlet[i] = thermal.coolant
        outlet[i] = coolant_outlet_temperature(thermal, s.winding_rise[i], s.inverter_rise[i])
        flow[i] = thermal.coolant_flow
    electrics = MotorElectrics(
        wheels_from(current, 0), wheels_from(voltage, 0), wheels_from(power, 0)
    )
    temperatures = MotorTemperatures(
        wheels_from(winding, 0),
        wheels_from(inverter, 0),
        wheels_from(inlet, 0),
        wheels_from(outlet, 0),
        wheels_from(flow, 0),
    )
    cell = CellCondition(step.voltage / cells.in_series, cells.ambient + s.cells_rise)
    return electrics, temperatures, cell
