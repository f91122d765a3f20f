"""The urban cycle on mixed surfaces: efficiencies by hand, windows, figures, and the five differentials."""

from __future__ import annotations

import csv
import dataclasses
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from urban_runs import CAR, PARAMETERS, driven, parameters_of, scenario

from ev_control.electronic_differential.adaptive import Adaptive
from ev_control.electronic_differential.adhesion_share import AdhesionShare
from ev_control.electronic_differential.limited_slip import LimitedSlip
from ev_control.electronic_differential.limited_slip_variable import LimitedSlipVariable
from ev_control.electronic_differential.load_proportional import LoadProportional
from ev_control.electronic_differential.open_differential import OpenDifferential
from ev_control.wheel_loads import WheelLoads
from ev_msgs_py.signals import (
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_sim.profiles.cycle_modes import MODES, TRACTION
from ev_sim.recording.recording import Recording
from ev_sim.report import cycle_efficiency as cycle
from ev_sim.report.cycle_bands import stretches
from ev_sim.report.metric import NotMeasured
from ev_sim.report.registry import report_for
from ev_sim.report.slip_curve import first_passed_peak
from ev_sim.report.surfaces_under import share_of, surfaces_under
from ev_sim.surfaces.road import RoadParameters, left_and_right

ROOT = Path(__file__).parents[1]
DRIVERS = ("tracking", "pulse", "imposed_speed")
FIGURES = [
    "figure_2_8",
    "figure_2_13",
    "figure_3_torques_and_speeds",
    "figure_3_wheel_efficiency",
    "figure_3_detail",
    "figure_5_electrical",
]
PERIOD = 0.005
INERTIA = CAR.wheel_inertia + CAR.gear_ratio**2 * CAR.motor.rotor_inertia


# Efficiencies by hand


def cycle_of(begin: tuple[float, ...], mode: tuple[str, ...]) -> dict[str, object]:
    """Parameters of a driver with a cycle of 10 m/s."""
    return {
        "modes.begin": begin,
        "modes.mode": mode,
        "speed_profile.time": (0.0,),
        "speed_profile.speed": (10.0,),
        "speed_profile.interpolation": "linear",
    }


STEADY = cycle_of((0.0, 1.0, 3.0), MODES)
TORQUE, FORCE, TURNING, ROLLING = 100.0, 250.0, 20.0, 18.0  # N m, N, rad/s, rad/s
FORCE_SHARE = FORCE * 0.32 / TORQUE


def steady_run(rate: float = 0.0) -> Recording:
    """Four seconds of constant torque, force and slip of both front wheels; `rate` is their acceleration [rad/s^2]."""
    time = np.arange(401) * 0.01
    ones = np.ones_like(time)
    channels = {
        "driver.command.drive_torque": 200.0 * ones,
        "battery.voltage": 400.0 * ones,
        "battery.current": -20.0 * ones,
        "twist.longitudinal": 10.0 * ones,
        "twist.lateral": 0.0 * ones,
    }
    for wheel in WHEEL_NAMES:
        front = wheel.startswith("front")
        channels[f"wheel_states.velocity.{wheel}"] = (TURNING + rate * time) if front else ROLLING * ones
        channels[f"wheel_states.effort.{wheel}"] = TORQUE * front * ones
        channels[f"tire_forces.longitudinal_force.{wheel}"] = FORCE * front * ones
        channels[f"motor_states.effort.{wheel}"] = 15.0 * front * ones
        channels[f"motor_states.velocity.{wheel}"] = 200.0 * front * ones
    return Recording(time, channels)


def test_wheel_sums_of_constant_slip():
    """Two seconds of traction: M 200 N m s, M_f = M - F r, 40 and 36 rad; eq 2.37: 0.8 x 0.9."""
    assert CAR.wheel_radius == 0.32
    for sums in cycle.wheel_sums(steady_run(), CAR, STEADY).values():
        assert (sums.torque, sums.turned, sums.free_turned) == pytest.approx((200.0, 40.0, 36.0))
        assert sums.resistance == pytest.approx(2.0 * (TORQUE - FORCE * 0.32))
        assert sums.speed_efficiency == pytest.approx(0.9)
        assert sums.efficiency == pytest.approx(FORCE_SHARE * 0.9)


def test_torque_that_turns_the_wheel_faster_is_no_resistance():
    """J w' is taken out of M_f: 5 rad/s^2 of 2.75 kg m^2 over 2 s are 27.5 N m s."""
    still, faster = (cycle.wheel_sums(steady_run(rate), CAR, STEADY)["front_left"] for rate in (0.0, 5.0))
    assert still.resistance - faster.resistance == pytest.approx(INERTIA * 5.0 * 2.0)
    assert pytest.approx(2.753, abs=5e-4) == INERTIA


def test_energies_of_constant_power():
    """2 x 15 N m x 200 rad/s for 2 s at the shafts, 400 V x 20 A at the battery, F r (w - w_free) at both tyres."""
    assert cycle.energies(steady_run(), STEADY) == pytest.approx((12e3, 16e3))
    assert cycle.slip_energy(steady_run(), CAR, STEADY) == pytest.approx(2 * FORCE * 0.32 * 2.0 * 2.0)


def test_released_pedal_and_other_windows_do_not_count():
    """The sample answers for the period before it: the pedal of 1.00 s acts until 1.01 s."""
    run = steady_run()
    pressed = run.channels["driver.command.drive_torque"].copy()
    pressed[200:] = 0.0
    run = Recording(run.time, {**run.channels, "driver.command.drive_torque": pressed})
    inside = cycle.traction(run, STEADY)
    assert run.time[inside].tolist() == pytest.approx(np.arange(101, 201) * 0.01)
    assert cycle.wheel_sums(run, CAR, STEADY)["front_left"].torque == pytest.approx(100.0)


def test_running_efficiency_ends_at_that_of_the_cycle():
    shares = cycle.wheel_shares(steady_run(2.0), CAR, STEADY)["front_left"]
    running = shares.running_efficiency()
    assert np.isnan(running[:100]).all()
    assert running[-1] == pytest.approx(shares.sums().efficiency, rel=1e-12)
    assert np.ptp(running[301:]) == 0.0


def test_four_driven_wheels_leave_none_to_measure_slip_with():
    with pytest.raises(NotMeasured, match="no free wheel beside front_left"):
        cycle.wheel_sums(steady_run(), dataclasses.replace(CAR, driven_wheels=WHEEL_NAMES), STEADY)


def test_metrics_by_hand():
    found = report_for("urban_mixed").metrics({"urban_mixed": steady_run()}, CAR, {"driver": STEADY})
    value = {name: metric.value for name, metric in found.items()}
    wheel, drive = FORCE_SHARE * 0.9, 12 / 16
    for name in ("wheel_efficiency", "wheel_efficiency_left", "wheel_efficiency_right"):
        assert value[name] == pytest.approx(wheel)
    assert value["drive_efficiency"] == pytest.approx(drive)
    assert value["total_efficiency"] == pytest.approx(wheel * drive)
    assert (value["energy"], value["energy_in_kwh"]) == pytest.approx((16e3, 16 / 3600))
    assert value["traction_time"] == pytest.approx(2.0)
    assert value["mean_speed_error"] == 0.0
    assert found["share_of_snow_left"].verdict.startswith("not measured: pose.x was not recorded")


def test_driver_without_a_cycle_has_no_efficiencies():
    """All that needs windows says so; where the car went is measured all the same."""
    found = report_for("urban_mixed").metrics({"urban_mixed": driven("pulse")}, CAR, {"driver": {}})
    without = {name for name, metric in found.items() if metric.value is None}
    assert set(found) - without == {"distance", "share_of_snow_left", "share_of_snow_right"}
    reasons = {found[name].reason for name in without}
    assert reasons == {"the driver drives no cycle with windows of traction"}


# The cycle and the road


def test_windows_are_those_of_the_cycle():
    """The scenario and config/cycles/trrl_1_1_modes.csv are the same 19 windows, 355.2 s of traction."""
    with (ROOT / "config" / "cycles" / "trrl_1_1_modes.csv").open(newline="") as file:
        rows = [(float(row["t0_s"]), float(row["t1_s"]), row["mode"]) for row in csv.DictReader(file)]
    driver = PARAMETERS["driver"]
    assert list(driver["modes.begin"]) == [start for start, _, _ in rows]
    assert list(driver["modes.mode"]) == [mode for _, _, mode in rows]
    time = np.arange(116001) * PERIOD
    found = stretches(time, cycle.modes_over_time(Recording(time, {}), driver))
    assert [mode for _, _, mode in found] == [mode for _, _, mode in rows]
    assert sum(end - start for start, end, mode in found if mode == MODES[TRACTION]) == pytest.approx(355.2, abs=1e-6)


@pytest.mark.parametrize("side", [0, 1])
def test_surfaces_come_back_from_the_friction_under_the_wheels(side):
    """Against the drawn segments, by the distance of the front axle; a sample may lie on either side of a border."""
    run, wheel = driven("imposed_speed"), ("front_left", "front_right")[side]
    road = {name.removeprefix("road."): v for name, v in PARAMETERS["plant"].items() if name.startswith("road.")}
    segments = left_and_right(RoadParameters(**road))[side]
    ahead = CAR.wheelbase - CAR.centre_of_mass_to_rear_axle
    expected = np.array([segments.at(x + ahead) for x in run.channels["pose.x"].tolist()])
    found = surfaces_under(run, CAR, wheel)
    assert np.count_nonzero(found != expected) <= len(segments.start)
    distance = run.channels["pose.x"][-1]
    edges = np.clip([0.0, *(start - ahead for start in segments.start[1:]), math.inf], 0.0, distance)
    lengths = [b - a for a, b in pairwise(edges)]
    snow = sum(part for part, name in zip(lengths, segments.surface, strict=True) if name == "packed_snow_1")
    # One sample at each of some twenty borders, 0.07 m each, of 400 m.
    assert share_of(run, CAR, wheel, "packed_snow") == pytest.approx(snow / distance, abs=20 * 0.07 / 400)


# The drivers


@pytest.mark.parametrize("driver", DRIVERS)
def test_every_metric_is_measured(driver):
    found = report_for("urban_mixed").metrics({"urban_mixed": driven(driver)}, CAR, parameters_of(scenario(driver)))
    assert {name: metric.verdict for name, metric in found.items()} == dict.fromkeys(found, "measured")
    for name, metric in found.items():
        if "efficiency" in name or "share" in name:
            assert 0.0 < metric.value < 1.0, name


# Figures


@pytest.mark.parametrize("driver", ["pulse", "imposed_speed"])
def test_figures_have_quantities_and_units(driver):
    figures = report_for("urban_mixed").figures({"urban_mixed": driven(driver)}, CAR, PARAMETERS)
    assert list(figures) == FIGURES
    for name, figure in figures.items():
        for axes in figure.axes:
            assert axes.get_ylabel().endswith("]") or axes.get_ylabel() in ("front left", "front right", "window")
            assert not any("not measured" in text.get_text() for text in axes.texts), name
        assert figure.axes[-1].get_xlabel().endswith("]")
    samples = max(len(line.get_xdata()) for line in figures["figure_5_electrical"].axes[0].lines)
    assert samples < len(driven(driver).time) / 2


def test_figures_say_what_is_missing(tmp_path):
    """No cycle, no tyre forces, all wheels driven: drawn, with the reason in place of curves."""
    from ev_sim.report.drawing import save_figures

    few = Recording(np.arange(200) * PERIOD, {"twist.longitudinal": np.zeros(200), "twist.lateral": np.zeros(200)})
    for car in (CAR, dataclasses.replace(CAR, driven_wheels=WHEEL_NAMES), dataclasses.replace(CAR, driven_wheels=())):
        figures = report_for("urban_mixed").figures({"urban_mixed": few}, car, {"driver": {}})
        assert list(figures) == FIGURES
        for name, figure in figures.items():
            assert any("not measured" in text.get_text() for axes in figure.axes for text in axes.texts), name
    assert len(save_figures(figures, tmp_path)) == len(FIGURES)


def spinning_up(a: float, b: float) -> Recording:
    """A wheel whose slip grows to 0.2 in 0.4 s on a road that takes exactly y = a x + b sqrt(x) of the torque."""
    time = np.arange(81) * PERIOD
    free = np.full_like(time, 30.0)
    speed = free / (1 - 0.02 - 0.18 * (time / time[-1]) ** 2)
    slip = 1 - free / speed
    mean = np.concatenate((slip[:1], (slip[1:] + slip[:-1]) / 2))
    rate = np.diff(speed, prepend=speed[0]) / PERIOD
    nominal = CAR.motor.nominal_torque * CAR.gear_ratio
    return Recording(
        time,
        {
            "wheel_states.velocity.front_left": speed,
            "wheel_states.velocity.rear_left": free,
            "wheel_states.effort.front_left": nominal * (a * mean + b * np.sqrt(mean)) + INERTIA * rate,
            "tire_forces.friction_coefficient.front_left": np.full_like(time, 0.4022),
        },
    )


def test_slip_curve_is_found_exactly():
    """Y = -4 x + 2.4 sqrt(x) has its peak at (2.4/8)^2 = 0.09."""
    curve = first_passed_peak(spinning_up(-4.0, 2.4), CAR, "front_left")
    assert (curve.a, curve.b, curve.peak) == pytest.approx((-4.0, 2.4, 0.09), rel=1e-6)
    with pytest.raises(NotMeasured, match="front left never passes the peak"):
        first_passed_peak(spinning_up(-2.0, 2.4), CAR, "front_left")  # its peak lies at 0.36


@pytest.mark.parametrize("driver", ["pulse", "imposed_speed"])
def test_fitted_peak_is_that_of_packed_snow(driver):
    """0.0907 (table 2.3); the curve of the fit is not Burckhardt's, so within 10 %."""
    run = driven(driver)
    curve = first_passed_peak(run, CAR, "front_left")
    assert surfaces_under(run, CAR, "front_left")[curve.window][-1] == "packed_snow_1"
    assert curve.peak == pytest.approx(0.0907, rel=0.1)
    assert curve.window.stop - curve.window.start == 25


def test_tracking_never_passes_the_peak():
    with pytest.raises(NotMeasured, match="never passes the peak"):
        first_passed_peak(driven("tracking"), CAR, "front_left")


# The differentials

COLUMN = SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0)
LEVEL_ROAD = InertialMeasurement(0.0, 0.0, 0.0)
LOADS = WheelLoads(CAR).at_rest
SPLITTING = (OpenDifferential, LimitedSlip, LimitedSlipVariable, LoadProportional)


