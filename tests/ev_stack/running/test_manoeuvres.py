"""The scenarios of a test engineer: physics, power balance, and independence of the step."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from helpers.adaptive_reference import DrivenPlant, end_of_run
from helpers.manoeuvres import MANOEUVRES
from plant.planar.car import kinetic_energy

from ev_core.vehicle.description import Vehicle
from ev_sim.plant.planar.planar_state import index
from ev_sim.plant.planar.prepare import number_of_steps
from ev_stack.measures.motion import lateral_acceleration_on_path
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording
from ev_stack.report.reports import report_for
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

pytestmark = pytest.mark.slow

PERIOD = 0.01
CASES = [(scenario, run.name) for scenario in MANOEUVRES for run in load_scenario(scenario).runs]
# The adaptive solver restarts with every command: on lines, which have no limit to come to, less
# than all will do, and one of the circles goes beyond its limit.
CUT = {
    ("steady_circle", "linear"): 15.0,
    ("steady_circle", "friction"): 15.0,
    ("steady_circle", "constant_radius_linear"): 15.0,
    ("steady_circle", "constant_radius_friction"): 50.0,
    ("coast_down", "coast_down"): 1.0,
}


@cache
def driven(
    scenario: str, name: str, halved: bool = False, cut: float | None = None
) -> tuple[Recording, DrivenPlant]:
    """The signals of a run and its plant at the end."""
    step = [("plant", "step", 0.5e-3)] if halved else []
    run = next(r for r in load_scenario(scenario, Overrides((), step, cut)).runs if r.name == name)
    return drive(run)


def drive(run: Run) -> tuple[Recording, DrivenPlant]:
    recording = run_offline(run.configurations, run.duration)
    return recording, DrivenPlant(run.configurations["plant"], recording)


@cache
def metrics_of(scenario: str) -> dict[str, float | None]:
    loaded = load_scenario(scenario)
    runs = {run.name: driven(scenario, run.name)[0] for run in loaded.runs}
    vehicle = loaded.runs[0].configurations["plant"].common.vehicle
    found = report_for(loaded.runs[0].report).metrics(runs, vehicle, {}, loaded.parameters.course)
    return {name: metric.value for name, metric in found.items()}


def deviations(recording: Recording, state: np.ndarray, reference: np.ndarray) -> dict[str, float]:
    """Differences of two last states over the way and the largest speeds of the run [1]."""

    def largest(*channels: str) -> float:
        return max(float(np.abs(recording.channels[channel]).max()) for channel in channels)

    speed, length = largest("twist.longitudinal", "twist.lateral"), largest("pose.x", "pose.y")
    scales = {
        "longitudinal_velocity": speed,
        "lateral_velocity": speed,
        "yaw_rate": max(largest("twist.yaw_rate"), 1e-3),
        "heading": 1.0,
        "x": length,
        "y": length,
        "battery_work": max(abs(reference[index("battery_work")]), 1.0),
    }
    return {
        entry: abs(state[index(entry)] - reference[index(entry)]) / scale
        for entry, scale in scales.items()
    }


@pytest.mark.parametrize(("scenario", "name"), CASES)
@pytest.mark.sampled
def test_halving_the_step_keeps_the_end_of_the_run(scenario, name):
    """Less than 0.1 % of the way and of the largest speeds at its end.

    Measured is 8e-6 at most, in a spin.
    """
    recording, coarse = driven(scenario, name)
    _, fine = driven(scenario, name, halved=True)
    steps_of = [
        number_of_steps(plant.parameters, plant.vehicle, plant.period) for plant in (coarse, fine)
    ]
    assert steps_of[1] == 2 * steps_of[0]
    found = deviations(recording, coarse.state, fine.state)
    assert max(found.values()) < 1e-3, found


@pytest.mark.parametrize(("scenario", "name"), CASES)
@pytest.mark.weekly
def test_an_adaptive_solver_ends_the_run_alike(scenario, name):
    """DOP853 at a relative tolerance of 1e-9 under the same commands.

    Promised are 0.1 %, a tenth is asked here.

    Measured are 2e-5 in the spin of `times_5_0` and beyond the limit of the circle, 2e-6 where a
    wheel spins on ice, below 1e-6 else: no run is chaotic. Torques taken at the beginning of a step
    instead of their mean over it would show, as 1.4e-4 in a launch.
    """
    recording, plant = driven(scenario, name, cut=CUT.get((scenario, name)))
    found = deviations(recording, plant.state, end_of_run(plant))
    assert max(found.values()) < 1e-4, found


@pytest.mark.sampled
@pytest.mark.parametrize(("scenario", "name"), CASES)
def test_power_balance_closes(scenario, name):
    """Battery = losses + drives; drives = kinetic + tyres + resistance, within 0.1 %."""
    _, end = driven(scenario, name)

    def work(entry: str) -> float:
        return float(end.state[index(entry)])

    battery = (
        work("motor_loss") + work("driveline_loss") + work("auxiliary_work") + work("drive_work")
    )
    sinks = [work(f"{kind}_work") for kind in ("tyre", "friction", "drag", "gravity")]
    gain = kinetic_energy(end.state, end.vehicle) - kinetic_energy(end.start, end.vehicle)
    flow = max(abs(gain), abs(work("drive_work")), *map(abs, sinks))
    assert work("battery_work") == pytest.approx(battery, rel=1e-3, abs=1e-3 * flow)
    assert work("drive_work") == pytest.approx(gain + sum(sinks), rel=0, abs=1e-3 * flow)


@pytest.mark.parametrize("scenario", MANOEUVRES)
def test_every_metric_is_measured(scenario):
    assert [name for name, value in metrics_of(scenario).items() if value is None] == []


@pytest.mark.parametrize("name", ["forward", "backward"])
def test_hill_start(name):
    """Held on 20 % for a minute within 1 mm, no roll-back; the slip keeps its sign."""
    metrics = metrics_of("hill_start")
    assert metrics[f"{name}_holding_time"] >= 60.0
    assert metrics[f"{name}_movement_while_holding"] < 1e-3
    assert metrics[f"{name}_roll_back"] < 1e-3
    assert metrics[f"{name}_slip_sign_changes"] == 0


@pytest.mark.parametrize("surface", ["dry_asphalt", "ice"])
@pytest.mark.parametrize("torque", [400.0, -400.0])
def test_pull_away_slip_keeps_its_sign(surface, torque):
    """625 N at each front wheel on the level: more than ice carries, little on dry asphalt."""
    values = [
        ("plant", "road.grade", [0.0]),
        ("plant", "road.left", [surface]),
        ("plant", "road.right", [surface]),
        ("driver", "pedals.time", [0.0, 0.2]),
        ("driver", "pedals.brake_torque", [0.0, 0.0]),
        ("driver", "pedals.drive_torque", [0.0, torque]),
    ]
    recording, _ = drive(load_scenario("hill_start", Overrides((), values, 4.0)).runs[0])
    for wheel in ("front_left", "front_right"):
        force = recording.channels[f"tire_forces.longitudinal_force.{wheel}"]
        slip = recording.channels[f"tire_forces.slip_ratio.{wheel}"]
        assert (slip * math.copysign(1.0, torque) >= 0.0).all()
        assert (force * math.copysign(1.0, torque) >= 0.0).all()


def test_coast_down_gives_the_road_load_back():
    """Slip of free-rolling wheels and the central differences of a second leave less than 0.1 %."""
    metrics, vehicle = metrics_of("coast_down"), Vehicle()
    assert metrics["rolling_resistance"] == pytest.approx(vehicle.rolling_resistance, rel=1e-3)
    assert metrics["drag_area"] == pytest.approx(
        vehicle.drag_coefficient * vehicle.frontal_area, rel=1e-3
    )


def test_step_steer_is_the_same_to_the_left_and_to_the_right():
    metrics = metrics_of("step_steer")
    for name in (
        "yaw_rate_response_time",
        "yaw_rate_overshoot",
        "yaw_rate_gain",
        "sideslip_angle_gain",
    ):
        assert metrics[f"left_{name}"] == metrics[f"right_{name}"]
    # what ISO 7401 prefers
    assert metrics["left_lateral_acceleration"] == pytest.approx(4.0, rel=0.05)


def test_steady_circle_agrees_with_the_closed_form():
    """K = m (b/C_f - a/C_r)/L within 5 %.

    The drive forces of the front wheels pull the car inwards, 1 % of 2500 N.
    """
    metrics = metrics_of("steady_circle")
    mass, length, rear_arm = (
        Vehicle().mass,
        Vehicle().wheelbase,
        Vehicle().centre_of_mass_to_rear_axle,
    )
    gradient = mass / length * (rear_arm / 90e3 - (length - rear_arm) / 130e3)
    assert metrics["linear_understeer_gradient"] == pytest.approx(gradient, rel=0.05)
    sideslip = -mass * (length - rear_arm) / (130e3 * length)
    assert metrics["linear_sideslip_gradient"] == pytest.approx(sideslip, rel=0.01)


@pytest.mark.parametrize(("tyres", "band"), [("linear", 0.01), ("friction", 0.05)])
def test_both_methods_for_the_steady_circle_agree(tyres, band):
    """The understeer gradient is one of the car.

    Measured are 0.2 % with linear tyres and 2 % with real ones.

    Real tyres give no straight line over the acceleration, and both the samples along it and the
    drive forces differ between the circle of 40 m and that of 50 m, which widens to 53 m.
    """
    metrics = metrics_of("steady_circle")
    for name in ("understeer_gradient", "sideslip_gradient"):
        fixed, constant_radius = (
            metrics[f"{tyres}_{name}"],
            metrics[f"constant_radius_{tyres}_{name}"],
        )
        assert constant_radius == pytest.approx(fixed, rel=band), name


def test_each_method_for_the_steady_circle_has_its_figure():
    """A scenario may have runs of one method only."""
    loaded = load_scenario("steady_circle", Overrides((), [], 2.0)).runs
    runs = {run.name: drive(run)[0] for run in loaded}
    report, vehicle = report_for("steady_circle"), Vehicle()
    assert list(report.figures(runs, vehicle, {})) == ["steady_circle", "constant_radius", "path"]
    alone = {"constant_radius_linear": runs["constant_radius_linear"]}
    assert list(report.figures(alone, vehicle, {})) == ["constant_radius", "path"]


@pytest.mark.parametrize("tyres", ["linear", "friction"])
def test_constant_radius_is_kept(tyres):
    """ISO 4138 allows 0.5 m off the circle, here of 40 m radius about (10, 40).

    Judged as the gradients, to 4 m/s^2.
    """
    recording, _ = driven("steady_circle", f"constant_radius_{tyres}")
    radius = np.hypot(recording.channels["pose.x"] - 10.0, recording.channels["pose.y"] - 40.0)
    acceleration = lateral_acceleration_on_path(recording)
    judged = slice(int((acceleration > 0.5).argmax()), int((acceleration > 4.0).argmax()))
    assert np.abs(radius[judged] - 40.0).max() < 0.5


def test_lane_change_leaves_all_cones_standing():
    metrics = metrics_of("double_lane_change")
    assert metrics["cones_hit"] == 0
    assert metrics["exit_speed"] == pytest.approx(80 / 3.6, rel=0.01)


def test_a_car_beside_its_lane_hits_the_cones_of_one_row():
    """Straight on at y = 2 m its body covers 1.16 to 2.84 m.

    The right row of lane 2 (2.37 m), the left one of 3.
    """
    values = [
        ("plant", "initial_y", 2.0),
        ("driver", "path.x", [-50.0, 200.0]),
        ("driver", "path.y", [2.0, 2.0]),
    ]
    recording, _ = drive(load_scenario("double_lane_change", Overrides((), values)).runs[0])
    course = load_scenario("double_lane_change").parameters.course
    found = report_for("double_lane_change").metrics({"run": recording}, Vehicle(), {}, course)
    assert (found["cones_hit"].value, found["course_passed"].value) == (8, 0)


def test_sine_with_dwell_multiples_of_a():
    """Amplitudes are the multiples in their names of the A that the first run gives."""
    metrics = metrics_of("sine_with_dwell")
    for name, multiple in (
        ("times_1_5", 1.5),
        ("times_2_5", 2.5),
        ("times_3_5", 3.5),
        ("times_5_0", 5.0),
    ):
        assert metrics[f"{name}_amplitude_over_a"] == pytest.approx(multiple, rel=0.01)
    assert metrics["times_1_5_passed"] == 1
    assert metrics["times_5_0_passed"] == 0  # without stability control


def test_split_friction():
    """Steering holds the car that spins with a fixed steering wheel.

    Wheels on snow lock, on asphalt they do not.
    """
    metrics = metrics_of("straight_brake_split_mu")
    assert (
        metrics["steered_peak_yaw_deviation"] < 0.2 < metrics["fixed_steering_peak_yaw_deviation"]
    )
    assert metrics["steered_front_left_locked"] > 50.0
    assert metrics["steered_front_right_locked"] == 0.0
    launch = metrics_of("launch_split_mu")
    assert launch["steered_peak_yaw_deviation"] < launch["fixed_steering_peak_yaw_deviation"]
    assert launch["steered_front_left_peak_slip"] > 0.9
    assert launch["steered_front_right_peak_slip"] < 0.2


def test_plant_notes_refused_commands_and_lifted_wheels():
    """Each text once, counts by powers of ten as of the end.

    The launch asks 7500 N m of motors that have 5328 N m.
    """
    too_much = [("driver", "pedals.drive_torque", [0.0, 0.0, 7500.0])]
    run = load_scenario("launch_split_mu", Overrides((), too_much, 2.0)).runs[0]
    notes = []
    run_offline(
        run.configurations, run.duration, note=lambda role, text: notes.append((role, text))
    )
    assert notes == [("plant", "100 or more values of commands were out of range")]
    high = [("*", "vehicle.centre_of_mass_height", 2.0)]
    run = load_scenario("double_lane_change", Overrides((), high, 4.0)).runs[0]
    run_offline(
        run.configurations, run.duration, note=lambda role, text: notes.append((role, text))
    )
    assert any("left the ground" in text for _, text in notes)
