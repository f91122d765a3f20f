"""The planar plant as an integrator: rest, pull-away, step width, energy, symmetry, power balance."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys
from scipy.integrate import solve_ivp

from ev_msgs_py.parameters import ParameterError, build
from ev_msgs_py.signals import InertialMeasurement, SteeringColumnState, TireForces, WheelTorqueCommand
from ev_msgs_py.vehicle import Battery, Driveline, Motor, Tyre, Vehicle
from ev_msgs_py.wheels import Wheels
from ev_sim.plant.planar.body import rates
from ev_sim.plant.planar.integrator import integrate
from ev_sim.plant.planar.plant import PlanarParameters, PlanarPlant
from ev_sim.plant.planar.state import INTEGRATED_SIZE, index, names
from ev_sim.profiles.profile import profile_of, value_at

STRONG = Motor(peak_torque=2000.0, nominal_torque=2000.0, peak_power=1e6, generator_torque=2000.0, generator_power=1e6)
FULL_BATTERY = Battery(discharge_power=1e6, charge_power=1e6, resistance=0.01)
ALL_WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
CAR = Vehicle(motor=STRONG, battery=FULL_BATTERY)
FOUR_MOTORS = dataclasses.replace(CAR, driven_wheels=ALL_WHEELS)

VX, VY, YAW_RATE = index("longitudinal_velocity"), index("lateral_velocity"), index("yaw_rate")
WHEEL_SPEED, U, V = index("wheel_speed"), index("longitudinal_deflection"), index("lateral_deflection")
X, Y, HEADING = index("x"), index("y"), index("heading")


def plant(car: Vehicle = CAR, period: float = 0.01, **parameters) -> PlanarPlant:
    values = {name.replace("__", "."): value for name, value in parameters.items()}
    return PlanarPlant(build(PlanarParameters, values), car, period)


def on(surface: str) -> dict:
    return {"road__left": (surface,), "road__right": (surface,)}


def command(drive=(0.0, 0.0, 0.0, 0.0), brake=(0.0, 0.0, 0.0, 0.0)) -> WheelTorqueCommand:
    return WheelTorqueCommand(Wheels(*drive), Wheels(*brake))


def steered(angle: float, rate: float = 0.0) -> SteeringColumnState:
    return SteeringColumnState(0.0, 0.0, 0.0, angle, rate)


STRAIGHT = steered(0.0)


def kinetic_energy(car: PlanarPlant) -> float:
    s, c = car.state, car._car[0]
    wheels = float(np.sum(c["wheel_inertia"] * s[WHEEL_SPEED : WHEEL_SPEED + 4] ** 2))
    body = c["mass"] * (s[VX] ** 2 + s[VY] ** 2) + c["yaw_inertia"] * s[YAW_RATE] ** 2
    return 0.5 * float(wheels + body)


def elastic_energy(car: PlanarPlant) -> float:
    s, c = car.state, car._car[0]
    along, across = s[U : U + 4], s[V : V + 4]
    return 0.5 * float(c["stiffness_x"] * np.sum(along**2) + c["stiffness_y"] * np.sum(across**2))


@pytest.mark.parametrize(
    ("surface", "grade"),
    [("dry_asphalt", 0.2), ("dry_asphalt", -0.2), ("packed_snow_1", 0.2), ("ice", 0.04), ("ice", 0.0)],
)
def test_parked_on_a_slope_the_car_stays(surface, grade):
    """Less than 1 mm in 60 s on 20 %, on ice (0.05) on 4 %: measured are nanometres."""
    car = plant(road__grade=(grade,), **on(surface))
    moved = []
    for _ in range(6000):
        car.advance(command(brake=(2000.0,) * 4), STRAIGHT)
        moved.append(abs(car.state[X]) + abs(car.state[Y]))
    assert max(moved) < 1e-6


def test_braked_to_rest_on_a_slope_the_car_stays():
    """The rocking after the stop dies away, and then the car moves less than 1 mm in 60 s."""
    car = plant(road__grade=(0.2,), road__side_slope=(0.05,), initial_speed=8.0)
    for _ in range(500):
        car.advance(command(brake=(1500.0,) * 4), steered(0.05))
    at, lateral = car.state[X], car.state[Y]
    for _ in range(6000):
        car.advance(command(brake=(1500.0,) * 4), steered(0.05))
    assert abs(car.state[X] - at) < 1e-3
    assert abs(car.state[Y] - lateral) < 1e-3


def test_without_brakes_the_car_rolls_down():
    """The acceleration is g sin(atan 0.2) - f g cos(..) over the mass with four wheels: 1 + 4 J/(m r^2)."""
    car = plant(dataclasses.replace(CAR, drag_coefficient=0.0), road__grade=(0.2,))
    for _ in range(300):
        car.advance(command(), STRAIGHT)
    slope = np.hypot(1.0, 0.2)
    expected = -9.81 * (0.2 - 0.015) / slope / (1.0 + 4 * 1.0 / (1400 * 0.294**2))
    assert car.outputs()[2].longitudinal_acceleration == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("surface", "torque"),
    [("dry_asphalt", 50.0), ("dry_asphalt", 300.0), ("dry_asphalt", 2000.0), ("ice", 60.0), ("ice", 300.0)],
)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_pull_away_slip_has_one_sign(surface, torque, direction):
    """At the default step, from creeping to spinning wheels, forward and in reverse."""
    car = plant(period=1e-3, **on(surface))
    slip = []
    for _ in range(3000):
        car.advance(command(drive=(direction * torque, direction * torque, 0.0, 0.0)), STRAIGHT)
        forces = next(signal for signal in car.outputs() if isinstance(signal, TireForces))
        slip.append(forces.slip_ratio)
    driven, rolling = direction * np.array(slip)[:, :2], direction * np.array(slip)[:, 2:]
    assert driven.min() >= 0.0  # zero only while rolling resistance still holds the wheel
    assert driven[-1].min() > 0.0
    assert rolling.max() <= 0.0


def test_creep_is_steady():
    """0.03 m/s up a slope of 1 % under a speed controller: neither wheel speed nor slip chatters."""
    car = plant(road__grade=(0.01,))
    speeds, torque = [], 0.0
    for _ in range(3000):
        error = 0.03 - float(car.state[VX])
        torque += 20.0 * error
        wheel = 0.5 * (2000.0 * error + torque)
        car.advance(command(drive=(wheel, wheel, 0.0, 0.0)), STRAIGHT)
        speeds.append(car.state[WHEEL_SPEED] * 0.294)
    assert np.ptp(speeds[-500:]) < 1e-4
    assert np.mean(speeds[-500:]) == pytest.approx(0.03, rel=0.02)


def test_locked_wheel_stays_locked_and_stops_the_car():
    """Locked wheels slide at the friction of full slip: 1.029 (1 - exp(-17.16)) - 0.523 = 0.506."""
    car = plant(dataclasses.replace(CAR, drag_coefficient=0.0), initial_speed=15.0)
    for _ in range(100):
        car.advance(command(brake=(4000.0,) * 4), STRAIGHT)
    assert np.all(car.state[WHEEL_SPEED : WHEEL_SPEED + 4] == 0.0)
    assert car.outputs()[2].longitudinal_acceleration == pytest.approx(-0.506 * 9.81, rel=1e-3)
    for _ in range(900):
        car.advance(command(brake=(4000.0,) * 4), STRAIGHT)
    assert abs(car.state[VX]) < 1e-6


MANOEUVRES = {
    "launch": ({}, lambda t: (command(drive=(400.0, 400.0, 0.0, 0.0)), STRAIGHT)),
    "spinning launch": (on("packed_snow_2"), lambda t: (command(drive=(500.0, 500.0, 0.0, 0.0)), STRAIGHT)),
    "braking on split friction": (
        {"initial_speed": 20.0, "road__left": ("packed_snow_1",)},
        lambda t: (command(brake=(400.0, 400.0, 200.0, 200.0)), STRAIGHT),
    ),
    "step steer": (
        {"initial_speed": 20.0},
        lambda t: (command(drive=(100.0, 100.0, 0.0, 0.0)), steered(min(0.2 * max(t - 0.5, 0.0), 0.04))),
    ),
    "reversing": ({}, lambda t: (command(drive=(-200.0, -200.0, 0.0, 0.0)), steered(0.2))),
    "stop and go": (
        {"initial_speed": 5.0},
        lambda t: (command(brake=(500.0,) * 4) if t < 1.5 else command(drive=(150.0, 150.0, 0.0, 0.0)), steered(0.1)),
    ),
    "held speed": (
        {"initial_speed": 10.0, "speed": "held"},
        lambda t: (command(drive=(300.0, 300.0, 0.0, 0.0)), steered(0.05)),
    ),
    "imposed speed": (
        {
            "initial_speed": 4.0,
            "speed": "imposed",
            "imposed_speed__time": (0.0, 2.0, 3.0),
            "imposed_speed__speed": (4.0, 8.0, 7.0),
        },
        lambda t: (command(drive=(300.0, 300.0, 0.0, 0.0)), steered(0.05)),
    ),
}


def end_state(step: float, name: str) -> np.ndarray:
    parameters, inputs = MANOEUVRES[name]
    car = plant(step=step, **parameters)
    for n in range(400):
        car.advance(*inputs(n * 0.01))
    return car.state.copy()


@pytest.mark.parametrize("name", MANOEUVRES)
def test_halving_the_step_changes_nothing(name):
    """0.1 % of velocities, path and wheel speeds after four seconds; a tenth of that here, measured are 7e-6."""
    coarse, fine = end_state(1e-3, name), end_state(5e-4, name)
    path = max(np.hypot(fine[X], fine[Y]), 1.0)
    speed = max(np.hypot(fine[VX], fine[VY]), 1.0)
    assert np.hypot(coarse[X] - fine[X], coarse[Y] - fine[Y]) < 1e-4 * path
    assert np.abs(coarse[[VX, VY]] - fine[[VX, VY]]).max() < 1e-4 * speed
    wheels = slice(WHEEL_SPEED, WHEEL_SPEED + 4)
    assert np.abs(coarse[wheels] - fine[wheels]).max() < 1e-4 * max(np.abs(fine[wheels]).max(), 1.0)
    assert abs(coarse[YAW_RATE] - fine[YAW_RATE]) < 1e-4 * max(abs(fine[YAW_RATE]), 0.1)


@pytest.mark.parametrize("surface", ["dry_asphalt", "ice"])
def test_against_an_adaptive_solver(surface):
    """The same right-hand side by scipy's DOP853 at a relative tolerance of 1e-9: within 0.1 % after 3 s."""
    car = plant(initial_speed=6.0, **on(surface))
    car.advance(command(), steered(0.03))  # sets steering and road
    step, record = car._step[0], car._car[0]
    step["drive"] = (300.0, 250.0, 0.0, 0.0)
    step["brake"] = (0.0, 0.0, 20.0, 20.0)
    start = car.state[:INTEGRATED_SIZE].copy()
    rates(start, np.zeros(INTEGRATED_SIZE), record, step, True)

    def right_hand_side(_time, y):
        dy = np.zeros(INTEGRATED_SIZE)
        rates(y, dy, record, step, False)
        return dy

    exact = solve_ivp(right_hand_side, (0.0, 3.0), start, method="DOP853", rtol=1e-9, atol=1e-12).y[:, -1]
    ours = start.copy()
    for _ in range(3000):
        integrate(ours, record, step, 1e-3, np.zeros(INTEGRATED_SIZE), np.zeros((4, INTEGRATED_SIZE)))
    scale = np.maximum(np.abs(exact), 1e-3 * np.abs(exact).max())
    worst = int(np.argmax(np.abs(ours - exact) / scale))
    assert np.abs(ours - exact)[worst] < 1e-3 * scale[worst], names()[worst]