def law_of(kind: type, **changed: object):
    return kind(dataclasses.replace(kind.parameters(), **changed), CAR, PERIOD)


def tires(friction: Wheels, load: Wheels = LOADS) -> TireForces:
    return TireForces(NO_WHEELS, NO_WHEELS, load, NO_WHEELS, NO_WHEELS, friction)


def step(law, driver: DriverCommand, velocity: Wheels, imu=LEVEL_ROAD, friction=NO_WHEELS) -> WheelTorqueRequest:
    wheels = WheelStates(NO_WHEELS, velocity, NO_WHEELS)
    if isinstance(law, OpenDifferential):
        return law.step(driver)
    if isinstance(law, LoadProportional):
        return law.step(driver, imu)
    if isinstance(law, AdhesionShare):
        return law.step(driver, COLUMN, wheels, imu, tires(friction))
    return law.step(driver, wheels)


torques = st.floats(-1000.0, 1000.0)
speeds = st.floats(-100.0, 100.0)
frictions = st.floats(0.05, 1.2)
accelerations = st.floats(-8.0, 8.0)


@given(torque=torques, left=speeds, right=speeds, along=accelerations, across=accelerations)
@settings(max_examples=60, deadline=None)
@pytest.mark.parametrize("kind", SPLITTING)
def test_sum_of_torques_is_the_drivers(kind, torque, left, right, along, across):
    imu = InertialMeasurement(0.0, along, across)
    drive = step(law_of(kind), DriverCommand(torque, 0.0, 0.0), Wheels.front(left, right), imu).drive
    assert drive.front_left + drive.front_right == pytest.approx(torque, rel=1e-14, abs=1e-12)
    assert drive.rear_left == drive.rear_right == 0.0


