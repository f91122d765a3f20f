"""A driver at the limit on a closed course.

Clean, as fast as planned, mirrored to the bit, at rest in the end.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures.laps import laps_begun, leaves, line_of
from ev_stack.measures.named import DrivenRun, driven_run
from ev_stack.measures.registry import METRICS
from ev_stack.recording.offline import run_offline, true_motion
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, load_scenario


def driven(
    duration: float | None = None, vehicle: str | None = None, **values: object
) -> DrivenRun:
    """The scenario with other values of the driver and the plant, their dots as two underscores."""
    changed = [(*name.replace("__", ".").split(".", 1), value) for name, value in values.items()]
    run = load_scenario("lap", Overrides(values=changed, duration=duration, vehicle=vehicle)).runs[
        0
    ]
    return driven_run(
        true_motion(run_offline(run.configurations, run.duration), run.configurations),
        run.configurations,
    )


def measured(run: DrivenRun, name: str) -> float:
    """The value of a metric, which has one."""
    found = METRICS[name].measured(run)
    assert found.value is not None, found.reason
    return found.value


@pytest.fixture(scope="module")
def lap() -> DrivenRun:
    return driven()


def test_a_lap_is_driven_on_the_line_and_then_the_car_stands(lap: DrivenRun):
    """863 m from rest, the time as of today within 1 %.

    The error is within the clearance of 0.4 m from the edges.
    """
    assert measured(lap, "lap_time") == pytest.approx(49.9, abs=0.5)
    assert measured(lap, "path_error") < 0.25
    assert 0.4 < measured(lap, "mean_friction_use") < measured(lap, "high_friction_use") < 1.0
    channels = lap.signals.channels
    assert abs(channels["twist.longitudinal"][-1]) < 1e-3
    assert channels["driver.command.drive_torque"][-1] == 0.0


def test_the_time_of_a_slower_lap_is_longer_by_the_scale(lap: DrivenRun):
    """Speeds in proportion: within 3 %, for launch and power do not scale."""
    slow = driven(duration=75.0, driver__limit__scale=0.65)
    assert measured(slow, "lap_time") == pytest.approx(
        measured(lap, "lap_time") * 0.85 / 0.65, rel=0.03
    )


def test_the_small_racing_car_laps_on_its_tyres_from_the_rig():
    """863 m at a mean of more than 16 m/s, the scale below that of its default."""
    assert measured(driven(60.0, "racing_car", driver__limit__scale=0.8), "lap_time") < 863.0 / 16.0


def test_too_fast_a_car_leaves_the_course():
    """Speeds 1.3 times those of a point mass on this friction."""
    run = driven(duration=25.0, driver__limit__scale=1.3)
    reason = METRICS["lap_time"].measured(run).reason
    assert reason.startswith("the car left the course at ")


def test_a_lap_the_other_way_round_is_the_mirror_image():
    """Both laps mirror to the bit where forces left and right are alike.

    8 s, into the first bend.
    """
    course = driven(duration=0.1).course
    assert course is not None
    other = {"driver__course__y": [-y + 0.0 for y in course.y]}
    one, image = (
        driven(
            8.0,
            driver__course__file="",
            driver__course__x=list(course.x),
            driver__course__width=list(course.width),
            **more,
        ).signals.channels
        for more in ({"driver__course__y": list(course.y)}, other)
    )
    for name, sign in (
        ("pose.x", 1.0),
        ("pose.y", -1.0),
        ("twist.yaw_rate", -1.0),
        ("driver.command.drive_torque", 1.0),
    ):
        assert (one[name] == sign * image[name]).all(), name


def test_the_hottest_winding_counts(lap: DrivenRun):
    channels = {
        f"motor_temperatures.winding.{wheel}": np.full(3, float(n))
        for n, wheel in enumerate(WHEEL_NAMES)
    }
    run = lap._replace(signals=Recording(np.arange(3.0), channels))
    assert measured(run, "peak_winding_temperature") == 3.0


def test_a_car_that_cuts_across_leaves_the_course(lap: DrivenRun):
    """A car is off the course on another part of it for some seconds, and between both.

    Pieces of the run show it as well: each begins with the last sample of the one before.
    """
    channels = dict(lap.signals.channels)
    for name in ("pose.x", "pose.y"):
        channels[name] = np.where(lap.signals.time > 40.0, channels[name][2500], channels[name])
    cut = lap._replace(signals=Recording(lap.signals.time, channels))
    assert METRICS["lap_time"].measured(cut).reason == "the car left the course at 40.01 s"
    assert leaves(cut.signals.part(4000), cut.vehicle, cut.course) == 40.01


@pytest.mark.parametrize("crossing", [0, 1], ids=["first", "last"])
def test_a_car_that_goes_back_across_the_line_begins_no_lap_once_more(
    lap: DrivenRun, crossing: int
):
    """The lap is that without reversing 5 samples behind the line, or longer by the way back."""
    signals, line = lap.signals, line_of(lap.course, lap.vehicle).points[0]
    far = np.hypot(signals.channels["pose.x"] - line[0], signals.channels["pose.y"] - line[1])
    at = far[:1000].argmin() if crossing == 0 else 1000 + far[1000:].argmin()
    order = np.concatenate(
        (np.arange(at + 5), np.arange(at + 5, at - 5, -1), np.arange(at - 5, len(far)))
    )
    channels = {name: values[order] for name, values in signals.channels.items()}
    back = lap._replace(signals=Recording(signals.time[1] * np.arange(len(order)), channels))
    assert laps_begun(back.signals, back.vehicle, back.course) == 2
    more = 0.2 if crossing == 0 else 0.0  # s, 20 samples
    assert measured(back, "lap_time") == pytest.approx(measured(lap, "lap_time") + more, abs=1e-6)


def eight(folder: Path) -> str:
    """A figure of eight, 300 m around, that crosses itself at right angles in its first point.

    7 m wide.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
    x, y = 50.0 * np.sin(turn), 50.0 * np.sin(turn) * np.cos(turn)
    rows = [f"{a:.4f},{b:.4f},3.5,3.5" for a, b in zip(x, y, strict=True)]
    (folder / "eight.csv").write_text("\n".join(["x_m,y_m,left_m,right_m", *rows]) + "\n")
    return str(folder / "eight.csv")


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
def test_an_own_course_is_lapped_as_documented_even_where_it_crosses_itself(tmp_path, side):
    """The file alone is enough.

    The car starts on its racing line, the run lasts until it stands, and no lap is cut.

    Nor does the crossing, which is at the line of the lap, count as a lap or as leaving the course.
    """
    file = Path(eight(tmp_path))
    head, *rows = file.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    file.write_text(
        "\n".join([head, *(f"{x},{side * float(y)},{le},{ri}" for x, y, le, ri in cells)]) + "\n"
    )
    run = driven(driver__course__file=str(file), driver__limit__scale=0.6)
    line = line_of(run.course, run.vehicle)
    assert leaves(run.signals, run.vehicle, run.course) is None
    assert laps_begun(run.signals, run.vehicle, run.course) == 2
    channels = run.signals.channels
    start = np.array((channels["pose.x"][0], channels["pose.y"][0]))
    assert np.hypot(*(start - line.points[0])) == pytest.approx(6.0, abs=0.1)
    assert measured(run, "lap_time") > line.step.sum() / 20.0  # m/s, more than it drives anywhere
    assert measured(run, "path_error") < 0.3
    assert abs(channels["twist.longitudinal"][-1]) < 1e-3


