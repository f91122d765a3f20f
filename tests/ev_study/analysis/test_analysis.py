"""Linear models of the steering car against independent derivations."""

from __future__ import annotations

import dataclasses
import math
import warnings

import numpy as np
import pytest
from helpers.compiled_object import CompiledObject
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import StateSpace, lsim

from ev_core.lockstep.finding import find_method
from ev_core.parameters.data_file import files_in_config
from ev_core.vehicle.battery import Battery
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.motor import Motor
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_sim.plant.planar.planar import PlanarPlantParameters
from ev_sim.plant.planar.planar_state import VY, YAW_RATE
from ev_sim.understeer import (
    axle_cornering_stiffnesses,
    characteristic_speed,
    critical_speed,
    understeer_gradient,
)
from ev_stack.scenarios.files import vehicle_of
from ev_study.analysis.__main__ import main as analyse
from ev_study.analysis.__main__ import print_over_speed
from ev_study.analysis.linear_models import SideSlipModel, single_track, yaw_damping
from ev_study.analysis.linearised_plant import OperatingPoint, linearised

CAR = SideSlipModel(
    wheelbase=2.7, mass=2400.0, yaw_inertia=4200.0, axle_cornering_stiffness=120e3, speed=7.0
)
GE_NI = Vehicle(
    mass=2500.0,
    wheelbase=1.72,
    centre_of_mass_to_rear_axle=0.82,
    tyre=Tyre(
        combined="uncoupled",
        lateral_curve="linear",
        front_cornering_stiffness=10500.0,
        rear_cornering_stiffness=12000.0,
    ),
)


def state_space(car: SideSlipModel) -> StateSpace:
    """States and outputs d1, d2, input Theta, all in rad (eqs 1 and 2)."""
    length, speed = car.wheelbase, car.speed
    turn, growth = speed / length, car.longitudinal_acceleration / speed
    lever = length**2 / (4 * car.yaw_inertia)
    same, cross = 1 / car.mass + lever, 1 / car.mass - lever
    stiffness, force = (
        car.axle_cornering_stiffness / speed,
        car.front_share * car.drive_force / speed,
    )
    moment = car.moment_rate / 2
    a = [
        [-turn - stiffness * same - growth - moment, turn - stiffness * cross + moment],
        [-turn - stiffness * cross + moment, turn - stiffness * same - growth - moment],
    ]
    b = [[turn + growth - force * same + moment], [turn - force * cross - moment]]
    return StateSpace(np.array(a), np.array(b), np.eye(2), np.zeros((2, 1)))


def magnitude(car: SideSlipModel, frequency: np.ndarray) -> np.ndarray:
    """|W12(j w)| [1] at circular frequencies [rad/s] (eq 3)."""
    return abs(car.excitation) / np.hypot(frequency, car.damping)


def neutral_front_share(car: SideSlipModel) -> float:
    """Front share h that makes the car steer neutrally without M_z.

    2 J_z j cos(phi)/(L^2 X) [1] (eq 4).
    """
    return (
        2 * car.yaw_inertia * car.longitudinal_acceleration / (car.wheelbase**2 * car.drive_force)
    )


def neutral_rear_difference(car: SideSlipModel) -> float:
    """Difference q of the rear shares for neutral steering at this h < 1 (eq 7) [1]."""
    needed = car.excitation + car.moment_rate
    rear_moment = (1 - car.front_share) * car.drive_force * car.rear_track
    return needed * car.yaw_inertia * car.yaw_rate / rear_moment


def slip_angle_rates(
    car: SideSlipModel, d1: float, d2: float, theta: float, moment: float
) -> np.ndarray:
    """d1', d2' [rad/s] from force and moment balance of v and r at a held steering angle.

    None of the model's terms.
    """
    half, speed = car.wheelbase / 2, car.speed
    v, r = speed * ((theta - d1) - d2) / 2, speed * ((theta - d1) + d2) / car.wheelbase
    front = car.axle_cornering_stiffness * d1 + car.front_share * car.drive_force * theta
    rear = car.axle_cornering_stiffness * d2
    v_rate = (front + rear) / car.mass - speed * r
    r_rate = (half * front - half * rear - moment) / car.yaw_inertia
    growth = car.longitudinal_acceleration / speed**2
    return np.array(
        [
            -(v_rate + half * r_rate) / speed + (v + half * r) * growth,
            -(v_rate - half * r_rate) / speed + (v - half * r) * growth,
        ]
    )