@given(torque=torques, left=speeds, right=speeds, across=accelerations, grip=st.tuples(frictions, frictions))
@settings(max_examples=60, deadline=None)
@pytest.mark.parametrize("kind", [*SPLITTING, Adaptive, AdhesionShare])
def test_left_and_right_mirror_to_the_bit(kind, torque, left, right, across, grip):
    driver = DriverCommand(torque, 0.0, 0.0)
    here, there = law_of(kind), law_of(kind)
    for _ in range(3):  # some remember what they were answered
        one = step(here, driver, Wheels.front(left, right), InertialMeasurement(0.0, 0.0, across), Wheels.front(*grip))
        other = step(
            there, driver, Wheels.front(right, left), InertialMeasurement(0.0, 0.0, -across), Wheels.front(*grip[::-1])
        )
        assert (one.drive.front_left, one.drive.front_right) == (other.drive.front_right, other.drive.front_left)


@pytest.mark.parametrize("kind", [LimitedSlip, LimitedSlipVariable])
@pytest.mark.parametrize("torque", [800.0, -800.0])
@pytest.mark.parametrize("difference", [20.0, -20.0])
def test_locked_torques_are_as_3_to_2(kind, torque, difference):
    """K = M_slow/M_fast = 1.5 (section 3.3): 480 and 320 N m. A braking wheel is held back by the faster one."""
    drive = step(law_of(kind), DriverCommand(torque, 0.0, 0.0), Wheels.front(30.0 + difference, 30.0)).drive
    fast, slow = drive[:2] if difference > 0 else drive[1::-1]
    assert (slow, fast) == pytest.approx((480.0, 320.0) if torque > 0 else (-320.0, -480.0), rel=1e-14)


