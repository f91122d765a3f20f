"""Traction controls that lose wheel speeds while the car pulls away on snow (docs/faults.md)."""

from __future__ import annotations

import pytest
from helpers.launches import launch
from helpers.traction import FRONT, in_regulator

pytestmark = pytest.mark.slow

SPEED, BEGIN = "wheel_states.velocity", 2.5
FREE = {
    "dead": (f"constant {SPEED}.rear_left 0",),
    "both dead": (f"constant {SPEED}.rear_left 0", f"constant {SPEED}.rear_right 0"),
    "stuck": (f"frozen {SPEED}.rear_left",),
    "scaled": (f"scaled {SPEED}.rear_left 2",),
}


def end_speed(law: str, faults: tuple[str, ...], watch: bool) -> tuple[float, list[float]]:
    """Speed [m/s] and front torques [N m] 2.5 s after faults of front-driven wheels."""
    more = (
        ("*", "vehicle.driven_wheels", FRONT),
        ("asr", in_regulator(law, "reference.trust.watch"), watch),
        ("plant", "faults", tuple(f"{fault} from {BEGIN}" for fault in faults)),
    )
    channels = launch(law, ("packed_snow_1",), 3000.0, 1.0, 5.0, more=more)
    torques = [float(channels[f"torque_command.drive.{wheel}"][-200:].mean()) for wheel in FRONT]
    return float(channels["twist.longitudinal"][-1]), torques


@pytest.mark.parametrize("law", ["slip_window", "least_squares", "pi_slip"])
def test_a_free_wheel_that_lies_costs_nothing_where_wheel_speeds_are_watched(law):
    """Within 3 %: the accelerometer alone knows the speed less well.

    Without the watch a dead sensor stops the car.
    """
    sound, torques = end_speed(law, (), watch=False)
    # nothing is lost by mistake, to the bit
    assert end_speed(law, (), watch=True) == (sound, torques)
    assert end_speed(law, FREE["dead"], watch=False)[0] < 0.2 * sound
    for faults in FREE.values():
        assert end_speed(law, faults, watch=True)[0] > 0.97 * sound


def test_a_driven_wheel_without_sensors_gets_what_its_partner_gets():
    """Its limit is open without the watch, and it spins with all that is asked for."""
    dead = (f"constant {SPEED}.front_left 0",)
    (blind, limited), (spared, same) = (
        end_speed("slip_window", dead, watch)[1] for watch in (False, True)
    )
    assert blind == 1500.0 > 1.5 * limited
    assert spared == pytest.approx(same, rel=0.01)
