"""A body that rolls on its suspension: balance, energy, mirror, rest, reverse, signals, refusals."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plant.planar.car import (
    STRAIGHT,
    command,
    elastic_energy,
    kinetic_energy,
    outputs,
    plant,
    steered,
)
from plant.planar.test_symmetry import LATERAL, NAMES, ODD, SWAPPED
from scipy.signal import StateSpace

from ev_control.estimation.wheel_dynamics import wheel_loads
from ev_core.lockstep.configuration import configure
from ev_core.methods.law import namespace
from ev_core.vehicle.car import GRAVITY, car_numbers
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.suspension import Suspension
from ev_msgs_py.contract.optional_signals import BodyRoll
from ev_msgs_py.contract.signals import InertialMeasurement, TireForces
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.plant.planar.body import wheel_loads as wheel_loads_of_plant
from ev_sim.plant.planar.given import body_constants, roll_constants
from ev_sim.plant.planar.planar_state import DAMPER_WORK, ROLL_ANGLE, ROLL_RATE, index
from ev_sim.plant.planar.prepare import longest_step
from ev_stack.scenarios.files import vehicle_of
from ev_study.analysis.linear_models import single_track
from ev_study.analysis.linearised_plant import OperatingPoint, linearised

SEDAN = vehicle_of("sedan")
ROLLING = SEDAN.suspension
WORKS = ("tyre_work", "friction_work", "drag_work", "gravity_work", "holding_work", "damper_work")


def roll_energy(state: np.ndarray, car: Vehicle = SEDAN, gravity: float = GRAVITY) -> float:
    """Kinetic energy of the roll, and that of springs and weight [J]."""
    roll = roll_constants(car)
    held = roll.stiffness - roll.weight * gravity
    return 0.5 * float(roll.inertia * state[ROLL_RATE] ** 2 + held * state[ROLL_ANGLE] ** 2)


def moments(load: Wheels, car: Vehicle = SEDAN) -> tuple[float, float]:
    """Roll moments that front and rear axle take [N m]."""
    return (
        0.5 * car.front_track * (load.front_right - load.front_left),
        0.5 * car.rear_track * (load.rear_right - load.rear_left),
    )


def in_a_bend(car: Vehicle, speed: float = 20.0, angle: float = 0.02, **parameters):
    """The car after 6 s of a held angle, settled."""
    driven = plant(car, initial_speed=speed, speed="held", **parameters)
    for _ in range(600):
        driven.advance(command(), steered(angle))
    return driven


@pytest.mark.parametrize("speed", [20.0, -8.0])
@pytest.mark.parametrize("angle", [0.02, -0.03])
def test_steady_angle_and_loads_are_the_closed_form(speed, angle):
    """Phi = m_s d a_y/(k - m_s g d), and the axles take links, springs and the weight (1e-6)."""
    driven = in_a_bend(SEDAN, speed, angle)
    seen = outputs(driven)
    lateral = seen[InertialMeasurement].lateral_acceleration
    # d = h_s - h_axis, with the axis midway between the roll centres of a car in balance.
    arm = 0.87238 - 0.5 * (0.45861 + 0.47661)
    weight = 1671.26 * arm
    expected = weight * lateral / (20e3 - weight * 9.81)
    assert seen[BodyRoll].angle == pytest.approx(expected, rel=1e-6)
    assert seen[BodyRoll].rate == pytest.approx(0.0, abs=1e-6)
    upright = (1889.432 - 1671.26) * 0.3196
    front, rear = moments(seen[TireForces].load)
    for moment, height in ((front, 0.45861), (rear, 0.47661)):
        links = 0.5 * (1671.26 * height + upright) * lateral
        assert moment == pytest.approx(links + 10e3 * expected, rel=1e-6)


def test_laws_count_with_the_weight_that_leans():
    """Loads that laws estimate from accelerations are those of the plant in a steady bend."""
    driven = in_a_bend(SEDAN)
    seen = outputs(driven)
    estimated = wheel_loads(namespace(car_numbers(SEDAN)), seen[InertialMeasurement])
    # The lag of a longitudinal transfer is over, drag there is none.
    assert estimated == pytest.approx(seen[TireForces].load, rel=1e-6)


def test_a_stiff_suspension_is_a_rigid_one():
    """Springs a thousand times as stiff give loads and yaw rate of a body without roll.

    All mass is in the body, so that both have one height; 0.1 % is what the springs still give.
    """
    stiff = replace(
        ROLLING,
        front_roll_stiffness=1e7,
        rear_roll_stiffness=1e7,
        front_roll_damping=1e5,
        rear_roll_damping=1e5,
        sprung_mass=SEDAN.mass,
        sprung_mass_height=0.0,
    )
    rigid = Suspension(
        front_roll_stiffness=1e7,
        rear_roll_stiffness=1e7,
        front_roll_centre_height=ROLLING.front_roll_centre_height,
        rear_roll_centre_height=ROLLING.rear_roll_centre_height,
    )
    found = [in_a_bend(replace(SEDAN, suspension=each)) for each in (stiff, rigid)]
    loads = [moments(outputs(each)[TireForces].load) for each in found]
    assert loads[0] == pytest.approx(loads[1], rel=1e-3)
    yaw_rates = [each.state[index("yaw_rate")] for each in found]
    assert yaw_rates[0] == pytest.approx(yaw_rates[1], rel=1e-3)


def test_energy_of_a_rolling_car_is_accounted_for():
    """Change of kinetic, roll and spring energy = drive - all that was taken, dampers too: 1e-6."""
    driven = plant(SEDAN, initial_speed=20.0, road__side_slope=(0.05,), road__grade=(0.03,))
    # The normal component of gravity on this slope, which turns a leaning body over.
    gravity = GRAVITY / math.sqrt(1.0 + 0.05**2 + 0.03**2)

    def energy() -> float:
        rolling = roll_energy(driven.state, SEDAN, gravity)
        return kinetic_energy(driven.state, SEDAN) + rolling

    start = energy()
    for n in range(600):
        angle = 0.04 * math.sin(math.pi * n * 0.01)
        driven.advance(command((300.0, 100.0, 0.0, 200.0)), steered(angle))
    works = {name: float(driven.state[index(name)]) for name in WORKS}
    drive = float(driven.state[index("drive_work")])
    turnover = abs(drive) + start + sum(map(abs, works.values()))
    assert abs(drive - sum(works.values()) - (energy() - start)) < 1e-6 * turnover
    assert works["damper_work"] > 10.0


@settings(max_examples=25, deadline=None)
@given(
    st.floats(0.0, 1.0),
    st.tuples(st.floats(2e3, 1e5), st.floats(2e3, 1e5)),
    st.tuples(st.floats(0.0, 1e4), st.floats(0.0, 1e4)),
    st.floats(50.0, 2000.0),
    st.floats(-0.6, 0.6),
)
def test_energy_of_a_rocking_car_only_falls(sprung, stiffness, damping, inertia, angle):
    """Any suspension that the description takes, released from an angle at rest, loses energy.

    The tyres hold the car; what rocks is the body on springs, dampers and carcasses.
    """
    suspension = {
        "sprung_mass": (0.5 + 0.5 * sprung) * SEDAN.mass,
        "front_roll_stiffness": stiffness[0],
        "rear_roll_stiffness": stiffness[1],
        "front_roll_damping": damping[0],
        "rear_roll_damping": damping[1],
        "roll_inertia": inertia,
    }
    try:
        car = replace(SEDAN, suspension=replace(ROLLING, **suspension))
    except ParameterError as refused:
        # Springs too soft to hold the body upright, or an axle that would lift the other's wheel.
        assert "expected" in str(refused)
        return
    driven = plant(car, period=1e-3)
    driven.state[ROLL_ANGLE] = angle
    energy = roll_energy(driven.state, car)
    for _ in range(200):
        driven.advance(command(brake=(2000.0,) * 4), STRAIGHT)
        now = kinetic_energy(driven.state, car)
        now += elastic_energy(driven.state, car) + roll_energy(driven.state, car)
        assert now <= energy * (1.0 + 1e-9)
        energy = now


def test_a_mirrored_rolling_car_is_mirrored_to_the_bit():
    odd = [n for n, name in enumerate(NAMES) if name.startswith((*ODD, *LATERAL))]
    place = {name: n for n, name in enumerate(NAMES)}
    mirror = [place[re.sub("left|right", lambda side: SWAPPED[side[0]], name)] for name in NAMES]
    ours = plant(SEDAN, initial_speed=15.0, road__side_slope=(0.03,))
    other = plant(SEDAN, initial_speed=15.0, road__side_slope=(-0.03,))
    generator = np.random.default_rng(6)
    for _ in range(300):
        front_left, front_right, rear_left, rear_right = generator.uniform(-500, 800, 4)
        angle, rate = generator.uniform(-0.2, 0.2, 2)
        torques = (front_left, front_right, rear_left, rear_right)
        ours.advance(command(torques), steered(angle, rate))
        torques = (front_right, front_left, rear_right, rear_left)
        other.advance(command(torques), steered(-angle, -rate))
        mirrored = other.state[mirror]
        mirrored[odd] *= -1.0
        assert np.array_equal(ours.state, mirrored)
    assert ours.state[ROLL_ANGLE] != 0.0


def test_a_parked_car_leans_down_the_slope_and_rests():
    """It begins in balance on a side slope of 10 %, and stays: no roll, no creep in 20 s."""
    driven = plant(SEDAN, road__side_slope=(0.1,))
    before = float(driven.state[ROLL_ANGLE])
    # The left side is higher, so the body leans to the right.
    assert before > 0.01
    for _ in range(2000):
        driven.advance(command(brake=(1000.0,) * 4), STRAIGHT)
    assert driven.state[ROLL_ANGLE] == pytest.approx(before, abs=1e-9)
    assert abs(driven.state[index("y")]) < 1e-6
    level = plant(SEDAN)
    for _ in range(100):
        level.advance(command(brake=(1000.0,) * 4), STRAIGHT)
    assert level.state[ROLL_ANGLE] == level.state[ROLL_RATE] == level.state[DAMPER_WORK] == 0.0


def test_a_lane_change_in_reverse_leans_to_the_outside():
    """Backwards and to the left the side force points left as well: the body leans to the right."""
    driven = in_a_bend(SEDAN, speed=-8.0, angle=0.1)
    seen = outputs(driven)
    assert seen[InertialMeasurement].lateral_acceleration > 0.5
    assert seen[BodyRoll].angle > 0.0


@pytest.mark.parametrize(
    ("transfer", "along", "across"),
    [("both", True, True), ("longitudinal", True, False), ("lateral", False, True), ("none", False, False)],
)  # fmt: skip
@pytest.mark.parametrize("rolls", [True, False])
def test_load_transfers_apart(transfer, along, across, rolls):
    """Each acceleration moves the loads where `load_transfer` has it, and laws count with it."""
    suspension = ROLLING if rolls else Suspension()
    car = replace(SEDAN, load_transfer=transfer, suspension=suspension)
    driven = plant(car, initial_speed=20.0)
    for _ in range(100):
        driven.advance(command(brake=(300.0,) * 4), steered(0.02))
    load = outputs(driven)[TireForces].load
    front = load.front_left + load.front_right
    assert (front > load.rear_left + load.rear_right + 100.0) == along
    assert (load.front_right > load.front_left + 100.0) == across
    numbers = car_numbers(car)
    assert (numbers["pitch_height"] > 0.0, numbers["roll_height"] > 0.0) == (along, across)


def test_heights_of_roll_and_pitch_are_apart():
    """`centre_of_mass_height` pitches the car, `sprung_mass_height` rolls its body."""
    low = replace(SEDAN, centre_of_mass_height=0.4)
    assert car_numbers(low)["pitch_height"] == 0.4
    assert car_numbers(low)["roll_height"] == car_numbers(SEDAN)["roll_height"]
    lean = replace(ROLLING, sprung_mass_height=0.6)
    assert car_numbers(replace(SEDAN, suspension=lean))["pitch_height"] == 0.8094


def test_the_rolling_radius_shrinks_under_load():
    """A wheel that rolls freely at V turns with V/(r - c (F_z - F_static)), inner and outer."""
    shrinking = replace(SEDAN.tyre, radius_over_load=2e-6)
    car = replace(SEDAN, tyre=shrinking, rolling_resistance=0.0)
    driven = in_a_bend(car)
    load = outputs(driven)[TireForces].load
    static = SEDAN.mass * GRAVITY / 4.0
    yaw_rate = driven.state[index("yaw_rate")]
    for side, name in ((1.0, "rear_left"), (-1.0, "rear_right")):
        rolled = 20.0 - side * 0.5 * SEDAN.rear_track * yaw_rate
        radius = 0.3196 - 2e-6 * (getattr(load, name) - static)
        turning = driven.state[index(f"wheel_speed.{name}")]
        # The wheel still turns freely with a slip of none: 1e-5 is what the bend takes to settle.
        assert turning == pytest.approx(rolled / radius, rel=1e-5)


def test_radii_at_rest_are_given_with_the_centre_of_mass_aside_too():
    """`wheel_radius` is that under the static load, which is more on the heavier side."""
    car = replace(SEDAN, centre_of_mass_offset=0.1)
    constants = body_constants(car)
    level = car.mass * GRAVITY
    at_rest = wheel_loads_of_plant(namespace(car_numbers(car)), level, 0.0, (0.0, 0.0))
    assert constants.static_load == pytest.approx(tuple(at_rest), rel=1e-12)
    assert at_rest.front_left > at_rest.front_right


def test_a_roll_too_fast_for_any_step_is_refused_by_its_own_name():
    car = replace(SEDAN, suspension=replace(ROLLING, sprung_mass=SEDAN.mass, roll_inertia=0.01))
    with pytest.raises(ParameterError, match=r"^vehicle\.suspension: roll stiffness and damping"):
        longest_step(car)


def test_the_linear_model_sways_as_the_plant_does():
    """Lateral velocity and yaw rate over the steering, from standing angles to 2 Hz: 0.2 %.

    The plant's contact slip lags on top. Wheels are light: a single track has none aside that spin
    up as it turns. Without the roll the velocity of the centre of mass is 28 % off at 1 Hz.
    """
    coasting = replace(SEDAN, rolling_resistance=0.0, wheel_inertia=0.05)
    frequencies = np.array([0.0, 3.0, 6.0, 12.0])
    found = linearised(coasting, OperatingPoint(20.0)).response(frequencies)[:, :2]
    model = single_track(coasting, 20.0)
    assert model.A.shape == (6, 6)
    rigid = replace(coasting, suspension=Suspension())
    for n, frequency in enumerate(frequencies):
        assert np.abs(response(model, frequency) / found[n] - 1.0).max() < 2e-3
    apart = response(single_track(rigid, 20.0), 6.0) / found[2] - 1.0
    assert abs(apart[0]) > 0.2


def response(model: StateSpace, frequency: float) -> np.ndarray:
    """Complex response of lateral velocity and yaw rate to the road-wheel angle."""
    eye = np.eye(len(model.A))
    return (model.C @ np.linalg.solve(1j * frequency * eye - model.A, model.B))[:, 0]


def test_only_a_rolling_car_has_the_signal():
    """Topic and sensors of the roll come with the sprung mass, beside every option of the plant."""
    values = {f"vehicle.suspension.{name}": getattr(ROLLING, name) for name in ROLLING.__slots__}
    values |= {"method": "planar", "vehicle.mass": SEDAN.mass}
    rigid = configure("plant", {"method": "planar"})
    assert BodyRoll not in rigid.method.writes
    rolling = configure("plant", values | {"sensors.body_roll.bias": 0.01})
    assert {*rolling.method.writes} == {*rigid.method.writes, BodyRoll}
    electrical = rolling.changed({"electrical": True})
    assert BodyRoll in electrical.method.writes
    back = rolling.changed({"vehicle.suspension.sprung_mass": 0.0})
    assert back.method == rigid.method
    assert "sensors.body_roll.bias" in back.unused


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"roll_inertia": 0.0}, "sprung_mass needs roll_inertia above 0"),
        ({"front_roll_stiffness": 0.0, "rear_roll_stiffness": 0.0}, "needs front_roll_stiffness"),
        ({"roll_lag": 0.08}, "roll_lag is 0.08 s, expected 0 beside sprung_mass"),
        ({"sprung_mass": 2000.0}, "sprung_mass is 2000 kg, expected at most mass, 1889.43 kg"),
        ({"front_roll_stiffness": 6e3, "rear_roll_stiffness": 7e3}, "turns it over with, 13272"),
    ],
)
def test_a_body_that_cannot_roll_is_refused(values, text):
    with pytest.raises(ParameterError, match=re.escape(text)):
        replace(SEDAN, suspension=replace(ROLLING, **values))
