"""Courses: lanes of a scenario, and which cars pass them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ev_stack
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.refusal import ParameterError
from ev_sim.driver.off_path import distances_from
from ev_sim.driver.path import PathParameters, path_of
from ev_stack.manoeuvres.double_lane_change import is_over, passed
from ev_stack.measures.course import Course, edges, hit_cones
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import report_for

SLALOM = Course("Slalom", (0.0, 20.0), (10.0, 30.0), (0.0, -3.0), width_margin=(3.0, 3.0))
ROAD = {"driver": {"path.x": [-10.0, 50.0], "path.y": [0.0, 0.0], "path.width": 8.0}}


def driven(*points: tuple[float, float], end: float = 40.0) -> Recording:
    """Motion along x at 10 m/s, aside from point to point."""
    x = np.linspace(-10.0, end, 501)
    zero = np.zeros(501)
    channels = {
        "pose.x": x, "pose.y": np.interp(x, *zip(*points, strict=True)), "pose.orientation_z": zero,
        "pose.orientation_w": zero + 1, "twist.longitudinal": zero + 10, "twist.lateral": zero,
        "imu.yaw_rate": zero, "imu.longitudinal_acceleration": zero, "imu.lateral_acceleration": zero,
        "steering_column.state.angle": zero,
    }  # fmt: skip
    return Recording((x + 10.0) / 10.0, channels)


def judged(run: Recording, course: Course = SLALOM) -> tuple:
    found = report_for("double_lane_change").metrics({"mine": run}, Vehicle(), ROAD, course)
    return found["course_passed"].value, found["cones_hit"].value, found["cones_hit"].verdict


LOOKS = range(1, 451, 25)  # the samples before the end of a course of 35 m
CLEAN = ((13.0, 0.0), (17.0, -3.0))
MIRRORED = ((13.0, 0.0), (17.0, 3.0))


def test_a_car_that_stays_in_the_lanes_passes_on_either_side():
    assert judged(driven(*CLEAN)) == judged(driven(*MIRRORED)) == (1.0, 0, "measured")


def test_a_car_that_touches_a_cone_does_not_pass():
    """A body 0.8 m aside, 0.82 m to each side, reaches over cones at 1.5 m."""
    assert judged(driven((13.0, 0.8), (17.0, -3.0)))[:2] == (0.0, 4)


@given(offset=st.floats(-0.5, 0.5), aside=st.floats(-1.0, 1.0), turned=st.floats(-0.5, 0.5))
def test_the_body_lies_around_the_middle_of_the_car_not_around_its_centre_of_mass(
    offset, aside, turned
):
    """A centre of mass left of the middle puts the body as far to the right of the path."""
    cosine, sine = np.cos(turned), np.sin(turned)
    body, mass = (
        driven((13.0, aside), (17.0, aside - 3.0)),
        driven((13.0, aside), (17.0, aside - 3.0)),
    )
    for run in (body, mass):
        run.channels["pose.orientation_z"] += np.sin(turned / 2)
        run.channels["pose.orientation_w"] += np.cos(turned / 2) - 1.0
    mass.channels["pose.x"] -= offset * sine
    mass.channels["pose.y"] += offset * cosine
    car = Vehicle(centre_of_mass_offset=offset)
    for one, other in zip(edges(mass, car, SLALOM), edges(body, Vehicle(), SLALOM), strict=True):
        assert np.allclose(one, other, atol=1e-9)
    differ = hit_cones(mass, car, SLALOM) != hit_cones(body, Vehicle(), SLALOM)
    assert differ.sum() <= 1  # a cone at the very edge, to rounding


def test_a_car_that_has_left_the_road_has_not_passed_it_cleanly():
    """A car 4 m aside at 14.8 m, where no cone stands, is not clean with 0 cones."""
    astray = driven((13.0, 0.0), (17.0, 9.0))
    assert judged(astray) == (0.0, None, "not measured: the car left the road at 2.48 s")


def test_a_car_beside_a_lane_has_not_passed_it():
    """3 m aside on the road, beside the second lane, which begins at 20 m, and its cones."""
    assert judged(driven((13.0, 0.0), (17.0, 0.0))) == (
        0.0,
        None,
        "not measured: the car left its lane at 3.00 s",
    )


def test_between_the_lanes_the_road_counts():
    """A way of 5 m aside on a road of 8 m between two lanes that the car passes: 4 m at 10 m."""
    course = Course("", (-5.0, 30.0), (0.0, 35.0), width_margin=(3.0, 3.0))
    astray = [(2.0, 0.0), (12.0, 5.0), (22.0, 5.0), (27.0, 0.0)]
    assert judged(driven(*astray), course) == (
        0.0,
        None,
        "not measured: the car left the road at 2.01 s",
    )
    assert judged(driven(*((x, 0.7 * y) for x, y in astray)), course)[0] == 1.0


def test_a_run_that_ends_on_the_course_is_not_judged_but_one_that_has_failed_is():
    assert judged(driven(*CLEAN, end=25.0)) == (
        None,
        None,
        "not measured: the end of the course never comes",
    )
    assert judged(driven((0.0, 9.0), end=25.0))[0] == 0.0


def test_a_scenario_without_a_course_gets_no_foreign_cones(tmp_path):
    """It has its own title, and the cones of the report's scenario are not counted."""
    (tmp_path / "single_lane_change.yaml").write_text(
        "/**/scenario:\n  ros__parameters: {duration: 2.0, report: double_lane_change}\n"
        "/**/plant:\n  ros__parameters: {method: planar, initial_speed: 80 km/h}\n"
        "/**/driver:\n  ros__parameters:\n    method: preview\n    speed_profile: {time: [0.0], speed: [22.2]}\n"
        "    path: {x: [-50.0, 10.0, 30.0, 100.0], y: [0.0, 0.0, 3.0, 3.0]}\n"
    )
    result = ev_stack.run(tmp_path / "single_lane_change.yaml")
    assert result.metrics["cones_hit"].verdict.startswith(
        "not measured: the scenario has no course: "
    )
    assert result.metrics["peak_yaw_rate"].value > 0.0
    (axes,) = result.figures()["course"].axes
    assert axes.get_title(loc="left").startswith("single lane change")
    assert "cones" not in axes.get_legend_handles_labels()[1]


