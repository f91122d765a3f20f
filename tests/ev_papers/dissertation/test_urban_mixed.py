"""The urban cycle on mixed surfaces.

Efficiencies by hand, windows, figures, and the five differentials.
"""

from __future__ import annotations

import dataclasses
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from helpers.urban_runs import CAR, PARAMETERS, driven, parameters_of, scenario

from ev_core.vehicle.losses import loss_power
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_papers.dissertation.figures.urban_sheets import motors_and_cells, stretches
from ev_papers.dissertation.measures import circuits
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_papers.dissertation.measures.motors_and_cells import electrical_metrics
from ev_papers.dissertation.measures.slip_curve import first_passed_peak
from ev_sim.profiles.cycle_windows import MODES, TRACTION
from ev_sim.surfaces import RoadParameters, left_and_right
from ev_stack.measures.handling import share_of, surfaces_under
from ev_stack.measures.metric import NotMeasured
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import report_for

ROOT = Path(__file__).parents[3]
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
MOTOR = CAR.motor
# of one motor [W]
LOSS = MOTOR.copper_loss * 15**2 + MOTOR.inverter_torque_loss * 15 + MOTOR.iron_loss * 200
LOSS += MOTOR.eddy_loss * 200**2 + MOTOR.inverter_loss


def steady_run(rate: float = 0.0) -> Recording:
    """Four seconds of constant torque, force and slip of both front wheels.

    `rate` is their acceleration [rad/s^2].
    """
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
        channels[f"wheel_states.velocity.{wheel}"] = (
            (TURNING + rate * time) if front else ROLLING * ones
        )
        channels[f"wheel_states.effort.{wheel}"] = TORQUE * front * ones
        channels[f"tire_forces.longitudinal_force.{wheel}"] = FORCE * front * ones
        channels[f"motor_states.effort.{wheel}"] = 15.0 * front * ones
        channels[f"motor_states.velocity.{wheel}"] = 200.0 * front * ones
    return Recording(time, channels)


def circuits_of(run: Recording) -> dict[str, circuits.CircuitSums]:
    return circuits.circuits(run, CAR, cycle.traction(run, STEADY))


def test_wheel_sums_of_constant_slip():
    """Two seconds of traction: M 200 N m s, M_f = M - F r, 40 and 36 rad; eq 2.37: 0.8 x 0.9."""
    assert CAR.wheel_radius == 0.32
    for sums in circuits_of(steady_run()).values():
        assert (sums.torque, sums.turned, sums.free_turned) == pytest.approx((200.0, 40.0, 36.0))
        assert sums.resistance == pytest.approx(2.0 * (TORQUE - FORCE * 0.32))
        assert sums.speed_efficiency == pytest.approx(0.9)
        assert sums.efficiency == pytest.approx(FORCE_SHARE * 0.9)
        # nothing changes over time
        assert sums.power_efficiency == pytest.approx(FORCE_SHARE * 0.9)


def test_torque_that_turns_the_wheel_faster_is_no_resistance():
    """J w' is taken out of M_f: 5 rad/s^2 of 2.75 kg m^2 over 2 s are 27.5 N m s."""
    still, faster = (circuits_of(steady_run(rate))["front_left"] for rate in (0.0, 5.0))
    assert still.resistance - faster.resistance == pytest.approx(INERTIA * 5.0 * 2.0)
    assert pytest.approx(2.753, abs=5e-4) == INERTIA


def test_energies_of_constant_power():
    """15 N m x 200 rad/s for 2 s at each shaft, motor losses, F r (w - w_free) at both tyres."""
    run = steady_run()
    for sums in circuits_of(run).values():
        assert sums.shaft_work == pytest.approx(6e3)
        assert sums.electrical_work == pytest.approx(6e3 + 2.0 * LOSS)
        assert sums.drive_efficiency == pytest.approx(3e3 / (3e3 + LOSS))
        assert sums.total_efficiency == pytest.approx(sums.efficiency * sums.drive_efficiency)
    assert circuits.slip_energy(run, CAR, cycle.traction(run, STEADY)) == pytest.approx(
        2 * FORCE * 0.32 * 2.0 * 2.0
    )