cars = st.builds(
    SideSlipModel,
    wheelbase=st.floats(1.5, 4.0),
    mass=st.floats(800.0, 3000.0),
    yaw_inertia=st.floats(500.0, 6000.0),
    axle_cornering_stiffness=st.floats(2e4, 3e5),
    speed=st.floats(3.0, 40.0),
    longitudinal_acceleration=st.floats(-5.0, 5.0),
    drive_force=st.floats(100.0, 4000.0),
    front_share=st.floats(0.0, 0.5),
    rear_difference=st.floats(0.0, 0.6),
    yaw_rate=st.floats(0.05, 1.0),
)
angles = st.floats(-0.1, 0.1)


@given(car=cars, d1=angles, d2=angles, theta=angles)
def test_model_is_newton_euler(car, d1, d2, theta):
    """Eqs 1 and 2 with M_z = m_z J_z r against the turn.

    To 1e-9 of the largest rate that a term may have.
    """
    system = state_space(car)
    yaw_rate = car.speed / car.wheelbase * (theta + d2 - d1)
    expected = slip_angle_rates(car, d1, d2, theta, car.moment_rate * car.yaw_inertia * yaw_rate)
    rates = system.A @ (d1, d2) + system.B[:, 0] * theta
    assert rates == pytest.approx(expected, rel=1e-9, abs=1e-9 * 0.1 * abs(system.A).max())
    difference = -car.damping * (d2 - d1) + car.excitation * theta
    assert difference == pytest.approx(
        expected[1] - expected[0], rel=1e-9, abs=1e-9 * 0.1 * abs(system.A).max()
    )


@settings(max_examples=30)
@given(car=cars, frequency=st.floats(0.1, 100.0))
def test_transfer_function_is_that_of_both_slip_angles(car, frequency):
    """W12 from the matrices of eqs 1 and 2 at one frequency, to 1e-9 of their own size."""
    system = state_space(car)
    response = np.linalg.solve(1j * frequency * np.eye(2) - system.A, system.B[:, 0])
    _, w12 = car.transfer_function().freqresp([frequency])
    assert abs(w12[0] - (response[1] - response[0])) < 1e-9 * (1 + abs(response).max())
    assert magnitude(car, np.array([frequency]))[0] == pytest.approx(abs(w12[0]), rel=1e-12)


def test_neutral_front_share():
    """X = 2400 N drives 2400 kg with 1 m/s^2: h = 2 J_z/(m L^2) = 0.480, where W12 vanishes."""
    driven = dataclasses.replace(CAR, drive_force=2400.0, longitudinal_acceleration=1.0)
    neutral = dataclasses.replace(driven, front_share=neutral_front_share(driven))
    assert neutral.front_share == pytest.approx(2 * 4200 / (2400 * 2.7**2), rel=1e-14)
    assert magnitude(neutral, np.array([0.0, 1.0, 10.0])) == pytest.approx(0.0, abs=1e-15)
    assert driven.excitation < 0.0 < dataclasses.replace(driven, front_share=0.5).excitation


def test_a_car_that_steers_neutrally_has_a_transfer_function():
    """N = 0 is a gain like any other.

    As a polynomial it would be a numerator without coefficients, with a warning.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _, response = CAR.transfer_function().freqresp([0.1, 1.0])
    assert CAR.excitation == 0.0
    assert response.tolist() == [0.0, 0.0]


def test_neutral_rear_difference_is_the_law_for_the_rear_wheels():
    """Eq 7 at j = 0, r = V Theta/L gives q = L Theta h/(2 B (1 - h)), as axle_redistribution."""
    theta, h = 0.1, 0.4
    car = dataclasses.replace(
        CAR, drive_force=3000.0, front_share=h, yaw_rate=CAR.speed * theta / CAR.wheelbase
    )
    assert neutral_rear_difference(car) == pytest.approx(
        2.7 * theta * h / (2 * 1.5 * (1 - h)), rel=1e-12
    )
    balanced = dataclasses.replace(car, rear_difference=neutral_rear_difference(car))
    assert abs(balanced.excitation) < 1e-12 * balanced.moment_rate


def test_dropped_steering_rate_is_what_separates_w12_from_the_car():
    """The car's d1' has + Theta' too: (N - j w)/(D + j w), more than W12 at any w."""
    frequency, force = 5.0, 0.4 * 2000.0
    _, w12 = (
        dataclasses.replace(CAR, drive_force=2000.0, front_share=0.4)
        .transfer_function()
        .freqresp([frequency])
    )
    half, v_over, k = 1.35, 7.0, 120e3
    a = np.array([[-2 * k / (2400 * v_over), -v_over], [0.0, -2 * half**2 * k / (4200 * v_over)]])
    b = np.array([(k + force) / 2400, half * (k + force) / 4200])
    _, r = np.linalg.solve(1j * frequency * np.eye(2) - a, b)
    complete = 2.7 * r / v_over - 1
    model = dataclasses.replace(CAR, drive_force=2000.0, front_share=0.4)
    assert complete == pytest.approx(
        model.response_with_steering_rate(np.array([frequency]))[0], rel=1e-12
    )
    assert complete == pytest.approx(
        w12[0] - 1j * frequency / (CAR.damping + 1j * frequency), rel=1e-12
    )


