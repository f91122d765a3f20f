"""Options of the vehicle and of the start by which a source's own car differs."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from plant.planar.car import CAR, STRAIGHT, command, outputs, parameters_of, plant, steered

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.tyre import Tyre
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    InertialMeasurement,
    TireForces,
    WheelStates,
    WheelTorqueCommand,
)
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.body import Equations
from ev_sim.plant.planar.planar_state import DRAG_WORK, INTEGRATED_SIZE, VX, VY, WHEEL_SPEED

REAR_DRIVEN = dataclasses.replace(CAR, driven_wheels=("rear_left", "rear_right"))
LINE = Tyre(
    curve="rational",
    coefficients=(0.8, 0.2, 0.0, 0.0),
    combined="uncoupled",
    lateral_curve="constant_stiffness",
    front_cornering_stiffness=30e3,
    rear_cornering_stiffness=40e3,
)


def accelerating_turn(car: Vehicle) -> dict[type, tuple]:
    """Two seconds of drive at 10 m/s with the wheels turned."""
    driven = plant(car, initial_speed=10.0)
    for _ in range(200):
        driven.advance(WheelTorqueCommand(Wheels.front(300.0, 300.0)), steered(0.02))
    return outputs(driven)


@pytest.mark.parametrize("transfer", ["lateral", "none"])
def test_load_transfer_that_a_source_leaves_out(transfer):
    """Axle loads stay at rest's without longitudinal transfer, to rounding.

    Left and right differ by F_y h/B.
    """
    car = dataclasses.replace(CAR, load_transfer=transfer)
    seen = accelerating_turn(car)
    load = seen[TireForces].load
    front = CAR.mass * 9.81 * CAR.centre_of_mass_to_rear_axle / CAR.wheelbase
    assert load.front_left + load.front_right == pytest.approx(front, rel=1e-12)
    moved = (load.front_right - load.front_left) + (load.rear_right - load.rear_left)
    roll = CAR.mass * seen[InertialMeasurement].lateral_acceleration * CAR.centre_of_mass_height
    expected = roll * 2.0 / CAR.front_track if transfer == "lateral" else 0.0
    assert moved == pytest.approx(expected, rel=0.02)  # the lag of 20 ms, while the car gets faster


def test_both_transfers_move_axle_loads():
    load = accelerating_turn(CAR)[TireForces].load
    assert load.front_left + load.front_right < 0.99 * CAR.mass * 9.81 * 0.45


def test_constant_stiffness_gives_a_lateral_force_by_the_slip_angle_alone():
    """F_y = -C alpha at every wheel, whatever its load.

    1e-3: the lag of the carcass while the car gets faster.
    """
    forces = accelerating_turn(dataclasses.replace(CAR, tyre=LINE))[TireForces]
    assert forces.load.front_right > 1.1 * forces.load.front_left
    for force, angle, stiffness in zip(
        forces.lateral_force, forces.slip_angle, (30e3, 30e3, 40e3, 40e3), strict=True
    ):
        assert force == pytest.approx(-stiffness * angle, rel=1e-3)
        assert abs(angle) > 0.01


def test_constant_stiffness_is_linear_in_the_angle_and_not_in_its_sine():
    """Half a radian of sideslip: the force is 4 % above that of the sine."""
    car = dataclasses.replace(
        CAR, tyre=dataclasses.replace(LINE, lateral_stiffness=1e7, lateral_damping_time=0.001)
    )
    sliding = plant(car, 0.001, initial_speed=10.0, speed="held", load_transfer_lag=0.002)
    state = sliding.state.copy()
    state[VY] = 10.0 * np.tan(0.5)
    sliding.state = state
    for _ in range(10):
        sliding.advance(command(), STRAIGHT)
    forces = outputs(sliding)[TireForces]
    for force, angle, stiffness in zip(
        forces.lateral_force, forces.slip_angle, (30e3, 30e3, 40e3, 40e3), strict=True
    ):
        assert abs(angle) > 0.2
        assert force == pytest.approx(-stiffness * angle, rel=0.01)


def test_a_line_needs_uncoupled_slip():
    with pytest.raises(
        ParameterError, match="lateral_curve constant_stiffness needs combined uncoupled"
    ):
        Tyre(lateral_curve="constant_stiffness")


@pytest.mark.parametrize("ratio", [-0.5, 0.4])
def test_rear_steering_turns_by_the_difference_of_both_angles(ratio):
    """Yaw rate u (delta_f - delta_r)/(L + K u^2), K = m (b/C_f - a/C_r)/L, for 0.5 %.

    Two tracks.
    """
    car = dataclasses.replace(
        CAR,
        tyre=LINE,
        rear_steering_ratio=ratio,
        steering_geometry="parallel",
        rolling_resistance=0.0,
        drag_coefficient=0.0,
    )
    turning = plant(car, initial_speed=8.0, speed="held")
    for _ in range(500):
        turning.advance(command(), steered(0.01))
    b = CAR.centre_of_mass_to_rear_axle
    gradient = CAR.mass * (b / 60e3 - (CAR.wheelbase - b) / 80e3) / CAR.wheelbase
    expected = 8.0 * 0.01 * (1.0 - ratio) / (CAR.wheelbase + gradient * 64.0)
    assert outputs(turning)[BodyVelocity].yaw_rate == pytest.approx(expected, rel=5e-3)


def test_printed_wheel_inertia_counts_the_mass_twice():
    """T/r = (m + 4 (J + m r^2/4)/r^2) a; 1 %: slip of the tyres."""
    car = dataclasses.replace(
        CAR, printed_wheel_inertia=True, rolling_resistance=0.0, drag_coefficient=0.0
    )
    driven = plant(car, initial_speed=5.0)
    for _ in range(100):
        driven.advance(WheelTorqueCommand(Wheels.front(200.0, 200.0)), STRAIGHT)
    moved = 2.0 * CAR.mass + 4.0 * CAR.wheel_inertia / CAR.wheel_radius**2
    acceleration = outputs(driven)[InertialMeasurement].longitudinal_acceleration
    assert acceleration == pytest.approx(400.0 / CAR.wheel_radius / moved, rel=0.01)


def test_each_wheel_rolls_and_drives_on_its_own_radius():
    """A free wheel of 5 % more radius turns 5 % slower.

    A driven one pushes with torque over its radius.
    """
    ratios = (1.1, 1.0, 1.05, 1.0)
    car = dataclasses.replace(CAR, wheel_radius_ratio=ratios, rolling_resistance=0.0)
    driven = plant(car, initial_speed=10.0, speed="held")
    for _ in range(200):
        driven.advance(WheelTorqueCommand(Wheels.front(200.0, 200.0)), STRAIGHT)
    seen = outputs(driven)
    speeds, forces = seen[WheelStates].velocity, seen[TireForces].longitudinal_force
    # the uneven drive turns the car
    assert speeds.rear_left * 1.05 == pytest.approx(speeds.rear_right, rel=1e-3)
    assert forces.front_left * 1.1 == pytest.approx(forces.front_right, rel=1e-3)


def test_side_drag_acts_against_lateral_velocity_and_its_work_is_booked():
    car = dataclasses.replace(CAR, side_drag_coefficient=0.9, side_area=4.0)
    y = np.zeros(INTEGRATED_SIZE)
    y[VX], y[VY] = 20.0, -6.0
    y[WHEEL_SPEED : WHEEL_SPEED + 4] = 20.0 / CAR.wheel_radius
    rates = {}
    for name, vehicle in (("with", car), ("without", CAR)):
        equations = Equations(parameters_of(), vehicle)
        equations.look(y)
        equations.hold(0.0)
        rates[name] = equations.rates(y, starts=True)
    drag = 0.5 * 1.24 * 0.9 * 4.0 * 36.0
    assert rates["with"][VY] - rates["without"][VY] == pytest.approx(drag / CAR.mass, rel=1e-9)
    assert rates["with"][DRAG_WORK] - rates["without"][DRAG_WORK] == pytest.approx(
        drag * 6.0, rel=1e-9
    )


@pytest.mark.parametrize(("speed", "torque"), [(5.0, 700.0), (5.0, -700.0), (-5.0, 700.0)])
def test_a_run_may_begin_in_the_equilibrium_of_straight_running(speed, torque):
    """Speeds and forces stay to 1e-6 and 1e-5, driving, braking and in reverse."""
    car = dataclasses.replace(
        REAR_DRIVEN, motor=dataclasses.replace(REAR_DRIVEN.motor, gear_efficiency=0.95)
    )
    begun = plant(
        car, initial_speed=speed, speed="held", initial_drive_torque=(0.0, 0.0, torque, torque)
    )
    before = begun.state[WHEEL_SPEED : WHEEL_SPEED + 4].copy()
    forces = outputs(begun)[TireForces].longitudinal_force
    for _ in range(50):
        begun.advance(command(drive=(0.0, 0.0, torque, torque)), STRAIGHT)
    assert begun.state[WHEEL_SPEED : WHEEL_SPEED + 4] == pytest.approx(before, rel=1e-6)
    assert outputs(begun)[TireForces].longitudinal_force == pytest.approx(forces, rel=1e-5)


@pytest.mark.parametrize(
    ("car", "parameters", "message"),
    [
        (REAR_DRIVEN, {}, "needs an initial_speed other than 0"),
        (CAR, {"initial_speed": 5.0}, "needs a motor at rear_left, rear_right"),
        (
            REAR_DRIVEN,
            {"initial_speed": 5.0, "road__left": ("ice",)},
            "is 300 N m at rear_left, expected what its",
        ),
    ],
)
def test_an_impossible_start_is_refused(car, parameters, message):
    with pytest.raises(ParameterError, match=message):
        plant(car, initial_drive_torque=(0.0, 0.0, 300.0, 300.0), **parameters)
