"""The path of a driver: its points and the distance along it."""

from __future__ import annotations

import math

import pytest

from ev_core.parameters.values import build
from ev_msgs_py.refusal import ParameterError
from ev_sim.driver.path import PathParameters, nearest, path_of, point_at


def test_path_of_arcs_and_its_nearest_point():
    """A quarter of a circle of 10 m ends at (10, 10).

    The chords of half a metre stay within 4 mm of it.
    """
    arcs = {"shape": "arcs", "length": [5 * math.pi], "curvature": [0.1]}
    path = path_of(build(PathParameters, arcs))
    assert point_at(path, 5 * math.pi, 0) == pytest.approx((10.0, 10.0), abs=0.02)
    distance, _ = nearest(path, 10 * math.sin(0.5), 10 - 10 * math.cos(0.5), 0)
    assert distance == pytest.approx(5.0, abs=0.01)
    # straight on before the beginning
    assert nearest(path, -3.0, 0.0, 0)[0] == pytest.approx(-3.0, abs=0.1)


# 10 m to the east, then 10 m to the north.
CORNER = path_of(PathParameters(x=(0.0, 10.0, 10.0), y=(0.0, 0.0, 10.0)))


@pytest.mark.parametrize("leg", [0, 1])
@pytest.mark.parametrize(
    ("point", "distance", "reached"),
    [
        ((4.0, -1.0), 4.0, 0),
        ((-5.0, -1.0), -5.0, 0),  # straight on before the beginning
        ((12.0, 7.0), 17.0, 1),
        ((11.0, 25.0), 35.0, 1),  # and behind the end
    ],
)
def test_nearest_point_is_found_from_every_leg(leg, point, distance, reached):
    assert nearest(CORNER, *point, leg) == (distance, reached)


def test_outside_of_a_corner_the_corner_is_nearest():
    """Past the end of the first leg, before the beginning of the second: 10 m along the path."""
    assert nearest(CORNER, 11.0, -1.0, 0)[0] == nearest(CORNER, 11.0, -1.0, 1)[0] == 10.0


@pytest.mark.parametrize("leg", [0, 1])
@pytest.mark.parametrize(
    ("distance", "point"),
    [(-5.0, (-5.0, 0.0)), (10.0, (10.0, 0.0)), (13.0, (10.0, 3.0)), (30.0, (10.0, 20.0))],
)
def test_point_at_a_distance_is_found_from_every_leg(leg, distance, point):
    assert point_at(CORNER, distance, leg) == point


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"x": [0.0, 1.0]}, None),
        ({"x": [0.0], "y": [0.0]}, "x and y need the same number of elements, at least two"),
        ({"x": [1.0, 1.0], "y": [2.0, 2.0]}, "x and y repeat a waypoint"),
        (
            {"length": [1.0, 2.0]},
            "length and curvature need the same number of elements, at least one",
        ),
    ],
)
def test_bad_paths_are_refused(values, message):
    if message is None:
        assert build(PathParameters, values) == PathParameters()
    else:
        with pytest.raises(ParameterError, match=message):
            build(PathParameters, values)