def test_energy_as_printed_is_mean_power_times_the_time_of_the_cycle():
    """Eq 2.40: 2 s of traction in a cycle of 580 s count 290 times what was taken."""
    sums = circuits_of(steady_run())["front_left"]
    assert sums.energy(580.0) == pytest.approx(290.0 * sums.electrical_work)
    assert cycle.cycle_time(PARAMETERS["driver"]) == 580.0


def test_released_pedal_and_other_windows_do_not_count():
    """The sample answers for the period before it: the pedal of 1.00 s acts until 1.01 s."""
    run = steady_run()
    pressed = run.channels["driver.command.drive_torque"].copy()
    pressed[200:] = 0.0
    run = Recording(run.time, {**run.channels, "driver.command.drive_torque": pressed})
    inside = cycle.traction(run, STEADY)
    assert run.time[inside].tolist() == pytest.approx(np.arange(101, 201) * 0.01)
    assert circuits_of(run)["front_left"].torque == pytest.approx(100.0)
    whole = circuits.circuits(run, CAR, cycle.in_windows(run, STEADY))["front_left"]
    assert (whole.torque, whole.time) == pytest.approx((200.0, 2.0))


def test_running_efficiency_ends_at_that_of_the_cycle():
    run = steady_run(2.0)
    shares, counted = circuits.circuit_shares(run, CAR)["front_left"], cycle.traction(run, STEADY)
    for running, whole in (
        (shares.running_efficiency(counted), shares.sums(counted).efficiency),
        (shares.running_drive_efficiency(counted), shares.sums(counted).drive_efficiency),
    ):
        assert np.isnan(running[:100]).all()
        assert running[-1] == pytest.approx(whole, rel=1e-12)
        assert np.ptp(running[301:]) == 0.0


def test_four_driven_wheels_leave_none_to_measure_slip_with():
    with pytest.raises(NotMeasured, match="no free wheel beside front_left"):
        circuits.circuit_shares(steady_run(), dataclasses.replace(CAR, driven_wheels=WHEEL_NAMES))


def test_metrics_by_hand():
    found = report_for("urban_mixed").metrics(
        {"urban_mixed": steady_run()}, CAR, {"driver": STEADY}
    )
    value = {name: metric.value for name, metric in found.items()}
    wheel, drive, energy = FORCE_SHARE * 0.9, 3e3 / (3e3 + LOSS), 4.0 * (3e3 + LOSS)
    for row in ("", "_right", "_left"):
        assert (
            value[f"wheel_efficiency{row}"]
            == value[f"wheel_efficiency_windows{row}"]
            == pytest.approx(wheel)
        )
        assert value[f"wheel_speed_efficiency{row}"] == pytest.approx(0.9)
        assert value[f"drive_efficiency{row}"] == pytest.approx(drive)
        assert value[f"total_efficiency{row}"] == pytest.approx(wheel * drive)
    assert (value["energy"], value["energy_windows"]) == pytest.approx((energy, energy))
    # Eq 2.40: mean power of 2 s times the time of a cycle that ends at 0 s.
    assert value["energy_as_printed"] == value["energy_as_printed_in_kwh"] == 0.0
    assert (value["traction_time"], value["window_time"]) == pytest.approx((2.0, 2.0))
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


def test_windows_cover_the_cycle_with_355_2_s_of_traction():
    """Section 2.6: 19 windows on the 580 s of the cycle.

    The sum of traction is that of the windows it prints.
    """
    driver = PARAMETERS["driver"]
    begin, mode = list(driver["modes.begin"]), list(driver["modes.mode"])
    assert len(begin) == 19 and begin[0] == 0.0
    ends = [*begin[1:], 580.0]
    assert sum(
        e - b for b, e, m in zip(begin, ends, mode, strict=True) if m == "traction"
    ) == pytest.approx(355.2)
    time = np.arange(116001) * PERIOD
    found = stretches(time, cycle.modes_over_time(Recording(time, {}), driver))
    assert [m for _, _, m in found] == mode
    assert sum(end - start for start, end, m in found if m == MODES[TRACTION]) == pytest.approx(
        355.2, abs=1e-6
    )


