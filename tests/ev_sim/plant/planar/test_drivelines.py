"""Drivelines of real cars.

An axle of its own kind, a centre differential, locks by their make, an engine.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from helpers.adaptive_reference import DrivenPlant
from helpers.manoeuvres import MANOEUVRES
from plant.planar.car import (
    CAR,
    FOUR_MOTORS,
    command,
    drive,
    kinetic_energy,
    outputs,
    plant,
    steered,
)

from ev_core.lockstep.configuration import configure
from ev_core.methods.law import namespace
from ev_core.methods.register import all_methods
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import LOCK_COEFFICIENTS, Driveline, single_wheels
from ev_core.vehicle.motor import Engine, Gearbox
from ev_msgs_py.contract.signals import MotorStates, WheelStates
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.driveline import (
    COUPLING_POINT,
    converter_torques,
    full_load_torque,
    shaft_speeds,
    wheel_torques,
)
from ev_sim.plant.planar.planar_state import index
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario

CARS = ("layout_1_8_b", "centre_dccd", "engine_4x4")
ENGINE = Engine(peak_power=110e3)
FINAL_DRIVE = dataclasses.replace(CAR.motor, gear_efficiency=0.96)


def named(vehicle: str, **values: object) -> Vehicle:
    """A car of config/vehicles."""
    (run, *_) = load_scenario("coast_down", Overrides(vehicle=vehicle)).runs
    return dataclasses.replace(run.configurations["plant"].common.vehicle, **values)


def with_driveline(**values: object) -> Vehicle:
    return dataclasses.replace(FOUR_MOTORS, driveline=Driveline(**values))


def engine_car(**values: object) -> Vehicle:
    return dataclasses.replace(
        FOUR_MOTORS,
        gear_ratio=4.1,
        motor=FINAL_DRIVE,
        driveline=Driveline(coupling="centre"),
        engine=ENGINE,
        **values,
    )


# Locks


@pytest.mark.parametrize(("device", "place"), LOCK_COEFFICIENTS)
def test_lock_coefficient_is_the_torque_of_the_slower_over_that_of_the_faster_side(device, place):
    """Eq 1.1, K = M_slow/M_fast, at both ends of the survey's range.

    A tenth of a turn apart the lock is complete.
    """
    for coefficient in LOCK_COEFFICIENTS[device, place]:
        values = {place: device, f"{place}_lock": coefficient}
        car = namespace(
            car_numbers(
                with_driveline(coupling="centre" if place == "centre" else "open", **values)
            )
        )
        torques = np.zeros(4)
        first, second = {"front": (0, 1), "rear": (2, 3), "centre": ([0, 1], [2, 3])}[place]
        speeds = np.zeros(4)
        speeds[first] = 30.0
        wheel_torques(car, (100.0,) * 4, tuple(speeds), (0.0,) * 4, torques)
        assert np.sum(torques[second]) / np.sum(torques[first]) == pytest.approx(
            coefficient, rel=1e-12
        )
        assert torques.sum() == pytest.approx(400.0, rel=1e-12)


def test_differentials_lose_what_their_locks_take_and_no_more():
    """Motor power = wheel power + locking torque times half the difference of speeds."""
    speeds, parts = (31.0, 29.0, 12.0, 9.0), (100.0,) * 4
    for share in (0.3, 0.5):
        for lock, rear in (("open", "open"), ("dccd", "torsen_2")):
            car = namespace(
                car_numbers(
                    with_driveline(coupling="centre", centre=lock, rear=rear, front_share=share)
                )
            )
            shafts, torques = np.zeros(4), np.zeros(4)
            shaft_speeds(car, speeds, shafts)
            wheel_torques(car, parts, speeds, (0.0,) * 4, torques)
            lost = np.dot(parts, shafts) - np.dot(torques, speeds)
            between = 0.5 * car.centre_locking * 400.0 * (30.0 - 10.5)
            behind = 0.5 * car.axle_locking[1] * (torques[2] + torques[3]) * (12.0 - 9.0)
            # tanh of 3 rad/s over 1 rad/s is 0.995.
            assert lost == pytest.approx(between + behind * np.tanh(3.0), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"front": "torsen_1"},
            "front: torsen_1 is refused, it is made as rear and centre differential",
        ),
        ({"rear": "torsen_2", "rear_lock": 4.0}, "rear_lock: 4 is refused, expected 2 to 3"),
        (
            {"centre_lock": 1.5},
            "centre_lock: 1.5 is refused, expected 0: K is that of a Torsen or DCCD, not open",
        ),
        (
            {"coupling": "clutch", "front": "open"},
            "front and rear are refused with coupling clutch",
        ),
        (
            {"coupling": "centre", "rear": "individual"},
            "front and rear: individual is refused with coupling centre",
        ),
        (
            {"coupling": "centre", "rear_size": 2.0},
            "gear and size of an axle: expected 1 with coupling centre",
        ),
    ],
)
def test_drivelines_that_cannot_be_built_are_refused(values, message):
    with pytest.raises(ParameterError) as error:
        Driveline(**values)
    assert str(error.value).startswith(message) and "\n" not in str(error.value)


def test_engines_without_a_shaft_are_refused():
    for values, message in (
        (
            {"driveline": Driveline()},
            "engine needs one shaft that it drives: driveline.coupling clutch or centre",
        ),
        (
            {"driven_wheels": ("front_left", "front_right")},
            "driveline.coupling centre needs all four driven_wheels",
        ),
        ({"blend_brakes": True}, "blend_brakes is refused with an engine"),
    ):
        with pytest.raises(ParameterError) as error:
            dataclasses.replace(engine_car(), **values)
        assert str(error.value).startswith(message)


# Axles of different motors


def test_axle_of_twice_the_size_is_one_with_two_motors_side_by_side():
    """Torque and power doubled, copper loss per torque squared halved, speed losses doubled.

    The same to rounding.
    """
    motor = dataclasses.replace(CAR.motor, rotor_inertia=0.02)
    twice = dataclasses.replace(
        motor,
        **{
            name: 2.0 * getattr(motor, name)
            for name in ("peak_torque", "nominal_torque", "peak_power")
        },
        **{
            name: 2.0 * getattr(motor, name)
            for name in ("generator_torque", "generator_power", "rotor_inertia")
        },
        **{
            name: 2.0 * getattr(motor, name) for name in ("iron_loss", "eddy_loss", "inverter_loss")
        },
        copper_loss=0.5 * motor.copper_loss,
    )
    two = plant(dataclasses.replace(CAR, motor=motor, driveline=Driveline(front_size=2.0)))
    one = plant(dataclasses.replace(CAR, motor=twice))
    driven = [drive(each, 2.0, Wheels.front(300.0, 250.0)) for each in (two, one)]
    assert driven[0][MotorStates].effort.front_left == pytest.approx(300.0 / 2.65, rel=1e-9)
    assert driven[0][MotorStates].effort == pytest.approx(driven[1][MotorStates].effort, rel=1e-12)
    for entry in ("longitudinal_velocity", "battery_work", "motor_loss", "motor_heat"):
        assert two.state[index(entry)] == pytest.approx(one.state[index(entry)], rel=1e-9)


def test_front_axle_turns_its_motor_by_its_own_gear():
    """8.8 in front, 8 behind.

    In front both wheels get the mean of what is asked of them, behind each its own.
    """
    driven = drive(
        plant(named("layout_1_8_b"), initial_speed=5.0), 0.5, Wheels(300.0, 100.0, 300.0, 100.0)
    )
    motors, wheels = driven[MotorStates], driven[WheelStates]
    assert motors.velocity.front_left == pytest.approx(
        8.8 * 0.5 * (wheels.velocity.front_left + wheels.velocity.front_right), rel=1e-12
    )
    assert motors.velocity.rear_left == pytest.approx(8.0 * wheels.velocity.rear_left, rel=1e-12)
    assert wheels.effort == pytest.approx(
        tuple(0.97 * torque for torque in (200.0, 200.0, 300.0, 100.0)), rel=1e-6
    )


# Converter and engine


def test_converter_of_the_source():
    """Kotwicki: torque ratio 1.68 at stall.

    Where the two torques meet the coupling takes over within 0.5 %.
    """
    taken, given = converter_torques(1.0, 200.0, 0.0)
    assert (taken, given / taken) == (pytest.approx(137.3), pytest.approx(1.6797, rel=1e-4))
    below = converter_torques(1.0, 200.0, 200.0 * COUPLING_POINT - 1e-9)
    above = converter_torques(1.0, 200.0, 200.0 * COUPLING_POINT + 1e-9)
    assert below[0] == pytest.approx(below[1], rel=1e-3)
    assert above[0] == pytest.approx(below[0], rel=5e-3)
    assert converter_torques(1.0, 200.0, 200.0) == (0.0, 0.0)


@pytest.mark.parametrize("turbine", [-50.0, 0.0, 60.0, 150.0, 199.0, 201.0, 260.0, 500.0])
def test_converter_never_gives_more_power_than_it_takes(turbine):
    taken, given = converter_torques(2.0, 200.0, turbine)
    assert taken * 200.0 - given * turbine >= 0.0
    assert (taken >= 0.0) == (turbine <= 200.0)


def test_engine_has_its_power_at_its_speed():
    """110 kW at 580 rad/s, more torque and less power below; nothing beyond the fuel cut."""
    assert full_load_torque(ENGINE, 580.0) * 580.0 == pytest.approx(110e3)
    assert full_load_torque(ENGINE, 290.0) == pytest.approx(1.25 * 110e3 / 580.0)
    assert full_load_torque(ENGINE, 650.0) == 0.0


def test_engine_at_full_load_stalls_where_the_converter_takes_its_torque():
    """Brakes on, all that there is asked: 3.4325e-3 w^2 = M(w), w = 233 rad/s.

    A percent for what the lag leaves.
    """
    car = plant(engine_car())
    drive(car, 3.0, Wheels.all(2000.0), brake=3000.0)
    speed = car.state[index("engine.speed")]
    assert 3.4325e-3 * speed * speed == pytest.approx(full_load_torque(ENGINE, speed), rel=0.01)
    assert speed == pytest.approx(256.0, rel=0.03)


def test_engine_gives_what_is_asked_and_loses_what_gear_and_converter_take():
    """Steady losses: slip of the converter, 5 % in the gear, 4 % in the final drive."""
    car = plant(engine_car(), initial_speed=20.0, speed="held")
    drive(car, 5.0, Wheels.all(150.0))
    before = car.state.copy()
    wheels = drive(car, 1.0, Wheels.all(150.0))[WheelStates]
    assert sum(wheels.effort) == pytest.approx(0.96 * 600.0, rel=2e-3)
    lost, work, given = (
        car.state[index(name)] - before[index(name)]
        for name in ("driveline_loss", "engine.work", "drive_work")
    )
    shaft = 4.1 * np.mean(wheels.velocity)
    turbine = shaft * Gearbox().ratios[int(car.state[index("engine.gear")]) - 1]
    pump = car.state[index("engine.speed")]
    taken, passed = converter_torques(1.0, pump, turbine)
    in_gear = passed * turbine * (1.0 - 0.95 * 0.96)
    assert lost == pytest.approx(taken * pump - passed * turbine + in_gear, rel=2e-3)
    assert work == pytest.approx(lost + given, rel=1e-3)
    assert car.state[index("battery_work")] == 0.0


def test_engine_goes_backwards_when_that_is_asked_at_rest_and_creeps_without_pedal():
    for torque, gear, sign in ((-100.0, -1.0, -1.0), (100.0, 1.0, 1.0), (0.0, 1.0, 1.0)):
        car = plant(engine_car())
        drive(car, 3.0, Wheels.all(torque))
        assert car.state[index("engine.gear")] == gear
        assert sign * car.state[0] > 0.3


def test_engine_shifts_up_through_all_gears_and_brakes_by_its_drag():
    """Shifts between 150 and 350 rad/s of the turbine.

    Released the torque is none, negative it is at most the drag.
    """
    car = plant(engine_car())
    gears = []
    for _ in range(3000):
        car.advance(command((600.0,) * 4), steered(0.0))
        gears.append(car.state[index("engine.gear")])
    assert sorted(set(gears)) == [1.0, 2.0, 3.0, 4.0, 5.0] and np.all(np.diff(gears) >= 0.0)
    drive(car, 2.0, Wheels.all(0.0))
    # Half a per cent of what it was: the crankshaft follows the car, which the air slows down.
    assert abs(sum(outputs(car)[WheelStates].effort)) < 0.005 * 2400.0
    braking = sum(drive(car, 2.0, Wheels.all(-500.0))[WheelStates].effort)
    ratio = 4.1 * Gearbox().ratios[int(car.state[index("engine.gear")]) - 1]
    drag = ENGINE.drag_torque + ENGINE.drag_growth * car.state[index("engine.speed")]
    # a tenth: the crankshaft slows down, too
    assert braking == pytest.approx(-drag * ratio / (0.95 * 0.96), rel=0.1)


# Laws


def allowed(role: str, vehicle: str) -> set[str]:
    """The methods of a role that take a car of config/vehicles.

    A refusal is one line that names car and coupling.
    """
    values = {f"vehicle.{name}": value for name, value in _values_of(vehicle).items()}
    found = set()
    for name in all_methods()[role]:
        try:
            configure(role, {"method": name, **values})
            found.add(name)
        except ParameterError as error:
            assert "\n" not in str(error)
            assert f"{role} method {name} needs" in str(error) and vehicle in str(error), error
    return found


def _values_of(vehicle: str) -> dict[str, object]:
    from ev_stack.scenarios.files import vehicle_file

    values = vehicle_file(vehicle).values_for("/ev/driver")
    return {name.removeprefix("vehicle."): value for name, value in values.items()}


ANY = {"equal_torque"}
ALL_OWN = {
    *(
        "adaptive",
        "adhesion_share",
        "axle_redistribution",
        "direct_yaw_moment",
        "drive_by_wire",
        "equal_torque",
    ),
    *(
        "limited_slip",
        "limited_slip_variable",
        "load_proportional",
        "open_differential",
        "power_steering",
    ),
    *("steer_by_wire", "steering_correction"),
}


@pytest.mark.parametrize(
    ("vehicle", "laws"),
    [
        ("layout_1_8_a", ANY | {"open_differential"}),
        ("layout_1_8_b", ANY | {"steering_correction"}),  # of the rear axle
        ("layout_1_8_c", ALL_OWN),
        ("layout_1_8_d", ALL_OWN),
        ("centre_dccd", ANY | {"open_differential"}),
        ("engine_4x4", ANY),
    ],
)
def test_every_law_says_which_driveline_it_can_drive(vehicle, laws):
    assert allowed("electronic_differential", vehicle) == laws


@pytest.mark.parametrize(("law", "group"), [("pi_slip", "regulator.limp"), ("slip_window", "limp")])
def test_traction_controls_take_every_driveline_but_not_with_a_limp_mode(law, group):
    """A wheel shows nothing of a lost motor that drives its partner as well."""
    values = {f"vehicle.{name}": value for name, value in _values_of("centre_dccd").items()}
    configure("asr", {"method": law, **values})
    with pytest.raises(
        ParameterError, match=rf"needs a motor or a clutch for each driven wheel for {group}.watch"
    ):
        configure("asr", {"method": law, f"{group}.watch": True, **values})


def test_wheels_of_their_own():
    assert single_wheels(named("layout_1_8_b")) == ("rear_left", "rear_right")
    assert single_wheels(named("layout_1_8_d")) == WHEEL_NAMES
    assert single_wheels(named("centre_dccd")) == single_wheels(named("layout_1_8_a")) == ()


# Manoeuvres


@pytest.mark.sampled
@pytest.mark.slow
@pytest.mark.parametrize("vehicle", CARS)
@pytest.mark.parametrize("manoeuvre", MANOEUVRES)
def test_power_balance_closes_in_every_standard_manoeuvre(vehicle, manoeuvre):
    """Battery and engine give: losses + what they store + work at the wheels.

    that = motion + what roads take.
    """
    (run, *_) = load_scenario(manoeuvre, Overrides(vehicle=vehicle)).runs
    duration = run.duration if manoeuvre == "hill_start" else min(run.duration, 20.0)
    end = DrivenPlant(run.configurations["plant"], run_offline(run.configurations, duration))

    def work(entry: str) -> float:
        return float(end.state[index(entry)])

    turning = [state[index("engine.speed")] ** 2 for state in (end.state, end.start)]
    stored = 0.5 * end.vehicle.engine.inertia * (turning[0] - turning[1])
    spent = stored + sum(
        work(f"{name}") for name in ("motor_loss", "driveline_loss", "auxiliary_work", "drive_work")
    )
    gain = kinetic_energy(end.state, end.vehicle) - kinetic_energy(end.start, end.vehicle)
    sinks = [work(f"{kind}_work") for kind in ("tyre", "friction", "drag", "gravity")]
    flow = max(abs(gain), abs(work("drive_work")), *map(abs, sinks))
    assert work("battery_work") + work("engine.work") == pytest.approx(
        spent, rel=0, abs=1e-4 * flow
    )
    assert work("drive_work") == pytest.approx(gain + sum(sinks), rel=0, abs=1e-4 * flow)
