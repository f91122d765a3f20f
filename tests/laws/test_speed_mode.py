"""Slip control by speed set-points for drives in speed mode (dissertation, sections 1.4 and 2.4)."""

from __future__ import annotations

import dataclasses

import pytest
from traction import CAR, PERIOD, SPEED_MODE, SPINNING, Control, Measured, spinning_at, swapped

from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.lockstep.configuration import configure
from ev_msgs_py.lockstep.graph_check import check_graph
from ev_msgs_py.parameters.declaration import ParameterError

FASTEST = CAR.motor.maximum_speed / CAR.gear_ratio  # rad/s
FREE = Wheels.all(FASTEST)


def at_slip(slip: float) -> Measured:
    """Both front wheels at this slip, over a car that rolls at 20 rad/s."""
    return dataclasses.replace(SPINNING, speed=Wheels(20.0 / (1.0 - slip), 20.0 / (1.0 - slip), 20.0, 20.0))


@pytest.mark.parametrize("name", SPEED_MODE)
def test_set_points_are_out_of_reach_but_for_wheels_that_slip(name):
    """Rolling, released, braked and regenerating wheels: the largest speed of the motor, in the request's direction.

    Torques pass always. In reverse and in the mirror all is as forwards, to the bit; corridors differ in reverse.
    """
    law, mirror, reverse = Control(name), Control(name), Control(name)
    assert law.set_points(dataclasses.replace(SPINNING, speed=Wheels.all(10.0))) == FREE
    lowest = FASTEST
    for n in range(40):
        m = spinning_at(10.0 + n, 10.0 + 0.01 * n)
        speeds = law.set_points(m)
        assert mirror.set_points(m.mirrored()) == swapped(speeds)
        if name != "speed_corridor":
            reverse.set_points(m.reversed())
        lowest = min(lowest, speeds.front_left)
    assert 10.0 < lowest < 12.0  # above rolling: a lower one would be a drive without torque
    assert speeds[1:] == FREE[1:]
    assert reverse.limits() == law.limits() or name == "speed_corridor"
    braked = dataclasses.replace(SPINNING, brake=Wheels.all(100.0))
    assert law.set_points(braked) == FREE
    assert law.set_points(dataclasses.replace(SPINNING, drive=NO_WHEELS)) == FREE
    assert law.set_points(Measured(Wheels.front(-500.0, -500.0), speed=Wheels.all(20.0))).front_left == -FASTEST


def test_slip_beyond_the_range_lowers_the_set_point_and_slip_below_raises_it():
    """Principle 2, from the speed of the wheel on: 1 rad/s in each step of 5 ms down, 0.3 up, none inside the range."""
    law = Control("speed_by_slip")
    slips = (0.16, 0.25, 0.25, 0.17, 0.1, 0.1)
    speeds = [law.set_points(at_slip(slip)).front_left for slip in slips]
    first = 20.0 / 0.75 - 200.0 * PERIOD
    rise = 60.0 * PERIOD
    expected = [FASTEST, first, first - 1.0, first - 1.0, first - 1.0 + rise, first - 1.0 + 2 * rise]
    assert speeds == pytest.approx(expected, rel=1e-12)


def test_set_point_ends_when_the_drive_has_given_the_request_for_a_while():
    """For 0.2 s; a torque below 95 % of it begins the time anew."""
    law = Control("speed_by_slip")
    law.set_points(at_slip(0.25))
    gives, lacks = at_slip(0.1), dataclasses.replace(at_slip(0.1), torque=Wheels.front(1400.0, 1400.0))
    for m in [*[gives] * 30, lacks, *[gives] * 39]:
        assert law.set_points(m).front_left < FASTEST
    assert [law.set_points(gives).front_left for _ in range(3)][-1] == FASTEST


def test_ratio_of_accelerations_lowers_the_set_point():
    """Principle 1: a_x/w' = 1/100 m is far below the threshold of 0.16 m, 1/5 m above it: then the set-point rises."""
    law = Control("speed_by_acceleration_ratio", **{"criterion.filter_time": 0.0})
    law.set_points(spinning_at(12.0, 10.0))
    lowered = law.set_points(spinning_at(12.0 + 100.0 * PERIOD, 10.0)).front_left
    assert lowered == pytest.approx(12.5 - 200.0 * PERIOD, rel=1e-12)
    raised = law.set_points(spinning_at(12.5 + 5.0 * PERIOD, 10.0)).front_left
    assert raised == pytest.approx(lowered + 60.0 * PERIOD, rel=1e-12)


CORRIDORS = [("road", 0.05, 0.15), ("sport", 0.1, 0.22), ("winter", 0.03, 0.1), ("terrain", 0.2, 0.4)]


@pytest.mark.parametrize(("regime", "low", "high"), CORRIDORS)
def test_corridor_of_the_regime_decides(regime, low, high):
    """Speeds over rolling just above, inside and just below the corridor: the set-point falls, stays, rises."""
    law, speeds = Control("speed_corridor", regime=regime), []
    for share in (high + 0.01, high + 0.01, (low + high) / 2.0, low - 0.01):
        m = spinning_at(10.0 * (1.0 + share), 10.0)
        speeds.append(law.set_points(m).front_left)
    assert speeds[0] >= speeds[1] == speeds[2] < speeds[3] < FASTEST


def test_reverse_has_its_own_corridor():
    """0.12 over rolling is inside the corridor of the regime road, and above that of reverse."""
    m = spinning_at(11.2, 10.0)
    assert Control("speed_corridor").set_points(m) == FREE
    law = Control("speed_corridor")
    law.set_points(m.reversed())
    assert law.set_points(m.reversed()).front_left > -12.0


def test_drives_in_torque_mode_are_refused():
    """They would take no notice of the set-points; and drives in speed mode need somebody who sets them."""

    def refused(plant: str, asr: str) -> str:
        chosen = {role: configure(role, {}) for role in REQUIRED}
        chosen |= {"plant": configure("plant", {"method": plant}), "asr": configure("asr", {"method": asr})}
        with pytest.raises(ParameterError) as error:
            check_graph(chosen)
        return str(error.value)

    assert "requires plant method planar_speed_mode, but planar is chosen" in refused("planar", "speed_by_slip")
    assert "reads WheelSpeedCommand, which none of the chosen" in refused("planar_speed_mode", "off")