@pytest.mark.parametrize(
    ("lanes", "message"),
    [
        ({"begin": (0.0, 20.0), "end": (10.0,)}, "end has 1 values, expected 2 as begin has"),
        (
            {"begin": (0.0,), "end": (10.0,), "gap": (0.0, 1.0)},
            "gap has 2 values, expected 1 as begin has",
        ),
        (
            {"begin": (0.0, 5.0), "end": (10.0, 20.0), "width_margin": (1.0, 1.0)},
            "begin and end do not rise, ",
        ),
        ({"begin": (0.0,), "end": (0.0,), "width_margin": (1.0,)}, "begin and end do not rise, "),
        ({"begin": (0.0,), "end": (10.0,)}, "a lane has no width, expected "),
    ],
)
def test_lanes_that_make_no_sense_are_refused(lanes, message):
    with pytest.raises(ParameterError, match=f"^{message}"):
        Course(**lanes)


def test_a_run_over_before_the_end_has_not_passed_whatever_comes():
    """Wavy ways, looked at each 2.5 m.

    Some lanes aside reach across the middle, where a car may be on either side.
    """
    random, judgements = np.random.default_rng(1), set()
    for _ in range(200):
        widths = tuple(random.uniform(2.0, 6.0, 2).tolist())
        course = Course(
            "",
            (0.0, 15.0),
            (10.0, 35.0),
            (0.0, random.uniform(-2.0, 2.0)),
            width_margin=widths,
            cones=2,
        )
        run = driven(
            (10.0, 0.0), *zip((16.0, 20.0, 25.0), random.uniform(-2.0, 2.0, 3), strict=True)
        )
        parts = (
            Recording(run.time[:n], {of: values[:n] for of, values in run.channels.items()})
            for n in LOOKS
        )
        over = next((part for part in parts if is_over(part, 0, Vehicle(), None, course)), run)
        has_passed = passed(run, Vehicle(), None, course)
        assert passed(over, Vehicle(), None, course) == has_passed
        judgements.add((over is run, has_passed))
    assert judgements == {(False, False), (True, False), (True, True)}


def test_distances_from_a_path():
    """Beside a leg, beside a corner, and beyond both ends, where it goes on straight."""
    path = path_of(PathParameters(x=(0.0, 10.0, 10.0), y=(0.0, 0.0, 10.0)))
    x, y = np.array([5.0, 13.0, -7.0, 12.0]), np.array([2.0, -4.0, 1.0, 30.0])
    assert distances_from(path, x, y).tolist() == [2.0, 5.0, 1.0, 2.0]
