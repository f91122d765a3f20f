"""Ideal, averaged and switched drives: torque, current and energy."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.parameters import ParameterError, build
from ev_sim.drives.drive import DRIVES, DriveParameters, advance_drive, drive_record, drives_at_rest
from ev_sim.drives.switched import SECTOR

BUS_VOLTAGE = 480.0
TORQUE_CONSTANT = 2 * 10 * 0.2  # 2 p psi [N m/A]
INDUCTANCE = 0.008
RESISTANCE = 0.15
CONTROLS = ({"drive": "averaged"}, {"drive": "switched"}, {"drive": "switched", "switched.current_control": "pwm"})
SWITCHED = CONTROLS[1:]


def name_of(changes):
    return " ".join(changes.values())


def drive_with(changes):
    """A drive at rest and its parameters."""
    return drives_at_rest(1)[0], drive_record(build(DriveParameters, changes))[0]


def run(changes, torque, speed, *, duration, step=1e-3, bus_voltage=BUS_VOLTAGE, settled=0.0):
    """Advance a drive from rest at a constant speed; its samples after the time `settled`, and the drive."""
    state, parameters = drive_with(changes)
    samples = {name: [] for name in state.dtype.names}
    for k in range(round(duration / step)):
        advance_drive(state, parameters, torque, speed, bus_voltage, step)
        if k >= round(settled / step):
            for name, values in samples.items():
                values.append(state[name].item())
    return SimpleNamespace(**{name: np.array(values) for name, values in samples.items()}, state=state)


def magnetic_energy(drive, state):
    high, off = state["high_current"], state["off_current"]
    if drive == "averaged":
        return INDUCTANCE * state["current"] ** 2  # L i^2/2 in each of two phases
    return INDUCTANCE / 2 * (high**2 + off**2 + (high + off) ** 2)


@pytest.mark.parametrize("drive", DRIVES)
def test_torque_reference_is_limited_to_the_torque_limit(drive):
    """2 % is more than the hysteresis band of 0.5 A in 25 A adds to the mean over 1 ms."""
    for sign in (1.0, -1.0):
        result = run({"drive": drive, "motor.torque_limit": 100.0}, sign * 300.0, 0.0, duration=0.05)
        assert result.mean_torque[-1] == pytest.approx(sign * 100.0, rel=0.02)


@settings(deadline=None)  # the first call compiles
@given(st.floats(-400, 400), st.floats(-100, 100))
def test_ideal_drive_gives_the_reference_without_losses(torque, speed):
    result = run({"drive": "ideal"}, torque, speed, duration=1e-3)
    assert result.torque[0] == result.mean_torque[0] == torque
    assert result.electrical_power[0] == torque * speed
    assert result.current[0] * TORQUE_CONSTANT == pytest.approx(torque)


def test_averaged_current_follows_the_first_order_loop_it_is_tuned_for():
    """Zero of the controller on the pole of the motor: 1 - exp(-bandwidth t).

    2 %: sampling every 10 us delays a loop of 3000 rad/s by half a sample, 1.5 % of a time constant.
    """
    changes = {"drive": "averaged", "averaged.sampling_period": 1e-5}
    result = run(changes, 10.0, 0.0, duration=1e-3, step=1e-5)
    time = 1e-5 * np.arange(1, 101)
    assert result.torque == pytest.approx(10.0 * (1 - np.exp(-3000 * time)), abs=0.02 * 10.0)


def test_averaged_drive_rises_no_faster_than_the_bus_voltage_allows_and_does_not_overshoot():
    """2 L i' = U - 2 R i while the voltage is limited; anti-windup keeps the overshoot below 0.1 %."""
    result = run({"drive": "averaged"}, 200.0, 0.0, duration=5e-3, step=1e-4)
    decay = RESISTANCE / INDUCTANCE
    rise = BUS_VOLTAGE / (2 * RESISTANCE) * (1 - math.exp(-decay * 1e-3))
    assert result.current[9] == pytest.approx(rise, rel=1e-6)  # midpoint rule at 100 us: (decay h)^2/12 = 3e-7
    assert max(result.current) < 1.001 * 200.0 / TORQUE_CONSTANT


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@pytest.mark.parametrize("torque", [12.0, -12.0])
@pytest.mark.parametrize("speed", [-60.0, -5.0, 0.0, 5.0, 60.0])
def test_mean_torque_is_the_reference_in_all_four_quadrants(changes, torque, speed):
    """12 N m drives the car at constant speed; 60 rad/s are 24 km/h.

    1 %: during a commutation the torque dips by the part of the current that is still in the outgoing phase.
    """
    result = run(changes, torque, speed, duration=0.4, settled=0.1)
    assert np.mean(result.mean_torque) == pytest.approx(torque, rel=0.01)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