def test_understeer_of_ge_and_ni():
    """m_1/C_1 - m_2/C_2 = 2.248e-3 rad s^2/m, v_ch = sqrt(1.72/2.248e-3) = 27.66 m/s."""
    assert axle_cornering_stiffnesses(GE_NI) == (21000.0, 24000.0)
    gradient = 2500 * 0.82 / 1.72 / 21000 - 2500 * 0.90 / 1.72 / 24000
    assert understeer_gradient(GE_NI) == pytest.approx(gradient, rel=1e-12)
    assert characteristic_speed(GE_NI) == pytest.approx(math.sqrt(1.72 / gradient), rel=1e-12)


def test_tyres_with_forces_that_follow_the_load_steer_neutrally():
    """One friction curve on all wheels.

    C proportional to the load, m_1/C_1 = m_2/C_2 wherever the mass is.
    """
    for distance in (0.8, 1.2, 1.6):
        car = Vehicle(centre_of_mass_to_rear_axle=distance)
        assert understeer_gradient(car) == pytest.approx(0.0, abs=1e-15)


def test_slope_of_the_friction_curve_is_the_cornering_stiffness():
    """Burckhardt on dry asphalt: C1 C2 - C3 = 17.135 per load.

    Secant at 1e-6 differs by C2 1e-6/2 of it.
    """
    car = Vehicle(centre_of_mass_to_rear_axle=2.405 / 2)
    expected = (1.029 * 17.16 - 0.523) * 1400 / 2 * 9.81
    assert axle_cornering_stiffnesses(car) == pytest.approx((expected, expected), rel=2e-5)


def test_oversteer_has_no_characteristic_speed():
    tail_heavy = dataclasses.replace(GE_NI, centre_of_mass_to_rear_axle=0.7)
    assert understeer_gradient(tail_heavy) < 0.0
    assert characteristic_speed(tail_heavy) == math.inf


def test_oversteer_has_a_critical_speed():
    """sqrt(L/|K_us|) with K_us = 2500/1.72 (0.7/21000 - 1.02/24000) = -0.01332: 11.36 m/s."""
    tail_heavy = dataclasses.replace(GE_NI, centre_of_mass_to_rear_axle=0.7)
    assert critical_speed(tail_heavy) == pytest.approx(11.36, rel=1e-3)
    assert critical_speed(GE_NI) == math.inf


# The planar plant linearised


def four_by_four(**tyre) -> Vehicle:
    """The car of CAR with strong motors, no resistances, and its mass on the road."""
    return Vehicle(
        mass=CAR.mass,
        wheelbase=CAR.wheelbase,
        front_track=1.5,
        rear_track=1.5,
        centre_of_mass_to_rear_axle=CAR.wheelbase / 2,
        wheel_radius=0.35,
        yaw_inertia=CAR.yaw_inertia,
        centre_of_mass_height=0.0,
        rolling_resistance=0.0,
        drag_coefficient=0.0,
        wheel_inertia=0.1,
        steering_geometry="parallel",
        driven_wheels=("front_left", "front_right", "rear_left", "rear_right"),
        motor=Motor(peak_torque=1000.0, nominal_torque=1000.0, peak_power=1e6),
        battery=Battery(discharge_power=1e6),
        tyre=Tyre(**tyre),
    )


