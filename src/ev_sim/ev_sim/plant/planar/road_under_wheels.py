"""What changes along the way: the surface under each wheel and the slope under the centre of mass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.car import GRAVITY
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.plant.planar.constants import BodyConstants
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.state import BODY_DISTANCE, DISTANCE
from ev_sim.profiles.profile import number_until
from ev_sim.surfaces.lookup import interpolate, segment_at
from ev_sim.surfaces.road import RoadParameters, Segments, left_and_right
from ev_sim.surfaces.table import TyreOnRoad, tyre_on_road

_WIDTH = len(TyreOnRoad._fields)


class Track(NamedTuple):
    """Where segments begin [m], and the numbers of `TyreOnRoad` on each of them, one after the other."""

    start: tuple[float, ...]
    tyres: tuple[float, ...]


class Slope(NamedTuple):
    """Distances [m], grade and side slope [1] there."""

    distance: tuple[float, ...]
    grade: tuple[float, ...]
    side_slope: tuple[float, ...]


class RoadTables(NamedTuple):
    """A road for the tyres of one vehicle."""

    left: Track
    right: Track
    slope: Slope


def road_tables(road: RoadParameters, vehicle: Vehicle) -> RoadTables:
    """The road for this vehicle's tyres."""
    left, right = left_and_right(road)
    scale = road.rolling_resistance_scale
    slope = Slope(road.slope_distance, road.grade, road.side_slope)
    of = {name: tyre_on_road(vehicle.tyre, road.surface(name), scale) for name in {*left.surface, *right.surface}}
    return RoadTables(_track(left, of), _track(right, of), slope)


def _track(segments: Segments, of: Mapping[str, TyreOnRoad]) -> Track:
    return Track(segments.start, tuple(number for name in segments.surface for number in of[name]))


@inlined
def find_road(y: Sequence[float], body: BodyConstants, step: Step, road: RoadTables, first: bool) -> None:
    """Set the tyre on the surface under each wheel, and gravity by the slope under the centre of mass.

    Every wheel looks at its own travelled distance, ahead of or behind the centre of mass by its place in the car. The
    `first` look-up of a period knows no segment to start from.
    """
    for axle in range(2):
        _look_under(y, body, step, road.left, 2 * axle, first)
        _look_under(y, body, step, road.right, 2 * axle + 1, first)
    slope, before = road.slope, 0 if first else int(step.slope_segment)
    rise, segment = interpolate(slope.distance, slope.grade, y[BODY_DISTANCE], before)
    side_rise, _ = interpolate(slope.distance, slope.side_slope, y[BODY_DISTANCE], segment)
    step.slope_segment = float(segment)
    step.gravity_x, step.gravity_y, step.gravity_z = gravity_on(rise, side_rise)


@inlined
def gravity_on(rise: float, side_rise: float) -> tuple[float, float, float]:
    """Gravity in the frame of a road [m/s^2] with a grade and a side slope [1]: along, to the left, and onto it."""
    onto = GRAVITY / sqrt(1.0 + rise * rise + side_rise * side_rise)
    return -rise * onto, -side_rise * onto, onto


@inlined
def gravity_at(slope: Slope, distance: float) -> tuple[float, float, float]:
    """The same at a travelled distance of the centre of mass [m]."""
    rise, segment = interpolate(slope.distance, slope.grade, distance, 0)
    side_rise, _ = interpolate(slope.distance, slope.side_slope, distance, segment)
    return gravity_on(rise, side_rise)


@inlined
def _look_under(y: Sequence[float], body: BodyConstants, step: Step, track: Track, i: int, first: bool) -> None:
    """Set the tyre of wheel i from its track, where it has come to another segment."""
    distance = y[DISTANCE + i] + body.wheel_x[i]
    if first:
        step.radius[i] = body.wheel_radius[i]
        found = max(number_until(track.start, distance) - 1, 0)
    else:
        before = int(step.segment[i])
        found = segment_at(track.start, distance, before)
        if found == before:
            return
    step.segment[i] = float(found)
    tyre, place = step.tyre[i], _WIDTH * found
    tyre.c0, tyre.c1, tyre.c2, tyre.c3 = (
        track.tyres[place],
        track.tyres[place + 1],
        track.tyres[place + 2],
        track.tyres[place + 3],
    )
    tyre.rolling_resistance, tyre.friction = track.tyres[place + 4], track.tyres[place + 5]
