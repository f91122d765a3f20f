"""A driver who only works the pedals: the steering wheel is left to a steering robot."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.motion import speed_along_path
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, Instant
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.vehicle.car import Car
from ev_sim.driver.pedal_profile import UNBOUNDED, FeetParameters, FeetProfiles, FeetState, feet_profiles, work_pedals
from ev_sim.profiles.profile_file import with_speed_profile_from_file


@method(
    "driver",
    "manoeuvre",
    FeetParameters,
    state=FeetState,
    prepare=feet_profiles,
    load_files=with_speed_profile_from_file,
    mirrored=True,
)
@compilable
def manoeuvre(
    p: FeetParameters, car: Car, c: FeetProfiles, s: FeetState, period: float, now: Instant, body: BodyVelocity
) -> DriverCommand:
    """Follow a speed profile, then a pedal profile, with the hands off the steering wheel."""
    drive, brake = work_pedals(p, car, c, s, period, now.time, speed_along_path(body), UNBOUNDED)
    return DriverCommand(drive, brake, 0.0)