@pytest.mark.parametrize(("difference", "ratio"), [(0.0, 1.0), (2.5, 1.25), (4.0, 1.4), (5.0, 1.5), (50.0, 1.5)])
def test_variable_locking_grows_with_the_speed_difference(difference, ratio):
    """K = 1..1.5 (section 3.4), linear up to 5 rad/s (assumption)."""
    law = law_of(LimitedSlipVariable)
    drive = step(law, DriverCommand(800.0, 0.0, 0.0), Wheels.front(30.0, 30.0 + difference)).drive
    assert drive.front_left / drive.front_right == pytest.approx(ratio, rel=1e-14)


def test_constant_locking_is_smooth_around_equal_speeds():
    """At 0.5 rad/s tanh(1) of the locking share 0.2: 61 N m of 800 N m move."""
    drive = step(law_of(LimitedSlip), DriverCommand(800.0, 0.0, 0.0), Wheels.front(30.5, 30.0)).drive
    assert drive.front_right - 400.0 == pytest.approx(400.0 * 0.2 * math.tanh(1.0), rel=1e-12)


def test_open_differential_gives_no_wheel_more_than_its_motor():
    """360 N m x 7.4 = 2664 N m, and the other wheel gets no more."""
    drive = step(law_of(OpenDifferential), DriverCommand(9000.0, 0.0, 0.0), NO_WHEELS).drive
    assert drive == Wheels.front(2664.0, 2664.0)