def test_a_part_of_a_lap_that_begins_at_the_crossing_is_on_its_own_part_of_the_course(tmp_path):
    """A board looks at parts of a run, which begin anywhere.

    None of a lap that stays on the course leaves it.
    """
    run = driven(driver__course__file=eight(tmp_path), driver__limit__scale=0.6)
    far = np.hypot(run.signals.channels["pose.x"], run.signals.channels["pose.y"])
    near = np.flatnonzero(far < 6.0)[::10]
    assert len(near) > 10
    for begin in near.tolist():
        part = run.signals.part(begin)
        assert leaves(part, run.vehicle, run.course) is None, run.signals.time[begin]


def test_a_start_that_is_given_stays(tmp_path):
    run = driven(0.1, plant__initial_x=-10.0, plant__initial_y=-1.0, plant__initial_heading=0.0)
    assert run.signals.channels["pose.x"][0] == -10.0
    assert run.signals.channels["pose.y"][0] == -1.0


def test_a_small_course_is_begun_at_its_line(tmp_path):
    """A circle of 10 m, from the origin, beside its racing line.

    The car is on the road, also for its driver.
    """
    turn = 2.0 * np.pi * np.arange(31) / 31
    rows = [f"{10.0 * np.sin(t)},{10.0 * (1.0 - np.cos(t))},3,3" for t in turn]
    (tmp_path / "circle.csv").write_text("\n".join(["x_m,y_m,left_m,right_m", *rows]))
    start = {"plant__initial_x": 0.0, "plant__initial_y": 0.0, "plant__initial_heading": 0.0}
    run = driven(
        20.0, driver__course__file=str(tmp_path / "circle.csv"), driver__limit__scale=0.6, **start
    )
    assert leaves(run.signals, run.vehicle, run.course) is None
