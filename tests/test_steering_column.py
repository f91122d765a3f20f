"""Steering columns: eq 3 of Shchur (2019), dry friction with a real stick phase, end stops."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.methods import find_method
from ev_msgs_py.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, Wheels
from ev_sim.steering_column.by_wire import ByWireColumn
from ev_sim.steering_column.friction_oscillator import FrictionOscillator
from ev_sim.steering_column.manual import ManualColumn
from ev_sim.steering_column.powered import PoweredColumn

CAR = Vehicle()
J, B, K = 2.8, 7.5, 65.0
RATIO = 16.0
LEVER = 1.462 / (2 * 0.294)  # d/(2 r_k)
FAR = 1e6  # an end stop that is never reached [rad]


def at_rest(difference: float = 0.0, speed_difference: float = 0.0) -> WheelStates:
    """Wheels with a torque [N m] and a speed [rad/s] difference of the front wheels, right minus left."""
    return WheelStates(
        NO_WHEELS,
        Wheels.front(-speed_difference / 2, speed_difference / 2),
        Wheels.front(-difference / 2, difference / 2),
    )


def hands(torque: float) -> DriverCommand:
    return DriverCommand(0.0, 0.0, torque)


def column_of(kind: type, period: float = 0.001, **changed: float):
    return kind(dataclasses.replace(kind.parameters(), **changed), CAR, period)


def advance(column, hand_torque: float = 0.0, wheels: WheelStates | None = None) -> SteeringColumnState:
    if isinstance(column, ManualColumn):
        column.advance(hands(hand_torque))
    else:
        column.advance(hands(hand_torque), wheels or at_rest())
    return column.outputs()[0]


def energy(angle: float, rate: float) -> float:
    return J * rate**2 / 2 + K * angle**2 / 2


@pytest.mark.parametrize("name", ["manual", "powered", "by_wire"])
def test_columns_are_registered_and_start_at_rest(name):
    column = find_method("steering_column", name)
    assert column.factory(column.parameters(), CAR, 0.01).outputs() == (SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0),)


@pytest.mark.parametrize("kind", [ManualColumn, PoweredColumn])
def test_step_of_hand_torque_is_the_exact_step_response(kind):
    """Eq 6 with M_b = 5 N m by scipy. The steps are exact at any period, so only rounding is left."""
    for period in (0.001, 0.01):
        column = column_of(kind, period)
        time = np.arange(round(10 / period) + 1) * period
        angle = [0.0] + [advance(column, 5.0).road_wheel_angle for _ in time[1:]]
        _, exact = scipy.signal.step(scipy.signal.TransferFunction([RATIO * 5.0], [J, B, K]), T=time)
        assert angle == pytest.approx(exact, abs=1e-10)


def test_object_reaches_the_values_that_follow_from_the_paper():
    """Fig 1a, curve 1: steady 1.2308 rad (5 i/k_p), overshoot 40.3 %; the bands are those of the other values."""
    column = column_of(ManualColumn)
    angle = np.array([advance(column, 5.0).road_wheel_angle for _ in range(15000)])
    assert angle[-1] == pytest.approx(1.2308, rel=0.005)
    assert (angle.max() / angle[-1] - 1) * 100 == pytest.approx(40.3, abs=1.0)


def test_holding_30_degrees_by_hand():
    """2.127 N m at the steering wheel: k_p delta / i; the printed digits."""
    column = column_of(ManualColumn)
    for _ in range(20000):
        state = advance(column, 2.127)
    assert math.degrees(state.road_wheel_angle) == pytest.approx(30.0, rel=0.0005)
    assert state.angle == RATIO * state.road_wheel_angle
    assert state.hand_torque == 2.127


def test_drive_torque_difference_turns_the_wheels():
    """At rest k_p delta = d/(2 r_k) (M_R - M_L); after 20 s the free motion has decayed to e^-27."""
    column = column_of(PoweredColumn)
    for _ in range(20000):
        state = advance(column, 0.0, at_rest(difference=10.0))
    assert state.road_wheel_angle == pytest.approx(LEVER * 10.0 / K, rel=1e-9)


def test_only_the_manual_column_ignores_the_drives_and_only_by_wire_the_hands():
    for kind in (PoweredColumn, ByWireColumn):
        assert advance(column_of(kind), 0.0, at_rest(difference=10.0)).road_wheel_angle > 0.0
    for kind in (ManualColumn, PoweredColumn):
        assert advance(column_of(kind), 1.0).road_wheel_angle > 0.0
    by_wire = advance(column_of(ByWireColumn), 1.0)
    assert by_wire.road_wheel_angle == 0.0
    assert by_wire.angle > 0.0


def test_steering_wheel_by_wire_settles_at_the_centring_spring():
    """M_b/k = 1/0.25 = 4 rad; after 20 s the free motion has decayed to e^-40."""
    column = column_of(ByWireColumn)
    for _ in range(20000):
        state = advance(column, 1.0)
    assert state.angle == pytest.approx(4.0, rel=1e-9)


def test_inertia_of_the_wheels_works_against_their_acceleration():
    """The J_k term of eq 3: the speed difference grows by 0.5 rad/s in 10 ms, so 1 kg m^2 takes 50 N m of the drives.

    To the bit: both columns get the same numbers, 50 N m of torque difference less or 0.5/0.01 rad/s^2.
    """
    with_inertia = column_of(PoweredColumn, 0.01, wheel_inertia=1.0)
    without = column_of(PoweredColumn, 0.01)
    assert advance(with_inertia, 0.0, at_rest(60.0, 0.5)) == advance(without, 0.0, at_rest(10.0))
    assert advance(with_inertia, 0.0, at_rest(60.0, 0.5)) == advance(without, 0.0, at_rest(60.0))


@given(
    j=st.floats(0.01, 100.0),
    b=st.floats(0.0, 1000.0),
    k=st.floats(0.01, 1000.0),
    angle=st.floats(-1.0, 1.0),
    rate=st.floats(-10.0, 10.0),
    torque=st.floats(-100.0, 100.0),
)
@settings(max_examples=200, deadline=None)
def test_motion_without_friction_is_the_matrix_exponential(j, b, k, angle, rate, torque):
    """Any damping, against scipy's expm; it loses digits in proportion to the norm of the matrix, hence 1e-8."""
    period = 0.01
    system = np.array([[0.0, 1.0, 0.0], [-k / j, -b / j, 1 / j], [0.0, 0.0, 0.0]])
    expected = scipy.linalg.expm(system * period) @ [angle, rate, torque]
    got = FrictionOscillator(j, b, k, 0.0, FAR, period).advance(angle, rate, torque)
    assert got == pytest.approx(expected[:2], rel=1e-8, abs=1e-8)