@pytest.mark.parametrize("side", [0, 1])
def test_surfaces_come_back_from_the_friction_under_the_wheels(side):
    """Against the drawn segments, by the distance of the front axle.

    A sample may lie on either side of a border.
    """
    run, wheel = driven("imposed_speed"), ("front_left", "front_right")[side]
    road = {
        name.removeprefix("road."): v
        for name, v in PARAMETERS["plant"].items()
        if name.startswith("road.")
    }
    segments = left_and_right(RoadParameters(**road))[side]
    ahead = CAR.wheelbase - CAR.centre_of_mass_to_rear_axle
    expected = np.array([segments.at(x + ahead) for x in run.channels["pose.x"].tolist()])
    found = surfaces_under(run, CAR, wheel)
    assert np.count_nonzero(found != expected) <= len(segments.start)
    distance = run.channels["pose.x"][-1]
    edges = np.clip(
        [0.0, *(start - ahead for start in segments.start[1:]), math.inf], 0.0, distance
    )
    lengths = [b - a for a, b in pairwise(edges)]
    snow = sum(
        part
        for part, name in zip(lengths, segments.surface, strict=True)
        if name == "packed_snow_1"
    )
    # One sample at each of some twenty borders, 0.07 m each, of 400 m.
    assert share_of(run, CAR, wheel, "packed_snow") == pytest.approx(
        snow / distance, abs=20 * 0.07 / 400
    )


# The drivers


@pytest.mark.parametrize("driver", DRIVERS)
def test_every_metric_is_measured(driver):
    found = report_for("urban_mixed").metrics(
        {"urban_mixed": driven(driver)}, CAR, parameters_of(scenario(driver))
    )
    assert {name: metric.verdict for name, metric in found.items()} == dict.fromkeys(
        found, "measured"
    )
    for name, metric in found.items():
        if "efficiency" in name or "share" in name:
            assert 0.0 < metric.value < 1.0, name


@pytest.mark.parametrize("driver", ["pulse", "imposed_speed"])
def test_circuits_take_what_the_battery_gives(driver):
    """Losses at the samples against those of the plant's steps.

    Within 0.5 %, for torques change within a period.
    """
    run = driven(driver)
    inside = cycle.traction(run, PARAMETERS["driver"])
    taken = sum(of.electrical_work for of in circuits.circuits(run, CAR, inside).values())
    given = float(
        (circuits.battery_power(run) * np.diff(run.time, prepend=run.time[0]))[inside].sum()
    )
    assert taken == pytest.approx(given, rel=0.005)


@pytest.mark.parametrize("driver", DRIVERS)
def test_metrics_are_the_printed_formulas(driver):
    """Eqs 2.37, 2.38 and 2.40 of the samples themselves, as printed: sums over n, not integrals.

    To 1e-12.
    """
    run = driven(driver)
    inside = cycle.traction(run, PARAMETERS["driver"])
    for wheel, sums in circuits.circuits(run, CAR, inside).items():
        free = f"rear_{wheel.partition('_')[2]}"
        at = {name: values[inside] for name, values in run.channels.items()}
        torque, speed = at[f"wheel_states.effort.{wheel}"], at[f"wheel_states.velocity.{wheel}"]
        gained = (
            np.diff(run.channels[f"wheel_states.velocity.{wheel}"], prepend=0.0)[inside]
            / PERIOD
            * INERTIA
        )
        rolling = torque - CAR.wheel_radius * at[f"tire_forces.longitudinal_force.{wheel}"] - gained
        shares = (
            (torque.sum() - rolling.sum()) / torque.sum(),
            at[f"wheel_states.velocity.{free}"].sum() / speed.sum(),
        )
        # The period is that of the stamps; their differences keep twelve digits at 580 s.
        assert sums.efficiency == pytest.approx(shares[0] * shares[1], rel=1e-10)
        motor, shaft = at[f"motor_states.effort.{wheel}"], at[f"motor_states.velocity.{wheel}"]
        power = motor * shaft + loss_power(MOTOR, motor, shaft)
        assert sums.drive_efficiency == pytest.approx(
            (motor * shaft).sum() / power.sum(), rel=1e-10
        )
        assert sums.energy(580.0) == pytest.approx(power.sum() * 580.0 / len(power), rel=1e-10)


