"""A driver who only works the pedals: the steering wheel is left to a steering robot."""

from __future__ import annotations

from ev_msgs_py.methods import method
from ev_msgs_py.signals import BodyVelocity, DriverCommand, Instant
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.pedal_profile import Feet, FeetParameters, FeetState
from ev_sim.driver.profile_file import with_speed_profile_from_file


@method("driver", "manoeuvre")
class ManoeuvreDriver:
    """Follow a speed profile, then a pedal profile, with the hands off the steering wheel.

    Raises ParameterError if the parameters name a profile file that has not been read (`load_files`).
    """

    parameters = FeetParameters

    load_files = staticmethod(with_speed_profile_from_file)

    def __init__(self, parameters: FeetParameters, vehicle: Vehicle, period: float) -> None:
        self._feet = Feet(parameters, period)
        self.state = FeetState()

    def step(self, now: Instant, body: BodyVelocity) -> DriverCommand:
        """Pedals from the speed along the path and the time; no hand torque."""
        return DriverCommand(*self._feet.step(now.time, body.along_path, self.state), 0.0)