def test_critical_damping_is_no_special_case():
    """J = 1, b = 2, k = 1 from x = 1 at rest: x = (1 + t) e^-t; the tolerance is rounding."""
    oscillator, angle, rate = FrictionOscillator(1.0, 2.0, 1.0, 0.0, FAR, 0.1), 1.0, 0.0
    for _ in range(20):
        angle, rate = oscillator.advance(angle, rate, 0.0)
    assert (angle, rate) == pytest.approx((3 * math.exp(-2.0), -2 * math.exp(-2.0)), rel=1e-12)


@pytest.mark.parametrize("period", [0.001, 0.0123, 0.3])
def test_dry_friction_takes_the_same_angle_of_every_half_oscillation(period):
    """Coulomb's oscillator: turning points 0.95, -0.75, 0.55, -0.35, 0.15, 0.05 with M_c/k = 0.1 rad, then it sticks.

    Every half oscillation takes pi sqrt(J/k). Exact at any period up to rounding.
    """
    oscillator, half = FrictionOscillator(J, 0.0, K, 6.5, FAR, period), math.pi * math.sqrt(J / K)
    angle, rate, step = 0.95, 0.0, 0
    while (step + 1) * period < 5 * half:
        angle, rate = oscillator.advance(angle, rate, 0.0)
        step += 1
        halves, phase = divmod(step * period, half)
        centre = 0.1 * (-1) ** halves
        start = (-1) ** halves * (0.95 - 0.2 * halves)
        assert angle == pytest.approx(centre + (start - centre) * math.cos(math.pi * phase / half), abs=1e-12)
    angle, rate = oscillator.advance(angle, rate, 0.0)
    assert (angle, rate) == (pytest.approx(0.05, abs=1e-12), 0.0)


@pytest.mark.parametrize("kind", [ManualColumn, PoweredColumn, ByWireColumn])
@pytest.mark.parametrize("period", [0.001, 0.01])
def test_stick_holds_exactly_for_a_minute(kind, period):
    """Turned and let go, friction holds the wheels off centre: not a bit changes in 60 s."""
    column = column_of(kind, period, dry_friction=20.0)
    for _ in range(round(3 / period)):
        advance(column, 3.0, at_rest(difference=15.0))
    for _ in range(round(2 / period)):
        held = advance(column)
    assert abs(held.road_wheel_angle) > 0.05
    assert held.road_wheel_rate == 0.0
    for _ in range(round(60 / period)):
        state = advance(column)
        assert state.road_wheel_angle == held.road_wheel_angle
        assert state.road_wheel_rate == 0.0


@given(direction=st.sampled_from([-1.0, 1.0]), friction=st.floats(0.1, 100.0))
def test_breakaway_is_at_the_dry_friction(direction, friction):
    """At exactly M_c nothing moves; a part in 10^9 more moves the wheels that way, and only that far: (T - M_c)/k."""
    oscillator = FrictionOscillator(J, B, K, friction, FAR, 0.01)
    assert oscillator.advance(0.0, 0.0, direction * friction) == (0.0, 0.0)
    torque, angle, rate = friction * (1 + 1e-9), 0.0, 0.0
    for step in range(1000):
        angle, rate = oscillator.advance(angle, rate, direction * torque)
        assert direction * angle > 0.0, step
        assert direction * angle <= 2 * (torque - friction) / K


