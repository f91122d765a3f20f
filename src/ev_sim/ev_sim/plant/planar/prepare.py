"""What the planar plant is told once: step width, constants of the car, and its tables."""

from __future__ import annotations

import math
from typing import NamedTuple

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.elementary import expm1
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.drive_train import has_equal_motors, has_own_motors
from ev_sim.drives.drive import DRIVES
from ev_sim.plant.commands import GuardLimits, guard_limits
from ev_sim.plant.planar.constants import BodyConstants, body_constants
from ev_sim.plant.planar.drive_torques import Lags
from ev_sim.plant.planar.electrical import Electrical, electrical_over
from ev_sim.plant.planar.energy import EfficiencyMap, PowerConstants
from ev_sim.plant.planar.faults.parameters import CarFaults, car_faults
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.road_under_wheels import RoadTables, road_tables
from ev_sim.plant.planar.step_width import longest_brushless_step, longest_step
from ev_sim.profiles.profile import Profile
from ev_sim.profiles.speed_profile import wanted_speed


class PlanarConstants(NamedTuple):
    """What the functions of the plant get as `c`."""

    h: float  # width of a step [s]
    steps: float  # in a control period
    limits: GuardLimits
    body: BodyConstants
    lags: Lags
    power: PowerConstants
    road: RoadTables
    initial_drive_torque: tuple[float, ...]  # of each wheel [N m]
    imposed: Profile  # speed [m/s]
    faults: CarFaults


def prepare(parameters: PlanarParameters, vehicle: Vehicle, period: float) -> PlanarConstants:
    """The constants of a plant; ParameterError if a file that it names has not been read."""
    p = parameters
    brushless = p.drive in DRIVES
    if brushless and not has_equal_motors(vehicle):
        raise ParameterError(f"drive {p.drive} needs equal motors and gears at all driven wheels, and no engine")
    steps = number_of_steps(p, vehicle, period)
    motor_torque = p.motor.torque_limit if brushless else vehicle.motor.peak_torque
    return PlanarConstants(
        h=period / steps,
        steps=steps,
        limits=guard_limits(vehicle, motor_torque, vehicle.maximum_road_wheel_angle),
        body=body_constants(vehicle),
        lags=lags_over(period / steps, vehicle),
        power=PowerConstants(
            capacity=vehicle.battery.capacity * 3600.0,
            voltage=vehicle.battery.open_circuit_voltage,
            resistance=vehicle.battery.resistance,
            map=EfficiencyMap((), (), ()) if brushless else efficiency_map(vehicle),
            electrical=Electrical(),
            gearbox=vehicle.engine.gearbox.ratios,
        ),
        road=road_tables(p.road, vehicle),
        initial_drive_torque=checked_initial_torque(p, vehicle),
        imposed=wanted_speed(p.imposed_speed, "imposed_speed"),
        faults=car_faults(p.faults, vehicle, period, brushless, vehicle.tyre.lateral_curve == "same"),
    )


def prepare_electrical(parameters: PlanarParameters, vehicle: Vehicle, period: float) -> PlanarConstants:
    """The same with cells and the electrical side of the motors."""
    if parameters.drive in DRIVES:
        raise ParameterError(f"planar_electrical needs drive torque_controlled, not {parameters.drive}")
    if vehicle.engine.peak_power > 0.0:
        raise ParameterError("planar_electrical needs motors, not vehicle.engine")
    c, cells = prepare(parameters, vehicle, period), vehicle.battery.cells
    power = c.power._replace(
        voltage=tuple(cells.in_series * voltage for voltage in cells.open_circuit_voltage),
        resistance=cells.in_series * cells.resistance,
        electrical=electrical_over(c.h, vehicle),
    )
    return c._replace(power=power)


def checked_initial_torque(parameters: PlanarParameters, vehicle: Vehicle) -> tuple[float, ...]:
    """The drive torques of the four wheels at the start [N m]; ParameterError for a car that cannot have them."""
    torques = parameters.initial_drive_torque
    if len(torques) != 4:
        raise ParameterError("initial_drive_torque needs four elements, one for each wheel")
    undriven = [n for n, torque in zip(WHEEL_NAMES, torques, strict=True) if torque and n not in vehicle.driven_wheels]
    for lacks, needed in (
        (parameters.initial_speed == 0.0, "an initial_speed other than 0"),
        (parameters.drive in DRIVES, "drive torque_controlled"),
        (not has_own_motors(vehicle), "vehicle.driveline.coupling individual"),
        (vehicle.tyre.curve == "mf_tyre", "a vehicle.tyre.curve other than mf_tyre"),
        (undriven, f"a motor at {', '.join(undriven)}"),
    ):
        if any(torques) and lacks:
            raise ParameterError(f"initial_drive_torque needs {needed}")
    return torques


def number_of_steps(parameters: PlanarParameters, vehicle: Vehicle, period: float) -> int:
    """Steps in a period, each as wide as it may be at most."""
    longest = min(parameters.step, longest_step(vehicle), parameters.load_transfer_lag)
    if vehicle.suspension.roll_lag > 0.0:
        longest = min(longest, vehicle.suspension.roll_lag)
    if parameters.drive in DRIVES:
        longest = min(longest, longest_brushless_step(vehicle, parameters.motor))
    rounding = 1e-12  # a period of a whole number of steps gets no more than that
    return max(math.ceil(period / longest * (1.0 - rounding)), 1)


def lags_over(h: float, vehicle: Vehicle) -> Lags:
    """What each lag closes over a step of h [s]."""
    motor = vehicle.motor
    return Lags(
        torque=-expm1(-h / motor.torque_lag),
        torque_mean=1.0 + expm1(-h / motor.torque_lag) * motor.torque_lag / h,
        clutch=-expm1(-h / vehicle.driveline.clutch_lag),
        heat=-expm1(-h / motor.overload_time),
    )


def efficiency_map(vehicle: Vehicle) -> EfficiencyMap:
    """The map of the motors, empty if there is none."""
    motor = vehicle.motor
    if motor.map_file:
        raise ParameterError(f"vehicle.motor.map_file: {motor.map_file} has not been read into the map")
    return EfficiencyMap(motor.map_speed, motor.map_torque, motor.map_efficiency)