@pytest.mark.parametrize("sector", range(6))
def test_switched_drive_holds_its_torque_at_standstill_in_every_sector_and_on_every_edge(changes, sector):
    """0.5 %: means over 1 ms hold about 15 chopping periods of which one may be cut."""
    for sector_angle in (0.0, 0.7, SECTOR):
        state, parameters = drive_with(changes)
        state["sector"], state["sector_angle"] = sector, sector_angle
        torques = []
        for _ in range(50):
            advance_drive(state, parameters, -20.0, 0.0, BUS_VOLTAGE, 1e-3)
            torques.append(state["mean_torque"])
        assert np.mean(torques[10:]) == pytest.approx(-20.0, rel=0.005)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
def test_switched_drive_keeps_its_torque_while_the_rotor_swings_to_and_fro(changes):
    """Speed reverses on and between sector edges; 1 % as in the four quadrants."""
    state, parameters = drive_with(changes)
    torques = []
    for k in range(1000):
        advance_drive(state, parameters, 12.0, 10.0 * math.sin(0.02 * k), BUS_VOLTAGE, 1e-3)
        torques.append(state["mean_torque"])
    assert np.mean(torques[50:]) == pytest.approx(12.0, rel=0.01)
    assert 0.0 <= state["sector_angle"] <= SECTOR


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@settings(max_examples=20, deadline=None)
@given(torque=st.floats(-400, 400), speed=st.floats(-150, 150), bus_voltage=st.floats(100, 600))
def test_without_resistance_electrical_energy_is_mechanical_work_and_magnetic_energy(
    changes, torque, speed, bus_voltage
):
    """The midpoint rule keeps the balance up to rounding, lost current control and diode braking included."""
    state, parameters = drive_with({**changes, "motor.resistance": 0.0})
    electrical, mechanical, turnover = 0.0, 0.0, 1.0
    for _ in range(20):
        advance_drive(state, parameters, torque, speed, bus_voltage, 1e-3)
        electrical += state["electrical_power"] * 1e-3
        mechanical += state["mean_torque"] * speed * 1e-3
        turnover += abs(state["mean_torque"] * speed * 1e-3)
    stored = magnetic_energy(changes["drive"], state)
    assert electrical == pytest.approx(mechanical + stored, abs=1e-9 * (turnover + stored))


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@pytest.mark.parametrize(("torque", "speed"), [(80.0, 40.0), (-80.0, 40.0), (80.0, 0.0), (12.0, -95.0)])
def test_what_is_left_of_the_electrical_energy_is_copper_loss(changes, torque, speed):
    """R sum(i^2) from samples every 10 us; 1 %: the currents between two samples are taken as straight lines."""
    state, parameters = drive_with(changes)
    electrical = mechanical = copper = 0.0
    before = 0.0, 0.0, 0.0
    for _ in range(5000):
        advance_drive(state, parameters, torque, speed, BUS_VOLTAGE, 1e-5)
        electrical += state["electrical_power"] * 1e-5
        mechanical += state["mean_torque"] * speed * 1e-5
        if changes["drive"] == "averaged":
            after = state["current"], -state["current"], 0.0
        else:
            after = state["high_current"], state["off_current"], -state["high_current"] - state["off_current"]
            if not np.isclose(after, before, atol=1.0).all():
                before = after  # a commutation gives the same currents other names
        copper += RESISTANCE * sum(((a + b) / 2) ** 2 for a, b in zip(before, after, strict=True)) * 1e-5
        before = after
    assert electrical - mechanical - magnetic_energy(changes["drive"], state) == pytest.approx(copper, rel=0.01)


def phase_model(speed, bus_voltage, duration):
    """Torque after `duration` of a motor on block commutation without current control, from rest.

    A second model to compare with: three named phases, EMF by the electrical angle, explicit Euler at 0.1 us.
    """
    step = 1e-7
    angle = math.radians(60)  # the middle of sector 0, which begins 30 deg after phase a's EMF rises through zero
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
            currents[k] += step / INDUCTANCE * (voltages[k] - neutral - emfs[k] - RESISTANCE * currents[k])
        if currents[off] * off_before < 0.0:
            currents[low] += currents[off]
            currents[off] = 0.0
        angle += 10 * speed * step
        torque = 10 * 0.2 * sum(s * i for s, i in zip(shapes, currents, strict=True))
    return torque


