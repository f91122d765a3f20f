"""The scenario of Tatar & Chudzik: axes of the car, sums, energy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers.source_runs import driven, value

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures import motion
from ev_stack.measures.handling import energy_since_turning_in, turning_in, tyre_force
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario

# Changes of F_y by the correction at 8.5 m/s [N]: an independent calculation with 100 N m and 50 %
# at pi/10.
EXPECTED = {
    "front": (-79.0, 31.0, 40.0, 36.0),
    "rear": (-42.0, -8.0, 42.0, 38.0),
    "all": (-39.0, 16.0, 20.0, 18.0),
}


def vehicle():
    return driven("tatar_chudzik").scenario.runs[0].configurations["plant"].common.vehicle


def change(kind: str, wheel: str, layout: str) -> float:
    corrected, equal = (
        value("tatar_chudzik", f"{kind}_{wheel}_{layout}_{c}") for c in ("corrected", "equal")
    )
    return corrected - equal


@pytest.mark.parametrize("layout", EXPECTED)
def test_correction_changes_the_forces_along_y_of_the_car(layout):
    """1 N: the expected changes are whole newtons, with the plant's transients beside."""
    found = [change("force_y", wheel, layout) for wheel in WHEEL_NAMES]
    assert found == pytest.approx(EXPECTED[layout], abs=1.0)


@pytest.mark.parametrize("layout", ["front", "all"])
def test_a_driven_front_wheel_tells_both_axes_apart(layout):
    """F_y = F_p sin d + F_b cos d.

    The outer front wheel rises in the car's axes and falls in its own.
    """
    assert change("force_y", "front_right", layout) > 10.0
    assert -10.0 < change("lateral_force", "front_right", layout) < -2.0


def test_forces_in_the_axes_of_the_car_add_up_to_its_acceleration():
    """M a_y, with a_y as the accelerometer sees it on a level road: to rounding."""
    run = driven("tatar_chudzik").runs["all_corrected"]
    total = sum(tyre_force(run, wheel, vehicle()).y for wheel in WHEEL_NAMES)
    assert total == pytest.approx(1000.0 * run.channels["imu.lateral_acceleration"], abs=1e-6)


def test_a_wheel_force_does_not_change_its_magnitude_between_the_axes():
    run = driven("tatar_chudzik").runs["front_equal"]
    x, y = tyre_force(run, "front_left", vehicle())
    along, across = (
        run.channels[f"tire_forces.{kind}_force.front_left"] for kind in ("longitudinal", "lateral")
    )
    assert np.hypot(x, y) == pytest.approx(np.hypot(along, across), rel=1e-12, abs=1e-9)


def test_correction_costs_tyre_force_and_saves_energy():
    """The outer wheel pushes the car round; the front wheels' backward force has less to do."""
    for layout in ("front", "rear", "all"):
        for quantity, sign in (
            ("total_tyre_force", 1),
            ("drive_energy", -1),
            ("time_to_speed", -1),
        ):
            equal = value("tatar_chudzik", f"{quantity}_{layout}_equal")
            assert (
                sign * (value("tatar_chudzik", f"{quantity}_{layout}_corrected") - equal)
                > 1e-3 * equal
            )


def test_drive_energy_until_turning_in_is_kinetic_energy_and_drag():
    """Within 1 %: slip of the tyres takes 0.4 %."""
    run = driven("tatar_chudzik").runs["rear_equal"]
    work = -energy_since_turning_in(run)[0]
    speed = run.channels["twist.longitudinal"][: turning_in(run) + 1]
    mass = 1000.0 + 4 * 0.2 / 0.2**2
    drag = 0.5 * 1.24 * 0.3 * 2.0 * float(np.sum(speed**3)) * 0.01
    assert work == pytest.approx(0.5 * mass * speed[-1] ** 2 + drag, rel=0.01)


def test_printed_wheel_inertia_halves_the_speed_before_the_bend():
    """Eq 1 as printed counts the mass twice.

    3.7 instead of 7.3 m/s after 15 s, 1/2.02 of it but for less drag.
    """
    changed = Overrides(values=[("*", "vehicle.printed_wheel_inertia", True)], duration=15.0)
    printed = next(
        run for run in load_scenario("tatar_chudzik", changed).runs if run.name == "all_equal"
    )
    slow = motion.path_speed(run_offline(printed.configurations, printed.duration))[-1]
    usual = driven("tatar_chudzik").runs["all_equal"]
    fast = motion.path_speed(usual)[turning_in(usual)]
    assert (slow, fast) == pytest.approx((3.7, 7.26), abs=0.05)
    ratio = (1000.0 + 4 * 5.0) / (1000.0 + 4 * (5.0 + 250.0))
    assert slow / fast == pytest.approx(ratio, rel=0.03) and math.isfinite(slow)
