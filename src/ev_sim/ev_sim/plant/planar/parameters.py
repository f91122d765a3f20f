"""The parameters of the planar plant."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from ev_core.faults.fault import faults_parameter
from ev_core.parameters.declaration import group, parameter, setting
from ev_sim.drives.drive import DRIVES, DriveParameters
from ev_sim.plant.planar.car_faults import PunctureParameters
from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file
from ev_sim.surfaces.road import RoadParameters

TORQUE_CONTROLLED = len(DRIVES)
SPEEDS = ("free", "held", "imposed")
FREE, HELD, IMPOSED = range(len(SPEEDS))


@dataclass(frozen=True, slots=True)
class PlanarParameters(DriveParameters):
    """Drives, step, start and road of the planar plant; the car itself is the vehicle description."""

    drive: str = setting(
        "torque_controlled",
        choices=(*DRIVES, "torque_controlled"),
        about="torque_controlled: the motor of the vehicle description; the others: a brushless DC drive, `motor`",
    )
    step: float = setting(
        1e-3, unit="s", low=1e-5, high=1e-3, about="longest step; stiff tyres on light wheels get shorter ones"
    )
    load_transfer_lag: float = setting(
        0.02,
        unit="s",
        low=0.002,
        high=1.0,
        about="time in which the wheel loads follow the tyre forces: springs and dampers in one number, an assumption "
        "that also keeps loads and forces from being an implicit equation",
    )
    initial_speed: float = setting(0.0, unit="m/s", low=-60.0, high=120.0, about="at the start, straight ahead")
    initial_x: float = setting(0.0, unit="m", low=-1e6, high=1e6, about="centre of mass in odom at the start")
    initial_y: float = setting(
        0.0, unit="m", low=-1e6, high=1e6, about="centre of mass in odom at the start", lateral=True
    )
    initial_heading: float = setting(0.0, unit="rad", low=-10.0, high=10.0, about="at the start", lateral=True)
    initial_drive_torque: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0, 0.0),
        unit="N m",
        low=-1e5,
        high=1e5,
        about="asked of each wheel: with any, the run begins in the equilibrium of straight running at constant speed "
        "with these torques, wheels at the slip that holds them; without, the wheels begin without slip",
        source="Ge & Ni 2005: straight running with T* comes before the turn",
        per_wheel=True,
    )
    speed: str = parameter(
        "free",
        choices=SPEEDS,
        about="longitudinal velocity of the centre of mass; held: that of the start; imposed: that of `imposed_speed`. "
        "A force along the car in the plane of the road takes or gives what that needs, as an ideal dynamometer does",
        source="Ge & Ni 2005: u is held; dissertation, chapter 3: the cycle imposes the speed (one of three readings)",
    )
    imposed_speed: SpeedProfileParameters = group(SpeedProfileParameters, time=(0.0,), speed=(0.0,))
    road: RoadParameters = group(RoadParameters)
    faults: tuple[str, ...] = faults_parameter()
    puncture: PunctureParameters = group(PunctureParameters)


def load_files(parameters: PlanarParameters) -> PlanarParameters:
    """The parameters with the imposed speed from its file, if they name one; see `with_profile_from_file`."""
    return dataclasses.replace(
        parameters, imposed_speed=with_profile_from_file(parameters.imposed_speed, "imposed_speed")
    )