def test_load_proportional_in_a_bend():
    """3 m/s^2 to the left: the loads m g b/(2 L) -+ k h m a_y/t, and with them the torques."""
    imu = InertialMeasurement(0.0, 0.0, 3.0)
    drive = step(law_of(LoadProportional), DriverCommand(1000.0, 0.0, 0.0), NO_WHEELS, imu).drive
    transfer = CAR.front_roll_share * CAR.centre_of_mass_height * CAR.mass * 3.0 / CAR.front_track
    left, right = LOADS.front_left - transfer, LOADS.front_right + transfer
    assert drive.front_left == pytest.approx(1000.0 * left / (left + right), rel=1e-12)


def refusing(law: Adaptive, driver: DriverCommand, left: float, right: float, steps: int) -> WheelTorqueRequest:
    """Torques [N m] that act on the front wheels throughout; the last request."""
    for _ in range(steps):
        request = law.step(driver, WheelStates(NO_WHEELS, NO_WHEELS, Wheels.front(left, right)))
    return request


def test_adaptive_offers_what_was_refused():
    """Share 500 N m, 300 N m act on the left: 200 N m go to the right, at once up to T/(T + tau) = 1/11 of them."""
    driver = DriverCommand(1000.0, 0.0, 0.0)
    law = law_of(Adaptive)
    assert refusing(law, driver, 300.0, 500.0, 1).drive == Wheels.front(500.0, 500.0)  # nothing was asked for before
    assert refusing(law, driver, 300.0, 500.0, 1).drive == pytest.approx(Wheels.front(500.0, 500.0 + 200.0 / 11))
    settled = refusing(law, driver, 300.0, 700.0, 1000).drive
    assert settled == pytest.approx(Wheels.front(500.0, 700.0))


def test_adaptive_when_both_refuse_offers_both():
    settled = refusing(law_of(Adaptive), DriverCommand(1000.0, 0.0, 0.0), 300.0, 400.0, 1000).drive
    assert settled == pytest.approx(Wheels.front(600.0, 700.0))


