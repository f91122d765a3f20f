"""A driver who follows the cycle."""

from __future__ import annotations

from ev_msgs_py.methods import method
from ev_msgs_py.signals import WheelStates
from ev_sim.driver.cycle_driver import CycleDriver


@method("driver", "tracking")
class Tracking(CycleDriver):
    """Follow a speed cycle with just the drive torque that it takes, and keep the lane.

    In windows of traction the foot is on the accelerator or off, never on the brake. This driver never asks for more
    than packed snow carries, so all torque controls come out alike (docs/dissertation.md).
    """

    def _drive(self, wanted: float, speed: float, wheels: WheelStates) -> float:
        s = self.state
        drive, _, s.speed_integral = self._control.step(wanted, speed, max(s.speed_integral, 0.0))
        return max(drive, 0.0)