# Figures


@pytest.mark.parametrize("driver", ["pulse", "imposed_speed"])
def test_figures_have_quantities_and_units(driver):
    from ev_stack.figures.sheets import drawn

    figures = drawn(
        report_for("urban_mixed").figures({"urban_mixed": driven(driver)}, CAR, PARAMETERS)
    )
    assert list(figures) == FIGURES
    for name, figure in figures.items():
        for axes in figure.axes:
            is_strip = axes.get_title(loc="left").startswith(
                ("Under the front", "Windows of the cycle")
            )
            assert is_strip or axes.get_ylabel().endswith("]")
            assert not any("not measured" in text.get_text() for text in axes.texts), name
        assert figure.axes[-1].get_xlabel().endswith("]")
    samples = max(len(line.get_xdata()) for line in figures["figure_5_electrical"].axes[0].lines)
    assert samples < len(driven(driver).time) / 2


def test_motors_and_cells_are_shown_where_they_are_modelled():
    """Two seconds with a winding above its warm temperature.

    Without these channels there are no such numbers.
    """
    time = np.arange(200) * 0.05
    hot = CAR.motor.thermal.winding_warm + 1.0
    channels = {
        f"{quantity}.{wheel}": np.full(200, 40.0)
        for quantity in (
            "motor_electrics.current", "motor_electrics.voltage", "motor_electrics.power", "motor_temperatures.winding",
            "motor_temperatures.inverter", "motor_temperatures.coolant_outlet",
        )
        for wheel in CAR.driven_wheels
    }  # fmt: skip
    channels["motor_temperatures.winding.front_left"] = np.where(
        (time > 3.0) & (time < 5.02), hot, 40.0
    )
    channels |= {
        "battery.cell.voltage": 3.3 - 0.01 * time,
        "battery.cell.temperature": 25.0 + 0.1 * time,
    }
    report, run = report_for("urban_mixed"), Recording(time, channels)
    metrics = report.metrics({"urban_mixed": run}, CAR, {"driver": {}})
    assert metrics["derated_time"].value == pytest.approx(2.0)
    assert metrics["peak_winding_temperature"].value == hot
    assert metrics["least_cell_voltage"].value == pytest.approx(3.3 - 0.01 * 9.95)
    sheet = motors_and_cells(run, CAR, {})
    assert all(
        panel.curves and not panel.note and panel.ylabel.endswith("]") for panel in sheet.panels
    )
    assert electrical_metrics(Recording(time, {}), CAR) == {}


@pytest.mark.weekly
@pytest.mark.slow
def test_figures_say_what_is_missing(tmp_path):
    """No cycle, no tyre forces, all wheels driven: drawn, with the reason in place of curves."""
    from ev_stack.figures.saving import save_figures
    from ev_stack.figures.sheets import drawn

    few = Recording(
        np.arange(200) * PERIOD,
        {"twist.longitudinal": np.zeros(200), "twist.lateral": np.zeros(200)},
    )
    for car in (
        CAR,
        dataclasses.replace(CAR, driven_wheels=WHEEL_NAMES),
        dataclasses.replace(CAR, driven_wheels=()),
    ):
        figures = drawn(
            report_for("urban_mixed").figures({"urban_mixed": few}, car, {"driver": {}})
        )
        assert list(figures) == FIGURES
        for name, figure in figures.items():
            assert any(
                "not measured" in text.get_text() for axes in figure.axes for text in axes.texts
            ), name
    assert len(save_figures(figures, tmp_path)) == len(FIGURES)


def spinning_up(a: float, b: float) -> Recording:
    """A wheel with slip up to 0.2 in 0.4 s; the road takes y = a x + b sqrt(x) of the torque."""
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
            "wheel_states.effort.front_left": nominal * (a * mean + b * np.sqrt(mean))
            + INERTIA * rate,
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
