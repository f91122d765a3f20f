"""Closed courses: files, the line of least curvature, and the speed profile."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from ev_core.parameters.data_file import find_file
from ev_core.parameters.values import build
from ev_msgs_py.refusal import ParameterError
from ev_sim.courses.course import (
    CourseParameters,
    lengths_to_next,
    middle_of,
    normals,
    with_course_from_file,
)
from ev_sim.courses.racing_line import curvatures, racing_line, second_differences
from ev_sim.courses.speed_profile import LimitParameters, limits, speed_profile
from ev_stack.scenarios.files import vehicle_of

FILE = "courses/handling.csv"
TRACK = 1.53  # m
HANDLING = with_course_from_file(CourseParameters(file=FILE))
LINE = racing_line(HANDLING, TRACK)


def test_the_course_of_the_file_begins_at_the_origin_along_x_and_closes():
    """863 m, as the README of the courses has it; straight ahead at the line to 1 mm in 2 m."""
    middle = middle_of(HANDLING)
    assert middle[0].tolist() == [0.0, 0.0]
    assert middle[1] == pytest.approx([2.0, 0.0], abs=0.03)
    assert middle[-1] == pytest.approx([-2.0, 0.0], abs=0.03)
    assert lengths_to_next(middle).sum() == pytest.approx(863.0, abs=1.0)


def test_the_script_writes_the_course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("sys.argv", ["", str(tmp_path / "course.csv")])
    runpy.run_path(
        str(Path(__file__).parents[3] / "tools" / "handling_course.py"), run_name="__main__"
    )
    assert (tmp_path / "course.csv").read_text() == find_file(FILE).read_text()


def test_widths_that_differ_move_the_middle_of_the_road(tmp_path: Path):
    """A circle of 50 m, 2 m wide to the left and 6 m to the right.

    A road of 8 m around a circle of 52 m.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    rows = [f"{50.0 * np.cos(t)},{50.0 * np.sin(t)},2,6" for t in turn]
    path = tmp_path / "circle.csv"
    path.write_text("\n".join(["x_m,y_m,w_tr_left_m,w_tr_right_m", *rows]))
    course = with_course_from_file(CourseParameters(file=str(path)))
    assert set(course.width) == {8.0}
    assert 1.0 / curvatures(middle_of(course)) == pytest.approx(52.0, rel=1e-6)


def test_the_racing_line_stays_within_the_widths_and_bends_least():
    """Bounded least squares of scipy find the same sum of squared curvatures to 1e-6."""
    room = 0.5 * TRACK + HANDLING.clearance
    assert min(LINE.left.min(), LINE.right.min()) > room
    assert min(LINE.left.min(), LINE.right.min()) < room + 0.01  # it makes use of all of them
    middle, n = middle_of(HANDLING), len(HANDLING.x)
    before, at, behind = second_differences(middle)
    bent = np.zeros((n, n))
    for weight, place in ((before, -1), (at, 0), (behind, 1)):
        bent[np.arange(n), (np.arange(n) + place) % n] = weight
    across = normals(middle)
    a = np.concatenate([bent * across[:, i] for i in range(2)])
    b = -np.concatenate([bent @ middle[:, i] for i in range(2)])
    bound = 0.5 * np.array(HANDLING.width) - room
    best = lsq_linear(a, b, (-bound, bound), tol=1e-10)
    assert 0.5 * ((a @ LINE.offset - b) ** 2).sum() == pytest.approx(best.cost, rel=1e-6)
    assert 0.5 * (b**2).sum() > 1.2 * best.cost


def test_the_line_of_the_mirrored_course_is_the_mirrored_line():
    """Both lines agree to the bit, driven clockwise and anticlockwise."""
    other = racing_line(
        CourseParameters(x=HANDLING.x, y=tuple(-y for y in HANDLING.y), width=HANDLING.width), TRACK
    )
    assert (other.points == LINE.points * (1.0, -1.0)).all()
    assert (other.curvature == -LINE.curvature).all()


@given(
    bends=st.lists(st.floats(-0.15, 0.15), min_size=2, max_size=12),
    step=st.floats(0.5, 5.0),
    car=st.sampled_from(["compact_ev", "layout_1_8_c", "engine_4x4"]),
)
def test_the_speed_profile_never_leaves_the_friction_ellipse(
    bends: list[float], step: float, car: str
):
    """Both ends of every step are on or within it, with the drag on top of what drives the car.

    It ends at rest.
    """
    vehicle = vehicle_of(car)
    ellipse = limits(LimitParameters(), vehicle)
    curvature = np.repeat(bends, 10)
    squares = np.array(
        speed_profile(ellipse, vehicle, curvature.tolist(), [step] * (len(curvature) - 1))
    )
    along = np.diff(squares) / (2.0 * step)
    most = np.where(along > 0.0, ellipse.driving, ellipse.braking)
    for end in (slice(None, -1), slice(1, None)):
        across = squares[end] * np.abs(curvature[end]) / ellipse.lateral
        use = (along / most) ** 2 + across**2
        # slower ones are those of a car without drives
        assert (use[squares[:-1] > 2.0] <= 1.0 + 1e-9).all()
    assert squares[-1] == 0.0


