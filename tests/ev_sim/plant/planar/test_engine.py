"""The engine car between steps.

Stable however it is geared, converging, and saying what it does not give.
"""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plant.planar.car import FOUR_MOTORS, STRAIGHT, command, plant

from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import Driveline
from ev_core.vehicle.motor import Engine, Gearbox
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.drives.driveline import EngineState, GearboxLoad, advance_engine
from ev_sim.plant.planar.planar_state import VX, WHEEL_SPEED, index
from ev_stack.recording.offline import run_offline
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.scenario import Overrides, load_scenario

OUTPUT, GEAR = index("engine.output"), index("engine.gear")
SPLIT = {"road__left": ("ice",), "road__right": ("dry_asphalt",)}
CASES = 60  # of the property; thousands have been driven once


def engine_car(
    final_drive: float = 4.1, driveline: Driveline | None = None, **engine: object
) -> Vehicle:
    """110 kW in the car of the tests, by default with a centre differential."""
    return dataclasses.replace(
        FOUR_MOTORS,
        gear_ratio=final_drive,
        driven_wheels=WHEEL_NAMES,
        driveline=driveline or Driveline(coupling="centre"),
        engine=Engine(peak_power=110e3, **engine),
    )


def outputs_by_step(
    car: Vehicle, speed: float, torque: float, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Gearbox output in steps of 1 ms [N m] while no gear changes, and the last state."""
    moving = plant(car, period=1e-3, initial_speed=speed)
    torques, gears = [], []
    for _ in range(steps):
        moving.advance(command((torque,) * 4), STRAIGHT)
        torques.append(moving.state[OUTPUT])
        gears.append(moving.state[GEAR])
    last = max((n + 1 for n in range(1, steps) if gears[n] != gears[n - 1]), default=0)
    return np.array(torques[last:]), moving.state.copy()


def longest_alternation(torques: np.ndarray) -> int:
    """Most steps in a row with torque up and down by over a twentieth of its largest."""
    changes = np.diff(torques)
    big = np.abs(changes) > 0.05 * np.abs(torques).max(initial=1.0)
    alternates = (changes[1:] * changes[:-1] < 0.0) & big[1:] & big[:-1]
    longest = run = 0
    for each in alternates:
        run = run + 1 if each else 0
        longest = max(longest, run)
    return longest


@settings(max_examples=CASES, deadline=None)
@given(
    final_drive=st.floats(1.0, 10.0),
    size=st.floats(-2.0, 2.0).map(lambda power: 10.0**power),
    ratios=st.lists(
        st.floats(0.5, 8.0), min_size=1, max_size=6, unique_by=lambda ratio: round(ratio, 1)
    ),
    reverse=st.floats(0.5, 8.0),
    coupling=st.sampled_from(["centre", "clutch"]),
    speed=st.floats(-25.0, 40.0),
    torque=st.floats(-600.0, 600.0),
)
def test_no_gear_and_no_size_makes_the_converter_ring(
    final_drive, size, ratios, reverse, coupling, speed, torque
):
    """Any gears, final drive 1 to 10, converter 0.01 to 100 times the source's, both ways.

    A wheel against its carcass swings over 4.5 steps or more, so four changes in a row are the
    scheme's. The gear has no losses here: they change sides with every turn of a wheel that rocks
    about rest, whatever drives it.
    """
    falling = tuple(sorted(ratios, reverse=True))
    gearbox = Gearbox(falling, reverse, efficiency=1.0, upshift_speed=5000.0, downshift_speed=0.0)
    car = engine_car(
        final_drive, Driveline(coupling=coupling), converter_size=size, gearbox=gearbox
    )
    torques, state = outputs_by_step(car, speed, torque, 400)
    assert np.isfinite(state).all()
    assert np.abs(state[VX]) < 60.0
    assert longest_alternation(torques) < 4


@pytest.mark.parametrize(("final_drive", "size"), [(7.0, 1.0), (8.0, 1.0), (4.1, 3.0), (4.1, 5.0)])
def test_geared_low_in_reverse_its_torque_does_not_alternate(final_drive, size):
    """Begun at -15 m/s with 500 N m asked forwards.

    By an explicit step 1160 N m each step, or NaN after 0.37 s.
    """
    values = (
        ("*", "vehicle.gear_ratio", final_drive),
        ("*", "vehicle.engine.converter_size", size),
        ("plant", "initial_speed", -15.0),
        ("driver", "pedals.begin", True),
        ("driver", "pedals.time", (0.0,)),
        ("driver", "pedals.drive_torque", (500.0,)),
        ("driver", "pedals.brake_torque", (0.0,)),
    )
    (run, *_) = with_own_angles(
        load_scenario("step_steer", Overrides(vehicle="engine_4x4", values=values))
    ).runs
    recording = run_offline(run.configurations, 3.0)
    torque = np.asarray(recording.channels["wheel_states.effort.front_left"])
    assert np.isfinite(torque).all()
    assert longest_alternation(torque) < 4


CONVERGENCE = {  # final drive, size, speed [m/s], torque of each wheel [N m], duration [s], road
    "launch": (4.1, 1.0, 0.0, 150.0, 1.5, {}),
    "launch on split friction": (4.1, 1.0, 0.0, 340.0, 0.6, SPLIT),
    "creep": (4.1, 1.0, 0.0, 0.0, 2.0, {}),
    "geared low in reverse": (8.0, 1.0, -8.0, -100.0, 0.5, {}),
    "large converter": (4.1, 5.0, 4.0, 100.0, 0.5, {}),
}


@pytest.mark.parametrize("name", CONVERGENCE)
def test_engine_car_converges_with_the_step(name):
    """First order: from 0.5 ms on, each half of the step leaves half of the change, within a third.

    No gear changes.
    """
    final_drive, size, speed, torque, duration, road = CONVERGENCE[name]
    gearbox = Gearbox(upshift_speed=5000.0, downshift_speed=0.0)
    ends = []
    for step in (5e-4, 2.5e-4, 1.25e-4, 6.25e-5):
        moving = plant(
            engine_car(final_drive, converter_size=size, gearbox=gearbox),
            step=step,
            initial_speed=speed,
            **road,
        )
        for _ in range(round(duration / 0.01)):
            moving.advance(command((torque,) * 4), STRAIGHT)
        ends.append(moving.state[[VX, WHEEL_SPEED, index("engine.speed")]].copy())
    changes = np.abs(np.diff(ends, axis=0)) / np.maximum(np.abs(ends[-1]), 1.0)
    assert changes[0].max() < 1e-3
    for coarse, fine in pairwise(changes):
        worst = np.argmax(coarse)
        assert coarse[worst] / fine[worst] == pytest.approx(2.0, rel=0.33) or coarse[worst] < 1e-9


@settings(max_examples=20)
@given(st.integers(1, 400))
def test_a_gear_stays_in_for_its_dwell_at_any_step(n):
    """0.5 s of steps of 10/n ms, to the nearest.

    2000 steps of 0.25 ms are less than 0.5 s by rounding.
    """
    engine, h = Engine(peak_power=110e3), 0.01 / n
    s, shaft = EngineState(since_shift=engine.gearbox.dwell), 2.0 * engine.gearbox.upshift_speed
    shifts = []
    for step in range(round(1.1 * engine.gearbox.dwell / h)):
        before = s.gear
        advance_engine(s, engine, (1.0,) * 5, GearboxLoad(0.0, shaft, 0.0), h)
        shifts += [step] if s.gear != before else []
    assert shifts == [0, round(engine.gearbox.dwell / h)]


def test_shifts_leave_way_and_speed_of_first_order():
    """The launch with split friction, four shifts: docs/drivelines.md.

    Half of the step left more than the whole.
    """
    ends = []
    for step in (1e-3, 5e-4, 2.5e-4, 1.25e-4):
        values = [("plant", "step", step)]
        (run,) = load_scenario(
            "launch_split_mu", Overrides((), values, 4.0, "engine_4x4"), only=["fixed_steering"]
        ).runs
        channels = run_offline(run.configurations, 4.0).channels
        ends.append([channels[name] for name in ("pose.x", "pose.y", "twist.longitudinal")])
    changes = [
        np.abs(np.subtract(*pair)).mean(axis=1) / np.abs(pair[1]).max(axis=1)
        for pair in pairwise(np.array(ends))
    ]
    assert changes[0].max() < 1e-3
    for coarse, fine in pairwise(changes):
        assert (fine < 0.7 * coarse).all()


@pytest.mark.parametrize(("speed", "torque", "gear"), [(2.0, -800.0, 1.0), (-1.5, 1400.0, -1.0)])
def test_a_gear_that_the_selector_keeps_is_noted(speed, torque, gear):
    """The outcome of docs/drivelines.md.

    It goes on in its direction, without torque against it but the drag.
    """
    moving = plant(engine_car(), initial_speed=speed)
    for _ in range(200):
        moving.advance(command((torque / 4,) * 4), STRAIGHT)
    assert moving.state[GEAR] == gear
    assert moving.state[VX] * gear > 0.5
    (note,) = moving.reports()
    assert note.startswith("more torque was asked against the gear than the engine's drag")


def test_an_engine_that_is_asked_for_what_it_gives_notes_nothing():
    moving = plant(engine_car(), initial_speed=5.0)
    for torque in (100.0, -5.0, 0.0):
        for _ in range(100):
            moving.advance(command((torque,) * 4), STRAIGHT)
    assert moving.reports() == ()


def test_a_wheel_motor_of_its_own_size_and_gear_has_its_own_inertia():
    """1 + 8^2 * 0.05 = 4.2 kg m^2 in front.

    Behind, 1.5 times the gear and twice the motor, 1 + 12^2 * 0.1 = 15.4.
    """
    motor = dataclasses.replace(FOUR_MOTORS.motor, rotor_inertia=0.05)
    car = dataclasses.replace(
        FOUR_MOTORS, gear_ratio=8.0, motor=motor, driveline=Driveline(rear_gear=1.5, rear_size=2.0)
    )
    assert car_numbers(car)["driven_wheel_inertia"] == pytest.approx([4.2, 4.2, 15.4, 15.4])
