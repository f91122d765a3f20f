"""A course: lanes between cones, as a scenario describes them, and what a car does to them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np

from ev_core.parameters.declaration import parameter, setting
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording


@dataclass(frozen=True, slots=True)
class Course:
    """Lanes along x in odom; every list has one value for each lane.

    The width of a lane is `width_factor` times the width of the car plus `width_margin`, at least
    `least_width`.

    A course is symmetric: a car that goes to the other side in the first lane that lies aside
    drives its mirror image.
    """

    title: str = setting("", about="title of its figure; empty for the name of the run")
    begin: tuple[float, ...] = setting(
        (),
        unit="m",
        low=-1e6,
        high=1e6,
        about="where each lane begins, rising; none: there is no course",
    )
    end: tuple[float, ...] = setting((), unit="m", low=-1e6, high=1e6, about="where each lane ends")
    middle: tuple[float, ...] = setting(
        (),
        unit="m",
        low=-1e3,
        high=1e3,
        about="middle of each lane, from that of the first; none: all 0",
        lateral=True,
    )
    gap: tuple[float, ...] = setting(
        (),
        unit="m",
        low=-1e3,
        high=1e3,
        lateral=True,
        about=(
            "where not 0, from the edge of the first lane to the near edge of this one, instead of"
            " `middle`"
        ),
    )
    width_factor: tuple[float, ...] = setting(
        (), unit="1", low=0.0, high=10.0, about="times the width of the car; none: all 0"
    )
    width_margin: tuple[float, ...] = setting(
        (), unit="m", low=0.0, high=1e3, about="added to that; none: all 0"
    )
    least_width: tuple[float, ...] = setting(
        (), unit="m", low=0.0, high=1e3, about="at least; none: all 0"
    )
    cones: int = setting(4, low=2, high=1000, about="on each side of a lane, its ends included")
    body_beside_track: float = parameter(
        0.21,
        unit="m",
        low=0.0,
        high=1.0,
        about="width of the body beyond the larger track: one tyre's width",
    )
    overhang: float = parameter(
        0.7, unit="m", low=0.0, high=3.0, about="of the body beyond each axle"
    )

    def __post_init__(self) -> None:
        """Check the lists.

        ParameterError unless they describe lanes one behind the other, with widths.
        """
        for each in fields(self):
            values = getattr(self, each.name)
            if (
                isinstance(values, tuple)
                and len(values) != len(self.begin)
                and (values or each.name == "end")
            ):
                raise ParameterError(
                    f"{each.name} has {len(values)} values, expected {len(self.begin)} as begin has"
                )
        # Even pairs are begin and end of one lane, which has a length; odd ones are the way to the
        # next lane, which may be none.
        ends = [place for lane in zip(self.begin, self.end, strict=True) for place in lane]
        if any(b <= a if n % 2 == 0 else b < a for n, (a, b) in enumerate(pairwise(ends))):
            raise ParameterError("begin and end do not rise, expected lanes one behind the other")
        widths = zip(
            self._of("width_factor"), self._of("width_margin"), self._of("least_width"), strict=True
        )
        if any(not any(width) for width in widths):
            raise ParameterError(
                "a lane has no width, expected a width_factor, width_margin or least_width"
            )

    def _of(self, name: str) -> tuple[float, ...]:
        return getattr(self, name) or (0.0,) * len(self.begin)

    def body_width(self, vehicle: Vehicle) -> float:
        """Width of the body [m]: the vehicle description ends at the wheels."""
        return max(vehicle.front_track, vehicle.rear_track) + self.body_beside_track

    def lanes(self, vehicle: Vehicle, side: float = 1.0) -> tuple[Lane, ...]:
        """The lanes for a car; `side` is -1 for the mirror image."""
        body = self.body_width(vehicle)
        sizes = zip(
            self._of("width_factor"), self._of("width_margin"), self._of("least_width"), strict=True
        )
        widths = [max(factor * body + margin, least) for factor, margin, least in sizes]
        found = []
        for n, (middle, gap) in enumerate(zip(self._of("middle"), self._of("gap"), strict=True)):
            # A gap counts from edge to edge, a middle from middle to middle: half of both widths
            # lies between.
            aside = gap + np.copysign(widths[0] / 2 + widths[n] / 2, gap) if gap else middle
            # -1 times 0 is -0, which would be printed as such: + 0.0 makes it 0.
            found.append(Lane(self.begin[n], self.end[n], side * float(aside) + 0.0, widths[n]))
        return tuple(found)


NO_COURSE = Course()


@dataclass(frozen=True, slots=True)
class Lane:
    """A lane along x, from `begin` to `end`, around `middle`, all in odom [m]."""

    begin: float
    end: float
    middle: float
    width: float


def lanes_driven(run: Recording, vehicle: Vehicle, course: Course) -> tuple[Lane, ...]:
    """Lanes on the side to which the car goes in the first lane aside.

    Raises NotMeasured if there is no course.
    """
    if not course.begin:
        raise NotMeasured(
            "the scenario has no course: course.begin, course.end and so on describe one"
        )
    lanes = course.lanes(vehicle)
    # The first lane is straight ahead, so only one beside it shows to which side the car goes.
    aside = next((lane for lane in lanes if lane.middle), lanes[0])
    x, y = channel(run, "pose.x"), channel(run, "pose.y")
    # Half way along that lane a car that drives the course has changed over to it.
    there = y[np.abs(x - (aside.begin + aside.end) / 2).argmin()]
    return course.lanes(vehicle, -1.0 if there * aside.middle < 0.0 else 1.0)


def cones(run: Recording, vehicle: Vehicle, course: Course) -> np.ndarray:
    """Positions of the cones, (n, 2) [m].

    The lane's edge is where a cone begins, so a cone is a point on it.
    """
    return np.array(
        [
            (x, lane.middle + side * lane.width / 2)
            for lane in lanes_driven(run, vehicle, course)
            for x in np.linspace(lane.begin, lane.end, course.cones)
            for side in (-1, 1)
        ]
    )


def hit_cones(run: Recording, vehicle: Vehicle, course: Course) -> np.ndarray:
    """Marks of the cones that came to lie under the body, (n,) bool.

    The middle of the body is beside a centre of mass that is offset.
    """
    x, y, heading = channel(run, "pose.x"), channel(run, "pose.y"), motion.heading(run)
    # Ends of the body from the centre of mass, which is where the pose is.
    front = vehicle.wheelbase - vehicle.centre_of_mass_to_rear_axle + course.overhang
    rear = vehicle.centre_of_mass_to_rear_axle + course.overhang
    half, cosine, sine = course.body_width(vehicle) / 2, np.cos(heading), np.sin(heading)
    hit = []
    for cone_x, cone_y in cones(run, vehicle, course):
        # The cone in axes of the car, at every sample: x forward, y left of the middle of the body.
        ahead = (cone_x - x) * cosine + (cone_y - y) * sine
        aside = (cone_y - y) * cosine - (cone_x - x) * sine + vehicle.centre_of_mass_offset
        hit.append(bool(((ahead > -rear) & (ahead < front) & (np.abs(aside) < half)).any()))
    return np.array(hit)


def outside_lanes(run: Recording, lanes: Iterable[Lane]) -> np.ndarray:
    """Marks of the samples with the centre of mass beside a lane and not in it, (n,) bool."""
    x, y = channel(run, "pose.x"), channel(run, "pose.y")
    found = np.zeros(len(x), bool)
    for lane in lanes:
        # Edges belong to the lane; between two lanes the car may be anywhere.
        found |= (x >= lane.begin) & (x <= lane.end) & (np.abs(y - lane.middle) > lane.width / 2)
    return found


def edges(
    run: Recording, vehicle: Vehicle, course: Course
) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Paths of the left and the right side of the body at the centre of mass, x and y (n,) [m]."""
    x, y, heading = channel(run, "pose.x"), channel(run, "pose.y"), motion.heading(run)
    half, offset = course.body_width(vehicle) / 2, vehicle.centre_of_mass_offset
    # The middle of the body is beside the centre of mass by the offset, to the right of it.
    ends = (half - offset, -half - offset)
    return tuple((x - end * np.sin(heading), y + end * np.cos(heading)) for end in ends)