def test_energy_never_grows():
    """From 200 random states, torque zero and resistance off: kinetic energy and that of the carcasses only fall.

    The carcasses start unloaded, so the kinetic energy never comes back above its start.
    """
    free = dataclasses.replace(CAR, drag_coefficient=0.0, rolling_resistance=0.0)
    generator = np.random.default_rng(3)
    surfaces = ("dry_asphalt", "wet_asphalt_1", "packed_snow_2", "ice")
    for n in range(200):
        tyre = Tyre(combined=("slip_vector", "uncoupled")[n % 2])
        road = {"road__left": (surfaces[n % 4],), "road__right": (surfaces[n // 4 % 4],)}
        car = plant(dataclasses.replace(free, tyre=tyre), period=1e-3, **road)
        car.state[[VX, VY, YAW_RATE]] = generator.uniform((-30, -10, -3), (30, 10, 3))
        car.state[WHEEL_SPEED : WHEEL_SPEED + 4] = generator.uniform(-100, 100, 4)
        angle = steered(generator.uniform(-0.5, 0.5))
        start = energy = kinetic_energy(car)
        for _ in range(400):
            car.advance(command(), angle)
            now = kinetic_energy(car) + elastic_energy(car)
            assert now <= energy
            energy = now
        assert kinetic_energy(car) <= start


def test_mirrored_input_gives_the_mirrored_trajectory_to_the_bit():
    generator = np.random.default_rng(5)
    odd = [n for n, name in enumerate(names()) if name.split(".")[0] in
           ("lateral_velocity", "yaw_rate", "heading", "lateral_transfer", "lateral_deflection", "y")]  # fmt: skip
    swap = {"left": "right", "right": "left"}
    place = {name: n for n, name in enumerate(names())}
    mirror = [place["_".join(swap.get(part, part) for part in name.split("_"))] for name in names()]
    snow, dry = ("packed_snow_1",), ("dry_asphalt",)
    ours = plant(FOUR_MOTORS, initial_speed=12.0, road__left=snow, road__right=dry, road__side_slope=(0.03,))
    other = plant(FOUR_MOTORS, initial_speed=12.0, road__left=dry, road__right=snow, road__side_slope=(-0.03,))
    for _ in range(500):
        fl, fr, rl, rr = generator.uniform(-500, 800, 4)
        bl, br = generator.uniform(0, 600, 2)
        angle, rate = generator.uniform(-0.3, 0.3, 2)
        ours.advance(command((fl, fr, rl, rr), (bl, br, bl, br)), steered(angle, rate))
        other.advance(command((fr, fl, rr, rl), (br, bl, br, bl)), steered(-angle, -rate))
        mirrored = other.state[mirror]
        mirrored[odd] *= -1.0
        assert np.array_equal(ours.state, mirrored)


def test_the_same_run_gives_the_same_bits():
    one, two = end_state(1e-3, "braking on split friction"), end_state(1e-3, "braking on split friction")
    assert one.tobytes() == two.tobytes()


def test_any_car_under_any_command_stays_finite():
    """Random cars, roads, drives and steps of torque, brake and angle, all far beyond grip."""
    generator = np.random.default_rng(11)

    def between(low: float, high: float) -> float:
        return float(np.exp(generator.uniform(np.log(low), np.log(high))))

    for n in range(40):
        wheelbase = generator.uniform(0.8, 5.0)
        car = Vehicle(
            mass=between(60, 40000),
            wheelbase=wheelbase,
            centre_of_mass_to_rear_axle=generator.uniform(0.05, 0.95) * wheelbase,
            centre_of_mass_height=generator.uniform(0.0, 2.5),
            yaw_inertia=between(20, 1e5),
            wheel_radius=between(0.1, 0.8),
            wheel_inertia=between(0.05, 50),
            gear_ratio=between(0.5, 20),
            driven_wheels=ALL_WHEELS,
            driveline=Driveline(coupling=("individual", "open", "limited_slip", "clutch")[n % 4]),
            blend_brakes=n % 3 == 0,
            tyre=Tyre(combined=("slip_vector", "uncoupled")[n % 2]),
        )
        moving = plant(
            car,
            drive=("torque_controlled", "averaged", "ideal")[n % 3],
            initial_speed=generator.uniform(-20, 30) * (n % 5 > 0),
            road__pattern="random",
            road__random_shortest=0.5,
            road__random_longest=5.0,
            road__grade=(generator.uniform(-0.3, 0.3),),
        )
        for k in range(200):
            if k % 20 == 0:
                drive, brake = generator.uniform(-1e4, 1e4, 4), generator.choice([0, 400, 4000]) * generator.random(4)
                angle = steered(*generator.uniform(-0.6, 0.6, 2))
            moving.advance(command(drive, brake), angle)
        assert np.isfinite(moving.state).all()
        assert np.abs(moving.state[[VX, VY]]).max() < 100.0
        assert sum(moving.outputs()[-1].load) == pytest.approx(car.mass * moving._step[0]["gravity_z"])


@pytest.mark.parametrize("name", MANOEUVRES)
def test_power_balance_closes(name):
    """Battery = losses + drive; drive = change of kinetic energy + tyres + friction + air + slope + hold: 1e-6."""
    parameters, inputs = MANOEUVRES[name]
    car = plant(road__grade=(0.03,), **parameters)
    work = {n: index(n) for n in ("battery_work", "motor_loss", "driveline_loss", "auxiliary_work", "drive_work",
                                  "tyre_work", "friction_work", "drag_work", "gravity_work",
                                  "holding_work")}  # fmt: skip
    start, elastic = kinetic_energy(car), elastic_energy(car)
    for n in range(400):
        car.advance(*inputs(n * 0.01))
    got = {n: float(car.state[place]) for n, place in work.items()}
    turnover = sum(abs(value) for value in got.values()) + start
    electrical = got["motor_loss"] + got["driveline_loss"] + got["auxiliary_work"] + got["drive_work"]
    assert abs(got["battery_work"] - electrical) < 1e-9 * turnover
    used = got["tyre_work"] + got["friction_work"] + got["drag_work"] + got["gravity_work"] + got["holding_work"]
    change = kinetic_energy(car) - start
    assert abs(got["drive_work"] - used - change) < 1e-6 * turnover
    assert got["tyre_work"] - (elastic_energy(car) - elastic) > 0.0
    assert got["friction_work"] > 0.0


def test_held_speed_is_held_by_a_force_that_neither_turns_nor_pitches_the_car():
    """To the bit; on a level straight road it takes the force of the tyres but for the drag, which alone pitches."""
    held = plant(initial_speed=10.0, speed="held")
    for _ in range(300):
        held.advance(command(drive=(300.0, 300.0, 0.0, 0.0)), STRAIGHT)
        assert held.state[VX] == 10.0
    assert held.state[YAW_RATE] == 0.0
    drag = 0.5 * CAR.air_density * CAR.drag_coefficient * CAR.frontal_area * 10.0**2
    front = CAR.mass * 9.81 * 0.45 - drag * CAR.centre_of_mass_height / CAR.wheelbase
    load = held.outputs()[-1].load
    assert load.front_left + load.front_right == pytest.approx(front, rel=1e-9)  # the rest of a lag of 20 ms
    before = held.state[index("holding_work")]
    held.advance(command(drive=(300.0, 300.0, 0.0, 0.0)), STRAIGHT)
    power = (held.state[index("holding_work")] - before) / 0.01
    assert power == pytest.approx((sum(held.outputs()[-1].longitudinal_force) - drag) * 10.0, rel=1e-6)  # steady by now


def test_imposed_speed_follows_its_profile():
    """At every period to rounding, in a bend and whatever the drives do; the accelerometer feels it."""
    parameters, inputs = MANOEUVRES["imposed speed"]
    car = plant(**parameters)
    profile = profile_of(parameters["imposed_speed__time"], parameters["imposed_speed__speed"], "linear")
    for n in range(1, 351):
        car.advance(*inputs(n * 0.01))
        assert car.state[VX] == pytest.approx(value_at(profile, n * 0.01), abs=1e-12)
        if n == 150:
            imu = next(signal for signal in car.outputs() if isinstance(signal, InertialMeasurement))
            turning = car.state[YAW_RATE] * car.state[VY]
            assert imu.longitudinal_acceleration == pytest.approx(2.0 - turning, abs=1e-6)


def test_bad_commands_never_reach_the_integrator():
    car = plant()
    nan, inf = float("nan"), float("inf")
    car.advance(command((nan, inf, 0.0, 0.0), (nan, -5.0, 1e9, 0.0)), steered(nan, inf))
    car.advance(command((1e9, 0.0, 0.0, 0.0)), steered(3.0))
    assert np.isfinite(car.state).all()
    assert car.diagnostics["non_finite_commands"] == 5
    assert car.diagnostics["out_of_range_commands"] == 4


def test_a_stiff_tyre_on_a_light_wheel_gets_shorter_steps():
    """Carcass of 4 MN/m and wheels of 0.05 kg m^2: still quiet, at more steps."""
    stiff = dataclasses.replace(CAR, wheel_inertia=0.05, tyre=Tyre(longitudinal_stiffness=4e6, lateral_stiffness=4e6))
    car = plant(stiff)
    assert car.steps > 10 == plant().steps
    for _ in range(200):
        car.advance(command(drive=(200.0, 200.0, 0.0, 0.0)), steered(0.05))
    forces = car.outputs()[-1]
    assert forces.slip_ratio.front_left == pytest.approx(forces.slip_ratio.front_right, abs=0.01)
    assert 1.0 < car.state[VX] < 3.0
    with pytest.raises(ParameterError, match="stiffness"):
        plant(dataclasses.replace(stiff, wheel_inertia=0.001))


def test_nothing_is_allocated_per_step():
    """Compiled code asks for memory as often for 3000 steps as for 300."""
    _nrt_python.memsys_enable_stats()
    counts = []
    for period in (0.3, 3.0):
        car = plant(period=period, initial_speed=5.0)
        car.advance(command(), STRAIGHT)
        before = rtsys.get_allocation_stats().alloc
        car.advance(command(drive=(100.0, 100.0, 0.0, 0.0), brake=(0.0, 0.0, 10.0, 10.0)), steered(0.01))
        counts.append(rtsys.get_allocation_stats().alloc - before)
    assert counts[0] == counts[1]
