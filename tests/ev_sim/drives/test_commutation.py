"""Commutation, freewheeling diodes and the loss of current control."""

import math

import numpy as np
import pytest
from drives.bench import (
    CONTROLS,
    INDUCTANCE,
    RESISTANCE,
    SWITCHED,
    TORQUE_CONSTANT,
    advance_drive,
    drive_with,
    name_of,
    run,
)


def phase_model(speed, bus_voltage, duration):
    """Torque after `duration` of a motor on block commutation without current control, from rest.

    A second model to compare with: three named phases, EMF by the electrical angle, explicit Euler
    at 0.1 us.
    """
    step = 1e-7
    # the middle of sector 0, which begins 30 deg after phase a's EMF rises through zero
    angle = math.radians(60)
    currents = [0.0, 0.0, 0.0]
    torque = 0.0

    def shape(electrical_angle):
        turn = math.degrees(electrical_angle) % 360
        if turn < 180:
            return min(1.0, turn / 30, (180 - turn) / 30)
        return -min(1.0, (turn - 180) / 30, (360 - turn) / 30)

    for _ in range(round(duration / step)):
        shapes = [shape(angle - k * math.tau / 3) for k in range(3)]
        emfs = [10 * 0.2 * speed * s for s in shapes]
        high, low = shapes.index(max(shapes)), shapes.index(min(shapes))
        off = 3 - high - low
        voltages = [0.0, 0.0, 0.0]
        voltages[high] = bus_voltage
        voltages[off] = 0.0 if currents[off] > 0 else bus_voltage
        floating = bus_voltage / 2 + emfs[off]
        conducting = [high, low, off]
        if currents[off] == 0.0 and 0.0 <= floating <= bus_voltage:
            conducting.remove(off)
        elif currents[off] == 0.0:
            voltages[off] = 0.0 if floating < 0.0 else bus_voltage
        neutral = sum(voltages[k] - emfs[k] for k in conducting) / len(conducting)
        off_before = currents[off]
        for k in conducting:
            currents[k] += (
                step / INDUCTANCE * (voltages[k] - neutral - emfs[k] - RESISTANCE * currents[k])
            )
        if currents[off] * off_before < 0.0:
            currents[low] += currents[off]
            currents[off] = 0.0
        angle += 10 * speed * step
        torque = 10 * 0.2 * sum(s * i for s, i in zip(shapes, currents, strict=True))
    return torque


@pytest.mark.parametrize(("speed", "bus_voltage"), [(95.0, 480.0), (95.0, 300.0), (-95.0, 480.0)])
def test_switched_drive_agrees_with_a_plain_model_of_three_phases(speed, bus_voltage):
    """Three commutations agree without reaching the current limit.

    The second bus makes the diodes conduct.

    0.1 % of the torque: the explicit steps of the plain model, by one of which the
    freewheeling phase may pass zero.
    """
    state, parameters = drive_with({"drive": "switched", "motor.torque_limit": 1e5})
    for _ in range(8):
        advance_drive(state, parameters, 1e5, speed, bus_voltage, 0.5e-3)
    assert state["torque"] == pytest.approx(phase_model(speed, bus_voltage, 4e-3), rel=0.001)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
def test_commutation_makes_six_ripples_in_an_electrical_turn(changes):
    """The sixth harmonic leads at 40 N m and 60 rad/s (a turn takes 10.47 ms)."""
    turn = math.tau / (10 * 60.0)
    result = run(changes, 40.0, 60.0, duration=30 * turn, step=turn / 120, settled=10 * turn)
    spectrum = np.abs(np.fft.rfft(result.mean_torque)) / len(result.mean_torque) * 2
    harmonics = spectrum[::20]  # of twenty turns every twentieth line is a harmonic of the turn
    assert harmonics[6] > 0.01 * 40.0
    assert max(harmonics[1:6]) < 0.1 * harmonics[6]


def test_commutation_dip_begins_where_four_times_the_emf_exceeds_the_bus_voltage():
    """Carlson, Lajoie-Mazenc and Fagundes (IEEE Trans. Ind. Appl. 28, 1992).

    U = 4 E keeps the current that stays on.

    E = p psi omega reaches 120 V at 60 rad/s. Below, hysteresis holds the current in its band of
    0.5 A; above, the incoming phase rises more slowly than the outgoing one falls. 0.05 A: samples
    lie between switching instants.
    """
    slow = run({"drive": "switched"}, 40.0, 55.0, duration=0.1, step=2e-5, settled=0.05)
    fast = run({"drive": "switched"}, 40.0, 75.0, duration=0.1, step=2e-5, settled=0.05)
    assert min(slow.current) > 10.0 - 0.5 - 0.05
    assert min(fast.current) < 10.0 - 2 * 0.5


def test_second_turn_needs_more_than_300_volt():
    """The outer motor turns at 95.2 rad/s.

    EMF 381 V between two phases, torque of rolling and air 12 N m.

    480 V holds the reference within 6 % (commutation takes longer than half a sector there), at 300
    V the motor brakes through the diodes whatever the reference is.
    """
    speed = 95.2
    assert TORQUE_CONSTANT * speed == pytest.approx(381.0, abs=0.5)
    for changes in CONTROLS:
        held = run(changes, 12.0, speed, duration=0.3, settled=0.1)
        lost = run(changes, 12.0, speed, duration=0.3, settled=0.1, bus_voltage=300.0)
        assert np.mean(held.mean_torque) == pytest.approx(12.0, rel=0.06)
        assert np.mean(lost.mean_torque) < -30.0
        assert np.mean(lost.electrical_power) < 0.0


def test_lost_current_control_does_not_depend_on_how_the_converter_chops():
    """Hysteresis and PWM then both keep the rails where they are.

    1e-6 is left of how the currents began.
    """
    hysteresis, pwm = (
        run(changes, 12.0, 95.2, duration=0.3, settled=0.2, bus_voltage=300.0).mean_torque
        for changes in SWITCHED
    )
    assert hysteresis == pytest.approx(pwm, rel=1e-6)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
def test_halving_the_micro_step_converges(changes):
    """Mean torque over 50 ms at 60 rad/s against a micro-step of 0.25 us.

    1e-5 of it at the default of 5 us.

    The instants of PWM do not feed back on themselves: its error falls with the square of the step:
    to a quarter, or a third where events within a step disturb that. Hysteresis shifts its own
    instants, so only its size is known.
    """

    def mean_torque(micro_step):
        result = run({**changes, "switched.micro_step": micro_step}, 40.0, 60.0, duration=0.05)
        return np.mean(result.mean_torque)

    exact = mean_torque(0.25e-6)
    coarse, half, default = (
        abs(mean_torque(micro_step) - exact) for micro_step in (20e-6, 10e-6, 5e-6)
    )
    assert default < 1e-5 * 40.0
    if "switched.current_control" in changes:
        assert coarse > 3 * half > 9 * default
