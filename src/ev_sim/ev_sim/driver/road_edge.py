"""Whether a car that is to follow a path is still on its road."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry
from ev_msgs_py.contract.signals import BodyPose
from ev_msgs_py.elementary import hypot
from ev_sim.driver.path import Path, nearest, point_at


@dataclass(slots=True)
class RoadEdgeState:
    """When the car left the road, and how far it has been from the path."""

    has_left: float = entry(unit="", about="whether the centre of mass has been beyond an edge of the road")
    left_at: float = entry(unit="s", about="when it first was")
    farthest: float = entry(unit="m", about="largest distance of the centre of mass from the path")


@compilable
def watch_edge(path: Path, width: float, s: RoadEdgeState, time: float, pose: BodyPose, leg: int) -> None:
    """Keep when the centre of mass is first farther from the path than half the width [m] of the road."""
    distance, leg = nearest(path, pose.x, pose.y, leg)
    x, y = point_at(path, distance, leg)
    s.farthest = max(s.farthest, hypot(pose.x - x, pose.y - y))
    if s.has_left == 0.0 and s.farthest > 0.5 * width:
        s.has_left, s.left_at = 1.0, time


def edge_notes(s: RoadEdgeState, width: float) -> tuple[str, ...]:
    """One line about a car that has left the road; its distance by powers of ten, so that it seldom becomes another."""
    if not s.has_left:
        return ()
    farthest = next((limit for limit in (1000.0, 100.0, 10.0) if s.farthest > limit), 0.5 * width)
    return (f"the car left the road at {s.left_at:.2f} s and has been more than {farthest:g} m from its path",)