def test_adaptive_offers_nothing_while_braking_nor_on_the_road():
    braking = refusing(law_of(Adaptive), DriverCommand(1000.0, 50.0, 0.0), 300.0, 500.0, 1000)
    assert braking.drive == Wheels.front(500.0, 500.0)
    road = refusing(law_of(Adaptive, terrain="road"), DriverCommand(1000.0, 0.0, 0.0), 300.0, 500.0, 1000)
    assert road.drive == Wheels.front(500.0, 500.0)


@given(
    torque=st.floats(1.0, 3000.0),
    acting=st.lists(st.tuples(st.floats(-500.0, 2000.0), st.floats(-500.0, 2000.0)), min_size=2, max_size=30),
)
@settings(max_examples=60, deadline=None)
def test_adaptive_asks_no_wheel_for_more_than_both_shares(torque, acting):
    """Whatever acts: from its own share up to that of both wheels."""
    law, driver = law_of(Adaptive), DriverCommand(torque, 0.0, 0.0)
    for left, right in acting:
        drive = refusing(law, driver, left, right, 1).drive
        assert all(torque / 2 <= m <= torque * (1 + 1e-12) for m in drive[:2])


@given(torque=torques, left=frictions, right=frictions, factor=st.floats(0.2, 3.0))
@settings(max_examples=100, deadline=None)
def test_adhesion_share_stays_below_the_grip_and_in_proportion(torque, left, right, factor):
    """M_i <= factor phi_i F_i r (eq 1.2), M_left/M_right = phi_left/phi_right under equal loads."""
    law = law_of(AdhesionShare, error_factor=factor)
    drive = step(law, DriverCommand(torque, 0.0, 0.0), NO_WHEELS, friction=Wheels.front(left, right)).drive
    for place, friction in enumerate((left, right)):
        assert abs(drive[place]) <= factor * friction * LOADS[place] * 0.32 * (1 + 1e-14)
    assert drive.front_left * right == pytest.approx(drive.front_right * left, rel=1e-12, abs=1e-12)
    assert abs(sum(drive)) <= abs(torque) * (1 + 1e-14) + 1e-300  # below that a product keeps few digits


def test_adhesion_share_by_hand():
    """Snow left, asphalt right: all of 1000 N m at 1 : 2; of 9000 N m no more than both wheels can carry."""
    friction = Wheels.front(0.4, 0.8)
    drive = step(law_of(AdhesionShare), DriverCommand(1000.0, 0.0, 0.0), NO_WHEELS, friction=friction).drive
    assert drive == pytest.approx(Wheels.front(1000 / 3, 2000 / 3))
    grip = 0.32 * LOADS.front_left
    drive = step(law_of(AdhesionShare), DriverCommand(9000.0, 0.0, 0.0), NO_WHEELS, friction=friction).drive
    assert drive == pytest.approx(Wheels.front(0.4 * grip, 0.8 * grip))
    mistaken = law_of(AdhesionShare, error_factor=1.5)
    drive = step(mistaken, DriverCommand(9000.0, 0.0, 0.0), NO_WHEELS, friction=friction).drive
    assert drive == pytest.approx(Wheels.front(0.6 * grip, 1.2 * grip))


def test_estimated_friction_is_found_by_slipping():
    """The left wheel slips by a third while the road takes 0.4 F r of it; the right one rolls, and stays at 1.2."""
    law = law_of(AdhesionShare, friction="estimated")
    driver = DriverCommand(2000.0, 0.0, 0.0)
    road = 0.4 * LOADS.front_left * 0.32
    speeds = np.concatenate((np.full(100, 20.0), np.linspace(20.0, 30.0, 41), np.full(60, 30.0))).tolist()
    for before, left in pairwise(speeds):
        effort = Wheels.front(road + INERTIA * (left - before) / PERIOD, road)
        wheels = WheelStates(NO_WHEELS, Wheels(left, 20.0, 20.0, 20.0), effort)
        drive = law.step(driver, COLUMN, wheels, LEVEL_ROAD, tires(NO_WHEELS)).drive
    friction = law.state.estimate.friction
    assert friction.front_left == pytest.approx(0.4, rel=1e-3)
    assert friction.front_right == 1.2
    assert drive.front_left / drive.front_right == pytest.approx(friction.front_left / 1.2)