def test_motion_keeps_dry_friction_against_it():
    """A steady pull from rest settles short by M_c/k: overdamped, so it never turns back; 10 time constants of 0.12 s.

    The settled angle is approached by e^-10 at least.
    """
    oscillator, angle, rate = FrictionOscillator(0.1, 8.0, K, 6.5, FAR, 0.01), 0.0, 0.0
    for _ in range(300):
        angle, rate = oscillator.advance(angle, rate, 65.0)
    assert angle == pytest.approx(0.9, rel=1e-4)


states = {
    "angle": st.floats(-1.0, 1.0),
    "rate": st.floats(-20.0, 20.0),
    "friction": st.sampled_from([0.0, 0.5, 6.5, 50.0]),
    "damping": st.sampled_from([0.0, 1.0, 7.5, 60.0]),
    "stop": st.sampled_from([1.0, 1.5, FAR]),
    "period": st.sampled_from([0.001, 0.01, 0.1, 1.0]),
}


@given(**states)
@settings(deadline=None)
def test_energy_never_grows_without_torque(angle, rate, friction, damping, stop, period):
    """Friction and stops only take energy.

    One part in 10^12 is the rounding of a step; 1e-17 J that of a tiny angle beside M_c/k.
    """
    oscillator = FrictionOscillator(J, damping, K, friction, stop, period)
    for _ in range(100):
        before = energy(angle, rate)
        angle, rate = oscillator.advance(angle, rate, 0.0)
        assert energy(angle, rate) <= before * (1 + 1e-12) + 1e-17


@given(torques=st.lists(st.floats(-300.0, 300.0), min_size=1, max_size=20), **states)
@settings(deadline=None)
def test_mirror_and_stops(torques, angle, rate, friction, damping, stop, period):
    """Left and right mirror to the bit, and no stop is ever passed, under any torques."""
    oscillator = FrictionOscillator(J, damping, K, friction, stop, period)
    mirrored = (-angle, -rate)
    for torque in torques:
        angle, rate = oscillator.advance(angle, rate, torque)
        mirrored = oscillator.advance(*mirrored, -torque)
        assert mirrored == (-angle, -rate)
        assert abs(angle) <= stop


@given(torque=st.floats(-200.0, 200.0), **states)
@settings(deadline=None)
def test_motion_does_not_depend_on_the_period(torque, angle, rate, friction, damping, stop, period):
    """Ten steps of a tenth end where one step ends, reversals, sticking and impacts included.

    1e-6: an impact or a reversal at low speed magnifies rounding (its instant shifts by the root of it).
    """
    whole = FrictionOscillator(J, damping, K, friction, stop, period).advance(angle, rate, torque)
    tenth = FrictionOscillator(J, damping, K, friction, stop, period / 10)
    for _ in range(10):
        angle, rate = tenth.advance(angle, rate, torque)
    assert (angle, rate) == pytest.approx(whole, abs=1e-6)


def test_end_stop_takes_the_motion_and_lets_go():
    """Against the stop at 0.5 rad it rests there exactly; released it comes back as from rest at 0.5 rad.

    0.5 (c + s decay) of the free motion is the exact step response; only rounding differs.
    """
    column = column_of(ManualColumn, max_angle=0.5)
    for _ in range(1000):
        state = advance(column, 10.0)
    assert (state.road_wheel_angle, state.road_wheel_rate) == (0.5, 0.0)
    free = FrictionOscillator(J, B, K, 0.0, FAR, 0.001)
    angle, rate = 0.5, 0.0
    for _ in range(500):
        state = advance(column)
        angle, rate = free.advance(angle, rate, 0.0)
        assert (state.road_wheel_angle, state.road_wheel_rate) == (angle, rate)


def test_impact_happens_in_mid_step():
    """Undamped under 0.8 k: x = 0.8 (1 - cos w t) meets the stop at 1 rad, loses its speed, swings around 0.8 rad.

    Rounding only: the instant of the impact is known to the last bit.
    """
    w = math.sqrt(K / J)
    impact = math.acos(-0.25) / w
    period = 1.2 * impact
    angle, _ = FrictionOscillator(J, 0.0, K, 0.0, 1.0, period).advance(0.0, 0.0, 0.8 * K)
    assert angle == pytest.approx(0.8 + 0.2 * math.cos(w * (period - impact)), abs=1e-12)


@given(torques=st.lists(st.tuples(st.floats(-8.0, 8.0), st.floats(-50.0, 50.0)), min_size=1, max_size=30))
@settings(deadline=None)
@pytest.mark.parametrize("kind", [PoweredColumn, ByWireColumn])
def test_columns_mirror_to_the_bit(kind, torques):
    changed = {"dry_friction": 5.0, "wheel_inertia": 0.5, "max_angle": 0.6}
    column, mirror = (column_of(kind, 0.01, **changed) for _ in range(2))
    for hand_torque, difference in torques:
        state = advance(column, hand_torque, at_rest(difference, difference / 10))
        mirrored = advance(mirror, -hand_torque, at_rest(-difference, -difference / 10))
        assert mirrored == tuple(-value for value in state)