LINEAR = four_by_four(
    curve="linear",
    coefficients=(20.0, 0.0, 0.0, 0.0),
    combined="uncoupled",
    lateral_curve="linear",
    front_cornering_stiffness=CAR.axle_cornering_stiffness / 2,
    rear_cornering_stiffness=CAR.axle_cornering_stiffness / 2,
    lateral_stiffness=1e7,  # as good as no carcass, which W12 does not have
    lateral_damping_time=1e-3,
)
ICE = four_by_four(curve="two_exponential", coefficients=(0.35, 0.05, 0.15, 0.0))


def with_front_share(share: float, force: float, accelerates: bool = False) -> OperatingPoint:
    half_front, half_rear = force * 0.35 * share / 2, force * 0.35 * (1 - share) / 2
    return OperatingPoint(
        CAR.speed, 0.0, Wheels(half_front, half_front, half_rear, half_rear), accelerates
    )


@pytest.mark.parametrize(
    ("share", "accelerates"), [(0.0, False), (0.4, False), (0.0, True), (0.4, True)]
)
def test_linearised_plant_is_w12_with_the_steering_rate(share, accelerates):
    """2 % up to 10 Hz.

    The stiffest carcass that there is still delays the forces by 2 ms, W12 knows no delay.
    """
    force = 2000.0
    plant = linearised(LINEAR, with_front_share(share, force, accelerates))
    model = dataclasses.replace(
        CAR, drive_force=force, front_share=share, longitudinal_acceleration=plant.acceleration
    )
    assert plant.acceleration == pytest.approx(force / CAR.mass if accelerates else 0.0, rel=0.01)
    frequency = 2 * np.pi * np.array([0.01, 0.1, 1.0, 3.0, 10.0])
    expected = model.response_with_steering_rate(frequency)
    assert plant.slip_angle_difference(frequency) == pytest.approx(expected, rel=0.02, abs=1e-4)


def test_linearised_plant_has_the_closed_form_of_a_steady_turn():
    """Yaw rate gain u/(L + K u^2) of Ge & Ni at 5 m/s, straight ahead.

    To 1e-6, the size of the differences.
    """
    # resistances act across the bend
    free = dataclasses.replace(GE_NI, rolling_resistance=0.0, drag_coefficient=0.0)
    plant = linearised(free, OperatingPoint(5.0))
    expected = 5.0 / (1.72 + understeer_gradient(GE_NI) * 25.0)
    assert plant.response(np.array([0.0]))[0, 1].real == pytest.approx(expected, rel=1e-6)


def test_linearised_plant_moves_as_the_nonlinear_one():
    """1e-4 rad about steady cornering, half a second of both, to 1 % of the yaw change."""
    angle, step = 0.05, 1e-4
    found = linearised(ICE, OperatingPoint(CAR.speed, angle))
    parameters = PlanarPlantParameters(initial_speed=CAR.speed, speed="held")
    plant = CompiledObject(find_method("plant", "planar"), parameters, ICE, 0.01)
    nothing = WheelTorqueCommand(NO_WHEELS)
    for _ in range(1000):
        plant.advance(nothing, SteeringColumnState(0.0, 0.0, 0.0, angle, 0.0))
    before = plant.state.copy()
    for _ in range(50):
        plant.advance(nothing, SteeringColumnState(0.0, 0.0, 0.0, angle + step, 0.0))
    after = plant.state.copy()
    time = np.linspace(0.0, 0.5, 501)
    _, answer, _ = lsim(found.system, np.full_like(time, step), time)
    assert answer[-1, 1] == pytest.approx(after[YAW_RATE] - before[YAW_RATE], rel=0.01)
    assert answer[-1, 0] == pytest.approx(after[VY] - before[VY], rel=0.01)


def test_neutral_share_of_eq_4_holds_without_load_transfer_only():
    """Eq 4's 2 J_z/(m L^2) = 0.48 steers neutrally with linear tyres, and nearly so on ice.

    On ice the slip of the drive takes cornering stiffness away from its axle, so rear drive
    oversteers where W12 understeers. With a centre of mass at 0.65 m the acceleration moves load,
    and so cornering stiffness, to the rear: the car understeers with 0.48.
    """
    neutral = CAR.neutral_share_of_acceleration
    assert neutral == pytest.approx(0.480, abs=5e-4)

    def steady(car: Vehicle, share: float) -> float:
        found = linearised(car, with_front_share(share, 2000.0, accelerates=True))
        return float(found.slip_angle_difference(np.array([0.0]))[0].real)

    assert steady(LINEAR, 0.0) < -5e-3
    assert abs(steady(LINEAR, neutral)) < 0.05 * abs(steady(LINEAR, 0.0))
    assert steady(ICE, 0.0) > 2e-2
    assert abs(steady(ICE, neutral)) < 0.1 * steady(ICE, 0.0)
    high = dataclasses.replace(ICE, centre_of_mass_height=0.65)
    assert steady(high, 0.0) > 1e-2 and steady(high, neutral) < -1e-2