@pytest.mark.parametrize(("speed", "bus_voltage"), [(95.0, 480.0), (95.0, 300.0), (-95.0, 480.0)])
def test_switched_drive_agrees_with_a_plain_model_of_three_phases(speed, bus_voltage):
    """Without reaching the current limit, over three commutations; the second bus makes the diodes conduct.

    0.1 % of the torque: the explicit steps of the plain model, of which the freewheeling phase may pass zero by one.
    """
    state, parameters = drive_with({"drive": "switched", "motor.torque_limit": 1e5})
    for _ in range(8):
        advance_drive(state, parameters, 1e5, speed, bus_voltage, 0.5e-3)
    assert state["torque"] == pytest.approx(phase_model(speed, bus_voltage, 4e-3), rel=0.001)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
def test_commutation_makes_six_ripples_in_an_electrical_turn(changes):
    """At 40 N m and 60 rad/s (a turn takes 10.47 ms) the sixth harmonic stands far above its neighbours."""
    turn = math.tau / (10 * 60.0)
    result = run(changes, 40.0, 60.0, duration=30 * turn, step=turn / 120, settled=10 * turn)
    spectrum = np.abs(np.fft.rfft(result.mean_torque)) / len(result.mean_torque) * 2
    harmonics = spectrum[::20]  # of twenty turns every twentieth line is a harmonic of the turn
    assert harmonics[6] > 0.01 * 40.0
    assert max(harmonics[1:6]) < 0.1 * harmonics[6]


def test_commutation_dip_begins_where_four_times_the_emf_exceeds_the_bus_voltage():
    """Carlson, Lajoie-Mazenc and Fagundes (IEEE Trans. Ind. Appl. 28, 1992): U = 4 E keeps the current that stays on.

    E = p psi omega reaches 120 V at 60 rad/s. Below, hysteresis holds the current in its band of 0.5 A; above, the
    incoming phase rises more slowly than the outgoing one falls. 0.05 A: samples lie between switching instants.
    """
    slow = run({"drive": "switched"}, 40.0, 55.0, duration=0.1, step=2e-5, settled=0.05)
    fast = run({"drive": "switched"}, 40.0, 75.0, duration=0.1, step=2e-5, settled=0.05)
    assert min(slow.current) > 10.0 - 0.5 - 0.05
    assert min(fast.current) < 10.0 - 2 * 0.5


def test_second_turn_needs_more_than_300_volt():
    """The outer motor turns at 95.2 rad/s: EMF 381 V between two phases, torque of rolling and air 12 N m.

    480 V holds the reference within 6 % (commutation takes longer than half a sector there), at 300 V the motor
    brakes through the diodes whatever the reference is.
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
    """Hysteresis and PWM then both keep the rails where they are; 1e-6 is left of how the currents began."""
    hysteresis, pwm = (
        run(changes, 12.0, 95.2, duration=0.3, settled=0.2, bus_voltage=300.0).mean_torque for changes in SWITCHED
    )
    assert hysteresis == pytest.approx(pwm, rel=1e-6)


@pytest.mark.parametrize("drive", DRIVES)
def test_braking_feeds_the_bus(drive):
    """-40 N m at 40 rad/s: 1600 W of mechanical power less 2 R i^2 = 30 W, 2 % for the commutations."""
    result = run({"drive": drive}, -40.0, 40.0, duration=0.2, settled=0.1)
    loss = 0.0 if drive == "ideal" else 2 * RESISTANCE * 10.0**2
    assert np.mean(result.electrical_power) == pytest.approx(-1600.0 + loss, rel=0.02)


@pytest.mark.parametrize("changes", SWITCHED, ids=name_of)
def test_halving_the_micro_step_converges(changes):
    """Mean torque over 50 ms at 60 rad/s against a micro-step of 0.25 us; 1e-5 of it at the default of 5 us.

    With PWM, whose instants do not feed back on themselves, the error falls with the square of the step: to a quarter,
    or a third where events within a step disturb that. Hysteresis shifts its own instants, so only its size is known.
    """

    def mean_torque(micro_step):
        result = run({**changes, "switched.micro_step": micro_step}, 40.0, 60.0, duration=0.05)
        return np.mean(result.mean_torque)

    exact = mean_torque(0.25e-6)
    coarse, half, default = (abs(mean_torque(micro_step) - exact) for micro_step in (20e-6, 10e-6, 5e-6))
    assert default < 1e-5 * 40.0
    if "switched.current_control" in changes:
        assert coarse > 3 * half > 9 * default


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"averaged.sampling_period": 1e-3}, "averaged.current_controller.bandwidth"),
        ({"switched.current_controller.bandwidth": 5e4}, "switched.current_controller.bandwidth"),
        ({"drive": "perfect"}, "drive"),
    ],
)
def test_settings_that_cannot_work_are_refused_by_name(changes, name):
    with pytest.raises(ParameterError, match=name):
        build(DriveParameters, changes)
