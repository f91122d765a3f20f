"""The planar plant as a method of the role `plant`."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from ev_msgs_py.compiling.library import register_functions
from ev_msgs_py.contract.record import numbers
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import ParameterError, group, number_tree, parameter
from ev_msgs_py.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES
from ev_sim.drives.drive import DRIVES, DriveParameters
from ev_sim.drives.state import DriveState
from ev_sim.plant.commands import CommandGuard
from ev_sim.plant.planar.body import (
    DEFLECTION_X,
    DEFLECTION_Y,
    HEADING,
    TRANSFER_X,
    TRANSFER_Y,
    VX,
    WHEEL_SPEED,
)
from ev_sim.plant.planar.fused_loop import MEMORY, run
from ev_sim.plant.planar.powertrain import STATE_OF_CHARGE, TORQUE_SHARE
from ev_sim.plant.planar.records import COMMANDS, DRIVE_PARAMETERS, PLANT, car_record
from ev_sim.plant.planar.showing import SIGNALS, SIZE, loads_of, signals_of
from ev_sim.plant.planar.state import X, Y, at_rest
from ev_sim.plant.planar.step_width import longest_brushless_step, longest_step
from ev_sim.plant.planar.surroundings import road_tables
from ev_sim.profiles.profile_file import with_profile_from_file
from ev_sim.profiles.speed_profile import SpeedProfileParameters, refuse_unread_file
from ev_sim.surfaces.road import RoadParameters


@dataclass(frozen=True, slots=True)
class PlanarParameters(DriveParameters):
    """Drives, step, start and road of the planar plant; the car itself is the vehicle description."""

    drive: str = parameter(
        "torque_controlled",
        choices=(*DRIVES, "torque_controlled"),
        about="torque_controlled: the motor of the vehicle description; the others: a brushless DC drive, `motor`",
    )
    step: float = parameter(
        1e-3, unit="s", low=1e-5, high=1e-3, about="longest step; stiff tyres on light wheels get shorter ones"
    )
    load_transfer_lag: float = parameter(
        0.02,
        unit="s",
        low=0.002,
        high=1.0,
        about="time in which the wheel loads follow the tyre forces: springs and dampers in one number, an assumption "
        "that also keeps loads and forces from being an implicit equation",
    )
    initial_speed: float = parameter(0.0, unit="m/s", low=-60.0, high=120.0, about="at the start, straight ahead")
    initial_x: float = parameter(0.0, unit="m", low=-1e6, high=1e6, about="centre of mass in odom at the start")
    initial_y: float = parameter(0.0, unit="m", low=-1e6, high=1e6, about="centre of mass in odom at the start")
    initial_heading: float = parameter(0.0, unit="rad", low=-10.0, high=10.0, about="at the start")
    speed: str = parameter(
        "free",
        choices=("free", "held", "imposed"),
        about="longitudinal velocity of the centre of mass; held: that of the start; imposed: that of `imposed_speed`. "
        "A force along the car in the plane of the road takes or gives what that needs, as an ideal dynamometer does",
        source="Ge & Ni 2005: u is held; dissertation, chapter 3: the cycle imposes the speed (one of three readings)",
    )
    imposed_speed: SpeedProfileParameters = group(SpeedProfileParameters, time=(0.0,), speed=(0.0,))
    road: RoadParameters = group(RoadParameters)


@method("plant", "planar")
class PlanarPlant:
    """Body in the plane, four wheels on real tyres and real roads, drives and battery (docs/planar_plant.md).

    `state` is a float64 array (names in state.py), advanced in place; `row` has the numbers of all outputs (see
    showing.py). The plant is a pure function of its parameters and of the commands so far, to the bit. Raises
    ParameterError if the vehicle names an efficiency map that has not been read (`ev_msgs_py.efficiency_map`).
    """

    parameters = PlanarParameters
    writes = SIGNALS

    @staticmethod
    def load_files(parameters: PlanarParameters) -> PlanarParameters:
        """The parameters with the imposed speed from its file, if they name one; see `with_profile_from_file`."""
        return dataclasses.replace(
            parameters, imposed_speed=with_profile_from_file(parameters.imposed_speed, "imposed_speed")
        )

    def __init__(self, parameters: PlanarParameters, vehicle: Vehicle, period: float):
        p = parameters
        refuse_unread_file(p.imposed_speed, "imposed_speed")
        self.vehicle = vehicle
        self.period = period
        longest = min(p.step, longest_step(vehicle), p.load_transfer_lag)
        if p.drive in DRIVES:
            longest = min(longest, longest_brushless_step(vehicle, p.motor))
        self.steps = max(math.ceil(period / longest * (1.0 - 1e-12)), 1)
        self.h = period / self.steps
        self.state = at_rest()
        register_functions()
        motor_torque = p.motor.torque_limit if p.drive in DRIVES else vehicle.motor.peak_torque
        self.guard = CommandGuard(vehicle, motor_torque, vehicle.maximum_road_wheel_angle)
        self._road = road_tables(p.road, vehicle)
        self._maps = _efficiency_map(vehicle) if p.drive not in DRIVES else None
        self._voltages = np.array(vehicle.battery.open_circuit_voltage)
        self._record = self._plant_record(p)
        self._car, self._step = self._record["car"], self._record["step"]
        self._commands = memoryview(self._record.view(np.uint8))
        self._memory = np.zeros(MEMORY)
        self._imposed = p.imposed_speed.profile() if p.speed == "imposed" else None
        self._periods = 0
        self._lifted: set[str] = set()
        self.row = np.zeros(SIZE)
        self._start(p)
        self._run(0)

    def _plant_record(self, p: PlanarParameters) -> np.ndarray:
        record, motor = np.zeros(1, PLANT), self.vehicle.motor
        record["car"] = car_record(self.vehicle, p.load_transfer_lag, p.drive in DRIVES, p.speed != "free")
        record["step"]["cos_steer"] = 1.0
        record["step"]["segment"] = -1  # nothing is found yet
        record["drives"] = tuple(numbers(DriveState()))
        own = DriveParameters(p.drive, p.motor, p.averaged, p.switched) if p.drive in DRIVES else DriveParameters()
        record["drive_parameters"] = np.array(numbers(number_tree(own))).view(DRIVE_PARAMETERS)
        record["h"] = self.h
        record["lags"] = (
            -math.expm1(-self.h / motor.torque_lag),
            1.0 + math.expm1(-self.h / motor.torque_lag) * motor.torque_lag / self.h,
            -math.expm1(-self.h / self.vehicle.driveline.clutch_lag),
            -math.expm1(-self.h / motor.overload_time),
        )
        return record

    def _start(self, p: PlanarParameters) -> None:
        """Rolling straight ahead, or, without speed, parked: the carcasses hold the car on its slope."""
        state, car = self.state, self._car[0]
        state[VX] = p.initial_speed
        state[X], state[Y], state[HEADING] = p.initial_x, p.initial_y, p.initial_heading
        state[WHEEL_SPEED : WHEEL_SPEED + 4] = p.initial_speed / self.vehicle.wheel_radius
        state[STATE_OF_CHARGE] = self.vehicle.battery.state_of_charge
        state[TORQUE_SHARE : TORQUE_SHARE + 4] = car["driven"] / max(car["driven"].sum(), 1.0)
        if p.initial_speed == 0.0:
            self._run(0)
            step = self._step[0]
            state[TRANSFER_X], state[TRANSFER_Y] = -step["gravity_x"], -step["gravity_y"]
            front = car["rear_arm"] / car["wheelbase"]
            share = 0.5 * np.array((front, front, 1.0 - front, 1.0 - front))
            state[DEFLECTION_X : DEFLECTION_X + 4] = -share * car["mass"] * step["gravity_x"] / car["stiffness_x"]
            state[DEFLECTION_Y : DEFLECTION_Y + 4] = -share * car["mass"] * step["gravity_y"] / car["stiffness_y"]

    def _run(self, steps: int) -> None:
        """Take a number of steps, and observe the plant."""
        off_the_ground = run(
            self.state, self._record, steps, self._memory, self.row, *self._road, self._voltages, self._maps
        )
        if off_the_ground:
            loads = loads_of(self.row)
            self._lifted |= {name for name, load in zip(WHEEL_NAMES, loads, strict=True) if load == 0.0}

    def advance(self, command: WheelTorqueCommand, column: SteeringColumnState) -> None:
        """Integrate over one period under a command that is held and a steering angle that goes on at its rate."""
        drive, brake = self.guard.torques(command)
        angle, rate = self.guard.steering(column, self.period)
        self._periods += 1
        acceleration = 0.0
        if self._imposed is not None:
            acceleration = (self._imposed.at(self._periods * self.period) - float(self.state[VX])) / self.period
        COMMANDS.pack_into(self._commands, 0, *drive, *brake, angle, rate, acceleration)
        self._run(self.steps)

    def outputs(self) -> tuple:
        """Everything that the plant writes, at the instant of its state."""
        return signals_of(self.row.tolist())

    @property
    def records(self) -> tuple:
        """Constants of the car and what acts on it now (records.py), for whoever evaluates `rates` outside of a run."""
        return self._car[0], self._step[0]

    def reports(self) -> tuple[str, ...]:
        """Commands that were not taken as they came, counted by powers of ten, and wheels that have left the ground."""
        if not (self.guard.refused or self._lifted):
            return ()  # asked after every step
        lifted = (f"{name} wheel left the ground" for name in WHEEL_NAMES if name in self._lifted)
        return (*self.guard.reports(), *lifted)

    @property
    def diagnostics(self) -> dict[str, float]:
        """Counts of commands that were not taken as they came, and of wheels off the ground now."""
        return {**self.guard.diagnostics, "lifted_wheels": int(np.count_nonzero(loads_of(self.row) == 0.0))}


def _efficiency_map(vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    motor = vehicle.motor
    if motor.map_file:
        raise ParameterError(f"vehicle.motor.map_file: {motor.map_file} has not been read into the map")
    if not motor.map_efficiency:
        return None
    return np.array(motor.map_speed), np.array(motor.map_torque), np.array(motor.map_efficiency)