def test_a_straight_is_driven_by_torque_then_power_then_brakes():
    """compact_ev from a hairpin of 10 m.

    First its front tyres, then its 120 kW, then 0.9 g of all tyres to brake.
    """
    vehicle, step = vehicle_of("compact_ev"), 1.0
    curvature = [0.1] * 3 + [0.0] * 500
    speed = np.sqrt(
        speed_profile(limits(LimitParameters(), vehicle), vehicle, curvature, [step] * 502)
    )
    # some of the friction goes against the drag
    assert speed[1] ** 2 == pytest.approx(9.81 / 0.1, rel=0.01)
    along = np.diff(speed**2) / (2.0 * step)
    assert along[5] == pytest.approx(0.8 * 9.81 * 0.55, rel=0.05)  # front tyres, less drag
    assert speed[200] * along[200] * 1600.0 == pytest.approx(0.97 * 120e3, rel=0.2)  # less drag
    assert along[-5] == pytest.approx(-0.9 * 9.81)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "x_m,y_m,left_m\n0,0,1\n",
            "no header with the columns x_m, y_m, one of left_m and w_tr_left_m",
        ),
        (
            "x_m,y_m,left_m,right_m\n0,0,3,3\n5,0,3,3\n",
            "2 points are no course, expected 12 to 5000",
        ),
        ("x_m,y_m,left_m,right_m\n0,zero,3,3\n", "line 2: y_m is no finite number"),
        ("", "no header with the columns"),
    ],
)
def test_a_bad_file_is_one_line(tmp_path: Path, text: str, line: str):
    path = tmp_path / "course.csv"
    path.write_text(text)
    refused = refusal_of(path)
    assert refused.startswith(f"course.file: {path}: ")
    assert line in refused


@pytest.mark.parametrize(
    ("spoilt", "line"),
    [
        ({7: "0.0,0.0,3,3"}, "point 8 is "),
        ({7: "1e300,0.0,3,3"}, "parameter x: "),
        ({7: "31.0,41.0,-1,3"}, "point 8: a width of -1 m is refused, expected 0 or more"),
        (dict.fromkeys(range(20, 40), ""), "the first one, with which it closes, is "),
        (
            dict.fromkeys(range(40)),
            "edge runs backwards, the road is wider than its bend has room for",
        ),
    ],
)
def test_points_that_are_no_course_are_one_line(
    tmp_path: Path, spoilt: dict[int, str | None], line: str
):
    """A circle of 30 m with a jump, a negative width, no end, or too wide a road is refused."""
    path, rows = tmp_path / "course.csv", []
    for n in range(40):
        turn = 2.0 * np.pi * n / 40
        point = f"{30.0 * np.cos(turn)},{30.0 * np.sin(turn)}"
        row = spoilt.get(n, f"{point},3,3")
        rows.append(f"{point},35,3" if row is None else row)
    path.write_text("\n".join(["x_m,y_m,left_m,right_m", *rows]))
    assert line in refusal_of(path)


def test_a_road_narrower_than_the_car_is_refused():
    narrow = build(CourseParameters, {"width": [2.0] * 24})
    with pytest.raises(
        ParameterError, match=r"course: the road is 2 m wide at point 1, expected more than 2\.33 m"
    ):
        racing_line(narrow, TRACK)


def test_a_header_behind_a_hash_and_a_last_point_that_repeats_the_first_are_read(tmp_path: Path):
    """Files of racetrack-database and of others have both; a quote in a comment changes nothing.

    The one of two headers without a hash counts.
    """
    rows = []
    for n in range(41):
        turn = 2.0 * np.pi * (n % 40) / 40
        rows.append(f"{30.0 * np.cos(turn):.6f},{30.0 * np.sin(turn):.6f},3,4")
    found = []
    for head, body in (
        ("x_m,y_m,w_tr_right_m,w_tr_left_m", rows[:-1]),
        ('# a "circle\n# x_m,y_m,w_tr_right_m,w_tr_left_m', rows[:-1]),
        ("# x_m,y_m,w_tr_left_m,w_tr_right_m\nx_m,y_m,w_tr_right_m,w_tr_left_m", rows[:-1]),
        ("x_m,y_m,w_tr_right_m,w_tr_left_m", rows),
    ):
        (tmp_path / "circle.csv").write_text("\n".join([head, *body]))
        found.append(with_course_from_file(CourseParameters(file=str(tmp_path / "circle.csv"))))
    assert len(found[0].x) == 40
    assert found[0] == found[1] == found[2] == found[3]
    (tmp_path / "circle.csv").write_text("\n".join(["x_m;y_m;w_tr_right_m;w_tr_left_m", *rows]))
    assert "line 1: columns are separated by ';', expected ','" in refusal_of(
        tmp_path / "circle.csv"
    )


def refusal_of(path: Path) -> str:
    """The one line with which a file is refused."""
    with pytest.raises(ParameterError) as refused:
        with_course_from_file(CourseParameters(file=str(path)))
    assert "\n" not in str(refused.value)
    return str(refused.value)
