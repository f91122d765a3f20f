"""The double lane change: its line fits every car, and the driver keeps to it.

The long form is `python benchmarks/lane_change.py`; docs/scenarios.md has its tables.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

import ev_stack

FILE = Path(__file__).parents[3] / "benchmarks" / "lane_change.py"


def loaded():
    spec = importlib.util.spec_from_file_location("lane_change", FILE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


lane_change = loaded()
# At 80 km/h the tyres of one have lost half their slope on the line (3.7 of 4.4 m/s^2); the other
# slides by 10 degrees. The third rolls softly, so that its understeer gradient at 4.4 m/s^2 is four
# times that at 2 m/s^2: it leaves the line by 15 cm and fells a cone at some distances of sight.
WITHOUT_GRIP = ("ge_ni2005", "zhileykin_4x4", "sedan")


def through_lanes(car: str, speeds: list[float], seen: float):
    return lane_change.passages(car, speeds, "preview", "preview.preview_time", seen)


@pytest.mark.sampled
@pytest.mark.parametrize("car", lane_change.CARS)
def test_no_car_touches_a_cone_at_walking_speed(car):
    """10 and 30 km/h: what is left is the line, not the tyres."""
    assert [each.cones for each in through_lanes(car, [10, 30], lane_change.AS_IT_COMES)] == [0] * 2


def test_cones_do_not_hang_on_the_speed():
    """No cone falls at any speed; a preview of 0.3 s and pure pursuit fells up to 4."""
    found = through_lanes("audi_a2", [20, 40, 75, 80, 85], lane_change.AS_IT_COMES)
    assert [each.cones for each in found] == [0] * 5


@pytest.mark.sampled
@pytest.mark.parametrize("car", [car for car in lane_change.CARS if car not in WITHOUT_GRIP])
def test_cones_do_not_hang_on_how_far_the_driver_sees(car):
    """80 km/h, seen 0.4 to 3 s ahead.

    No cone, and as far from the line within 5 cm (measured: 4 cm, of 9 or less).
    """
    found = [through_lanes(car, [80], seen)[0] for seen in (0.4, 1.0, 3.0)]
    assert [each.cones for each in found] == [0] * 3
    assert found[0].error == pytest.approx(found[2].error, abs=0.05)
    assert max(each.error for each in found) < 0.15


def test_the_car_turns_about_as_fast_as_its_line_bends():
    """The line's largest bend, 1/134 m, is 0.17 rad/s at 80 km/h.

    A quarter more, 0.21, is the tail. A car with its centre of mass held on a line is free to
    swing: omega^2 = L C_r/J_z, damped by zeta = omega b/(2 V), 0.31 at 80 km/h. It swings if the
    driver holds the line too firmly or does not know how late the wheels turn.
    """
    assert 0.16 < ev_stack.run("double_lane_change").metrics["peak_yaw_rate"].value < 0.23