def test_no_linear_model_of_a_motion_that_is_not_steady():
    with pytest.raises(ValueError, match="no steady motion"):
        linearised(Vehicle(), OperatingPoint(25.0, math.radians(10.0)))
    with pytest.raises(ValueError, match="straight ahead"):
        linearised(ICE, OperatingPoint(7.0, 0.1, Wheels(10.0, 10.0, 10.0, 10.0), accelerates=True))


def test_command_line_prints_how_a_vehicle_steers(tmp_path, capsys):
    analyse(["ge_ni2005", "--speed", "5", "--out", str(tmp_path)])
    printed = {
        line[:52].strip(): line[52:].split() for line in capsys.readouterr().out.splitlines()
    }
    assert printed["understeer gradient"] == ["0.0022494", "rad", "s^2/m"]
    assert printed["characteristic speed"] == ["27.652", "m/s"]
    assert not [
        label
        for label in printed
        if label.startswith(("critical", "W12", "acceleration", "front share"))
    ]
    assert (tmp_path / "bode_ge_ni2005.png").read_bytes().startswith(b"\x89PNG")


def test_command_line_prints_what_a_drive_force_does(tmp_path, capsys):
    """W12 = N/(D + s): N > 0 by the force of the front wheels alone.

    Without a force there is nothing to say.
    """
    analyse(["audi_a2", "--drive-force", "1000", "--out", str(tmp_path)])
    printed = {
        line[:52].strip(): line[52:].split() for line in capsys.readouterr().out.splitlines()
    }
    assert float(printed["W12: excitation N, 0 if the car steers neutrally"][0]) > 0.0


@pytest.mark.parametrize("speed", ["0", "-5", "500"])
def test_linear_models_are_of_a_car_that_goes_ahead_as_fast_as_one_may(tmp_path, capsys, speed):
    with pytest.raises(SystemExit):
        analyse(["audi_a2", f"--speed={speed}", "--out", str(tmp_path)])
    assert f"'{speed}' is refused, expected a number from 0.1 to 120" in capsys.readouterr().err


@given(car=st.sampled_from(sorted(files_in_config("vehicles"))), speed=st.floats(0.5, 80.0))
def test_damping_and_frequency_are_those_of_two_poles_of_the_car(car, speed):
    """s^2 + 2 D w s + w^2 is 0 at two poles, and no pole is slower than the slower of both.

    At about 20 m/s a real pole of many cars is slower than the complex pair.
    """
    system = single_track(vehicle_of(car), speed)
    ratio, frequency = yaw_damping(system)
    poles = np.linalg.eigvals(system.A)
    if np.isnan(frequency):  # of a car that runs away, which swings no more
        assert poles.real.max() > 0.0
        return
    found = np.roots([1.0, 2.0 * ratio * frequency, frequency**2])
    for root in found:
        assert np.abs(poles - root).min() < 1e-6 * frequency
    assert found.real.max() == pytest.approx(poles.real.max())


@pytest.mark.parametrize(("car", "rolls"), [("sedan", True), ("compact_ev", False)])
def test_damping_of_a_car_that_rolls_is_named_as_of_both(capsys, car, rolls):
    """That of the sedan is slower by three than its yaw, which a rigid body would show."""
    print_over_speed(vehicle_of(car), "dry_asphalt")
    assert ("the body rolls as well" in capsys.readouterr().out) == rolls


def test_command_line_says_in_one_line_what_is_wrong(tmp_path):
    turning_in = ["audi_a2", "--speed", "25", "--road-wheel-angle", "10"]
    for words, line in (
        (["audi_a3"], "unknown vehicle 'audi_a3'"),
        (turning_in, "no steady motion at 25 m/s"),
    ):
        with pytest.raises(SystemExit, match=f"^error: {line}"):
            analyse([*words, "--out", str(tmp_path)])
