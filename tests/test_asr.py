"""Traction controls: what every one of them must never do, and what each of them does on a real road."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_control.asr.acceleration_ratio import AccelerationRatio
from ev_control.asr.fuzzy import degrees
from ev_control.asr.least_squares import LeastSquaresParameters
from ev_control.asr.maximum_transmissible_torque import MaximumTransmissibleTorque
from ev_control.asr.slip_curve_fit import SlipCurveFit
from ev_control.asr.slip_window import SlipWindow
from ev_msgs_py.config_directory import config_directory
from ev_msgs_py.methods import find_method, methods_of
from ev_msgs_py.parameters import ParameterError, build
from ev_msgs_py.signals import InertialMeasurement, SteeringColumnState, WheelStates, WheelTorqueRequest
from ev_msgs_py.vehicle import Motor, Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_sim.scenario.offline import run_offline
from ev_sim.scenario.scenario import Overrides, load_scenario
from ev_sim.surfaces.table import SURFACES

PERIOD = 0.005
METHODS = tuple(name for name in methods_of("asr") if name not in ("off", "limit"))
ACCELERATION_LAWS = ("acceleration_ratio", "maximum_transmissible_torque")
CONTROLS = tuple(name for name in METHODS if name != "least_squares_literal")  # those that take torque away
SURFACE_NAMES = ("ice", "packed_snow_1", "wet_asphalt_1", "dry_asphalt")
CAR = Vehicle(
    mass=2170.0,
    wheel_radius=0.32,
    gear_ratio=7.4,
    wheel_inertia=1.658,
    motor=Motor(rotor_inertia=0.02, nominal_torque=250.0),
)
LAYOUTS = (("front_left", "front_right"), ("rear_left", "rear_right"), WHEEL_NAMES)
NOISE = [
    ("plant", "sensors.wheel_speed.noise", 0.03),  # rad/s
    ("plant", "sensors.wheel_torque.noise", 0.5),  # N m
]


def made(name: str, car: Vehicle = CAR, **changed):
    factory = find_method("asr", name).factory
    return factory(build(factory.parameters, changed), car, PERIOD)


@dataclasses.dataclass(frozen=True)
class Measured:
    """All that a law is told in a step."""

    drive: Wheels = NO_WHEELS
    brake: Wheels = NO_WHEELS
    speed: Wheels = NO_WHEELS
    torque: Wheels = NO_WHEELS
    angle: float = 0.0
    yaw_rate: float = 0.0
    a_x: float = 0.0
    a_y: float = 0.0

    def mirrored(self) -> Measured:
        sides = {name: swapped(getattr(self, name)) for name in ("drive", "brake", "speed", "torque")}
        return Measured(**sides, angle=-self.angle, yaw_rate=-self.yaw_rate, a_x=self.a_x, a_y=-self.a_y)

    def reversed(self) -> Measured:
        """The same drive backwards: what turns, pushes or yaws changes its sign, what holds in the bend does not."""
        turned = {name: Wheels(*(-x for x in getattr(self, name))) for name in ("drive", "speed", "torque")}
        return Measured(
            **turned, brake=self.brake, angle=self.angle, yaw_rate=-self.yaw_rate, a_x=-self.a_x, a_y=self.a_y
        )


def swapped(wheels: Wheels) -> Wheels:
    return Wheels(wheels[1], wheels[0], wheels[3], wheels[2])


def step(law, m: Measured) -> Wheels:
    return law.step(
        WheelTorqueRequest(m.drive, m.brake),
        SteeringColumnState(0.0, 0.0, 0.0, m.angle, 0.0),
        WheelStates(NO_WHEELS, m.speed, m.torque),
        InertialMeasurement(m.yaw_rate, m.a_x, m.a_y),
    ).drive


def per_wheel(low: float, high: float):
    return st.builds(Wheels, *[st.floats(low, high)] * 4)


drives = per_wheel(-3000.0, 3000.0) | st.floats(-3000.0, 3000.0).map(Wheels.all)
driven = st.builds(
    Measured,
    drive=drives,
    brake=st.sampled_from((NO_WHEELS, NO_WHEELS, NO_WHEELS, Wheels.all(100.0))),
    speed=per_wheel(-10.0, 100.0),
    torque=drives,
    angle=st.floats(-0.6, 0.6),
    yaw_rate=st.floats(-1.0, 1.0),
    a_x=st.floats(-8.0, 8.0),
    a_y=st.floats(-8.0, 8.0),
)
any_number = st.floats(allow_nan=False, allow_infinity=False)
any_wheels = st.builds(Wheels, *[any_number] * 4)
anything = st.builds(
    Measured,
    drive=any_wheels,
    brake=st.just(NO_WHEELS),
    speed=any_wheels,
    torque=any_wheels,
    angle=any_number,
    yaw_rate=any_number,
    a_x=any_number,
    a_y=any_number,
)
# A constant request and random motion for a while is what fills windows and starts interventions.
launches = st.tuples(drives, st.lists(driven, min_size=1, max_size=12)).map(
    lambda told: [dataclasses.replace(m, drive=told[0], brake=NO_WHEELS) for m in told[1] * 4]
)
sequences = launches | st.lists(driven, min_size=1, max_size=30)
cars = st.sampled_from([dataclasses.replace(CAR, driven_wheels=layout) for layout in LAYOUTS])


def check_limited(asked: Wheels, given_: Wheels) -> None:
    for wanted, torque in zip(asked, given_, strict=True):
        assert math.isfinite(torque)
        assert abs(torque) <= abs(wanted)
        assert torque * wanted >= 0.0


@settings(deadline=None, max_examples=40)
@given(sequence=sequences, car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_torque_is_only_ever_taken_away(name, sequence, car):
    law = made(name, car)
    for m in sequence:
        check_limited(m.drive, step(law, m))


@settings(deadline=None, max_examples=40)
@given(sequence=st.lists(anything | driven, min_size=1, max_size=12), car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_any_finite_numbers_give_finite_torques(name, sequence, car):
    """A broken sensor shows anything; nothing that comes after a sensible number again may be harmed."""
    law = made(name, car)
    for m in sequence:
        check_limited(m.drive, step(law, m))
    for wheel in law.state.wheels:
        assert not math.isnan(wheel.limit)


@pytest.mark.parametrize("name", METHODS)
def test_broken_measurements_leave_the_limits(name):
    """A wheel that spins is limited; a step without a number for its speed keeps the limit to the bit."""
    law = spun_up(name)
    limit = step(law, SPINNING).front_left
    broken = dataclasses.replace(SPINNING, speed=Wheels(math.nan, 30.0, 10.0, 10.0))
    assert step(law, broken).front_left == limit


@settings(deadline=None, max_examples=40)
@given(sequence=sequences, car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_left_and_right_mirror_to_the_bit(name, sequence, car):
    law, mirror = made(name, car), made(name, car)
    for m in sequence:
        assert step(mirror, m.mirrored()) == swapped(step(law, m))


@settings(deadline=None, max_examples=40)
@given(sequence=sequences, car=cars)
@pytest.mark.parametrize("name", METHODS)
def test_reverse_mirrors_forward_to_the_bit(name, sequence, car):
    """Not for the load of adhesion_limit, which an acceleration backwards shifts to the front: without one."""
    law, mirror = made(name, car), made(name, car)
    for m in sequence:
        m = dataclasses.replace(m, a_x=0.0) if name == "adhesion_limit" else m
        assert step(mirror, m.reversed()) == Wheels(*(-torque for torque in step(law, m)))


@settings(deadline=None, max_examples=40)
@given(sequence=sequences)
@pytest.mark.parametrize("name", METHODS)
def test_braking_passes(name, sequence):
    """Whatever was before: with a brake on, and for regeneration at speed."""
    law = made(name)
    for m in sequence:
        step(law, m)
    braked = dataclasses.replace(sequence[-1], brake=Wheels.front(200.0, 200.0))
    assert step(law, braked) == braked.drive
    regenerates = Measured(Wheels.front(-800.0, -800.0), speed=Wheels(5.0, 8.0, 20.0, 20.0))
    assert step(law, regenerates) == regenerates.drive


@settings(deadline=None, max_examples=20)
@given(noise=st.lists(per_wheel(-0.06, 0.06), min_size=60, max_size=60), torque=st.floats(-1000.0, 1000.0))
@pytest.mark.parametrize("name", METHODS)
def test_at_rest_nothing_happens(name, noise, torque):
    """A car that is held by its brakes or its weight: 0.06 rad/s of noise, twice its usual standard deviation."""
    law, drive = made(name), Wheels.front(torque, torque)
    for speed in noise:
        assert step(law, Measured(drive, speed=speed, torque=drive)) == drive


@pytest.mark.parametrize("name", METHODS)
def test_free_wheels_are_asked_for_where_there_are_none(name):
    car = dataclasses.replace(CAR, name="all_wheels", driven_wheels=WHEEL_NAMES)
    prefix = "regulator." if hasattr(find_method("asr", name).factory.parameters(), "regulator") else ""
    with pytest.raises(ValueError, match=f"asr {name} needs a wheel without a motor .* all_wheels drives all four"):
        made(name, car, **{f"{prefix}reference.source": "free_wheels"})
    made(name, car, **{f"{prefix}reference.source": "automatic"})


SPINNING = Measured(
    Wheels.front(1500.0, 1500.0), speed=Wheels(30.0, 30.0, 10.0, 10.0), torque=Wheels.front(1500.0, 1500.0), a_x=1.0
)


def spun_up(name: str):
    """A law that has seen both front wheels spin up from rolling to 30 rad/s in 0.2 s, at 10 rad/s of the others."""
    law = made(name)
    for speed in np.linspace(10.0, 30.0, 40).tolist():
        step(law, dataclasses.replace(SPINNING, speed=Wheels(speed, speed, 10.0, 10.0)))
    return law


@pytest.mark.parametrize("name", CONTROLS)
def test_a_spinning_wheel_loses_torque_and_the_other_one_does_not(name):
    """The left wheel spins up at 100 rad/s^2, the right one rolls: after 0.2 s below 90 % left, and all of it right."""
    law = made(name)
    for speed in np.linspace(10.0, 30.0, 40).tolist():
        left, right, *_ = step(law, dataclasses.replace(SPINNING, speed=Wheels(speed, 10.0, 10.0, 10.0)))
    assert left < 0.9 * 1500.0
    assert right == 1500.0


@pytest.mark.parametrize("name", METHODS)
def test_a_released_pedal_forgets_the_limit(name):
    law = spun_up(name)
    step(law, dataclasses.replace(SPINNING, drive=NO_WHEELS))
    assert all(wheel.limit == math.inf for wheel in law.state.wheels)


# The fit of eqs 2.34 to 2.36


@settings(deadline=None)
@given(
    samples=st.lists(st.tuples(st.floats(-0.1, 1.0), st.floats(-1.0, 1.0)), min_size=25, max_size=120),
)
def test_running_sums_are_those_of_the_window(samples):
    """The normal equations after every sample equal those of the last 25 within rounding of sums of 25 terms."""
    fit = SlipCurveFit(25, 1e-4)
    for slip, torque in samples:
        fit.add(slip, torque)
    x = np.maximum(np.array([slip for slip, _ in samples[-25:]]), 0.0)
    y, root = np.array([torque for _, torque in samples[-25:]]), np.sqrt(x + 1e-4)
    assert (fit.sum_x, fit.sum_xx) == pytest.approx((x.sum(), (x * x).sum()), rel=1e-12, abs=1e-12)
    sums = (fit.sum_x_root, fit.sum_xy, fit.sum_root_y)
    assert sums == pytest.approx(((x * root).sum(), (x * y).sum(), (root * y).sum()), rel=1e-12, abs=1e-12)


def test_the_fit_gives_its_own_curve_back():
    """The curve y = -4 x + 2 sqrt(x + e) has its peak where sqrt(x + e) = 2/8."""
    fit = SlipCurveFit(25, 1e-4)
    for x in np.linspace(0.01, 0.12, 25).tolist():
        fit.add(x, -4.0 * x + 2.0 * math.sqrt(x + 1e-4))
    assert fit.coefficients() == pytest.approx((-4.0, 2.0), rel=1e-9)
    assert fit.peak() == pytest.approx(1 / 16 - 1e-4, rel=1e-9)


def test_samples_that_do_not_differ_have_no_curve():
    fit = SlipCurveFit(25, 1e-4)
    for _ in range(60):
        fit.add(0.05, 0.3)
    assert fit.coefficients() is None
    assert fit.peak() is None


@pytest.mark.parametrize("surface", ["packed_snow_1", "wet_asphalt_1", "dry_asphalt"])
def test_the_fit_finds_burckhardts_peak(surface):
    """A window that ends at 1.1 S* and begins at a third of that: within 10 % of S*, without noise (measured 9 %)."""
    of = SURFACES[surface]
    star = math.log(of.c1 * of.c2 / of.c3) / of.c2
    fit = SlipCurveFit(25, 1e-4)
    for x in np.linspace(1.1 * star / 3, 1.1 * star, 25).tolist():
        fit.add(x, of.c1 * (1 - math.exp(-of.c2 * x)) - of.c3 * x)
    assert fit.peak() == pytest.approx(star, rel=0.15)


def test_relations_of_parameters_are_checked():
    with pytest.raises(ParameterError, match=r"backstop is 0\.05"):
        LeastSquaresParameters(backstop=0.05)
    with pytest.raises(ParameterError, match=r"low is 0\.2"):
        SlipWindow.parameters(low=0.2)


# Laws alone, by hand


def test_transmissible_torque_by_hand():
    """With M_w = 1500, w' = 100, J = 1.658 + 7.4^2 0.02 = 2.7532: r F_d = 1224.68, times 1 + J/(0.9 1085 0.32^2)."""
    law = MaximumTransmissibleTorque(MaximumTransmissibleTorque.parameters(filter_time=0.0), CAR, PERIOD)
    for speed in (10.0, 10.5):
        torque = step(law, dataclasses.replace(SPINNING, speed=Wheels(speed, speed, 10.0, 10.0))).front_left
    assert torque == pytest.approx(1224.68 * (1 + 2.7532 / (0.9 * 1085.0 * 0.32**2)), rel=1e-12)


def test_the_printed_ratio_of_accelerations_is_always_undercut():
    """A wheel that rolls without any slip at 3 m/s^2: w' = 9.375, a_x/w' = 0.32 m, below 0.4 but not below 0.16."""
    for threshold, falls in ((0.4, True), (0.16, False)):
        law = AccelerationRatio(AccelerationRatio.parameters(threshold=threshold), CAR, PERIOD)
        for n in range(100):
            rolling = Wheels.all(10.0 + 9.375 * PERIOD * n)
            torque = step(law, dataclasses.replace(SPINNING, speed=rolling, a_x=3.0)).front_left
        assert (torque < 1500.0) is falls


def test_fuzzy_degrees_add_up_to_one():
    assert degrees(0.0) == (0.0, 1.0, 0.0)
    assert degrees(-0.25) == (0.25, 0.75, 0.0)
    assert degrees(9.0) == (0.0, 0.0, 1.0)


# On the road: the car of the dissertation, with noise, at 5 ms


@cache
def launch(
    method: str, surfaces: tuple[str, ...], torque: float, ramp: float, duration: float, lengths=(), more=()
) -> dict[str, np.ndarray]:
    """Channels of a launch with a drive torque that rises from 0.5 s on, straight ahead."""
    values = [
        ("*", "control_period", PERIOD),
        ("plant", "road.left", list(surfaces)),
        ("plant", "road.right", list(surfaces)),
        *([("plant", "road.pattern", "segments"), ("plant", "road.length", list(lengths))] if lengths else []),
        ("driver", "pedals.time", [0.0, 0.5, 0.5 + ramp]),
        ("driver", "pedals.drive_torque", [0.0, 0.0, torque]),
        ("driver", "pedals.brake_torque", [0.0, 0.0, 0.0]),
        ("asr", "method", method),
        *NOISE,
        *more,
    ]
    run = load_scenario("launch_split_mu", Overrides((), values, duration)).runs[0]
    return run_offline(run.configurations, run.duration).channels


def full_throttle(method: str, surface: str) -> dict[str, np.ndarray]:
    """3000 N m within a second: more than any of these roads carries but dry asphalt, and nearly that."""
    return launch(method, (surface,), 3000.0, 1.0, 5.0)


def slip_of(channels: dict[str, np.ndarray], wheel: str = "front_left") -> np.ndarray:
    return channels[f"tire_forces.slip_ratio.{wheel}"]


def friction_use(channels: dict[str, np.ndarray], wheel: str) -> np.ndarray:
    """Longitudinal force over what the road could carry [1]."""
    carried = channels[f"tire_forces.load.{wheel}"] * channels[f"tire_forces.friction_coefficient.{wheel}"]
    return channels[f"tire_forces.longitudinal_force.{wheel}"] / carried


def is_limited(channels: dict[str, np.ndarray], wheel: str) -> np.ndarray:
    return channels[f"torque_command.drive.{wheel}"] < channels[f"torque_request.drive.{wheel}"]


@pytest.mark.parametrize("surface", SURFACE_NAMES)
@pytest.mark.parametrize("name", METHODS)
def test_launches_do_not_chatter(name, surface):
    """From rest: the torque never turns its sign, and the car gets away as well as without control, within 1 %.

    On ice the force hardly depends on the slip, so there is nothing to win; a limit that falls too far only loses.
    slip_window and the laws that only know accelerations lose up to 15 % of the speed there. Slip is never negative but
    for the spring of the carcass at rest; the latter take so much torque at walking speed that the wheel swings back.
    """
    channels, off = full_throttle(name, surface), full_throttle("off", surface)
    for wheel in ("front_left", "front_right"):
        assert channels[f"torque_command.drive.{wheel}"].min() >= 0.0
        assert slip_of(channels, wheel).min() > (-0.2 if name in ACCELERATION_LAWS else -0.02)
    least = 0.85 if surface == "ice" and name in ("slip_window", *ACCELERATION_LAWS) else 0.99
    assert channels["twist.longitudinal"][-1] >= least * off["twist.longitudinal"][-1]


@pytest.mark.parametrize("surface", SURFACE_NAMES)
@pytest.mark.parametrize("name", CONTROLS)
def test_mean_slip_is_lower_than_without(name, surface):
    """On every road; on snow at most a third of the 0.82 without control, but for the law that knows no slip."""
    mean, off = (slip_of(full_throttle(law, surface))[200:].mean() for law in (name, "off"))
    assert mean < off
    if surface == "packed_snow_1":
        assert mean < (0.7 if name == "maximum_transmissible_torque" else 0.34) * off


@pytest.mark.parametrize("surface", SURFACE_NAMES)
def test_the_literal_form_does_nothing_useful(surface):
    """Its mean slip is that of no control within 5 %."""
    mean, off = (slip_of(full_throttle(law, surface))[200:].mean() for law in ("least_squares_literal", "off"))
    assert mean == pytest.approx(off, rel=0.05)


@pytest.mark.parametrize(("surface", "low", "high"), [("wet_asphalt_1", 0.11, 0.19), ("packed_snow_1", 0.09, 0.19)])
def test_slip_window_swings_below_its_window_behind_the_peak(surface, low, high):
    """0.15..0.19 lies behind the peaks (0.13 and 0.09): the wheel passes the window, and the mean is below it."""
    slip = slip_of(full_throttle("slip_window", surface))[400:]
    assert low < slip.mean() < 0.15
    assert np.quantile(slip, 0.95) == pytest.approx(high, abs=0.02)


@pytest.mark.parametrize("name", ["pi_slip", "feedback_linearisation", "fuzzy"])
@pytest.mark.parametrize("surface", ["packed_snow_1", "wet_asphalt_1"])
def test_slip_regulators_hold_their_target(name, surface):
    """0.1 within 0.015 on the mean of the last 3 s; its noise at 2 m/s is 0.005."""
    assert slip_of(full_throttle(name, surface))[400:].mean() == pytest.approx(0.1, abs=0.015)


# Least squares: what the specification asks for


def pressed_slowly(surface: str) -> dict[str, np.ndarray]:
    """A pedal that takes 6 s: what passes the peak is the torque, not the wheel's inertia."""
    return launch("least_squares", (surface,), 3800.0, 6.0, 12.0)


@pytest.mark.parametrize("wheel", ["front_left", "front_right"])
@pytest.mark.parametrize(("surface", "star"), [("wet_asphalt_1", 0.1308), ("packed_snow_1", 0.0907)])
def test_least_squares_hits_at_the_peak_and_stays_there(surface, star, wheel):
    """At the first hit at least 97 % of the peak friction; then 0.8..1.5 S* on the mean and for most of the time.

    Measured: 98.4 % and more; means of 0.89 to 1.21 S*; 71 to 98 % of the time inside. The curve is flat about the
    peak, so even the rest of the time costs little: the friction in use is at least 99 % on the mean.
    """
    channels = pressed_slowly(surface)
    first = int(np.argmax(is_limited(channels, wheel)))
    assert first > 0
    use = friction_use(channels, wheel)
    assert use[first] >= 0.97
    slip = slip_of(channels, wheel)[first + 100 :]  # half a second for the first approach
    assert 0.8 * star < slip.mean() < 1.5 * star
    assert np.mean((slip > 0.8 * star) & (slip < 1.5 * star)) > 0.65
    assert use[first + 100 :].mean() > 0.99


def test_least_squares_leaves_dry_driving_alone():
    """580 s of the TRRL cycle on dry asphalt: not a single hit, and so the same torques to the bit."""
    values = [
        ("*", "control_period", PERIOD),
        ("plant", "road.left", ["dry_asphalt"]),
        ("plant", "road.right", ["dry_asphalt"]),
        ("driver", "method", "speed_profile"),
        ("driver", "speed_profile.file", str(config_directory() / "cycles" / "trrl_1_1.csv")),
        ("driver", "speed_control.max_drive_torque", 4000.0),
        ("steering_column", "method", "manual"),
        ("asr", "method", "least_squares"),
        *NOISE,
    ]
    run = load_scenario("launch_split_mu", Overrides((), values, 580.0)).runs[0]
    channels = run_offline(run.configurations, run.duration).channels
    assert channels["twist.longitudinal"].max() > 13.0  # 48 km/h: the cycle was driven
    for wheel in ("front_left", "front_right"):
        command, request = channels[f"torque_command.drive.{wheel}"], channels[f"torque_request.drive.{wheel}"]
        np.testing.assert_array_equal(command, request)


def test_least_squares_on_ice_ends_the_spin_by_its_backstop():
    """Without a peak the slip swings below the backstop of 0.3, as soon as it counts against the speed of the car."""
    channels = launch("least_squares", ("ice",), 3000.0, 1.0, 12.0)
    fast = channels["wheel_states.velocity.rear_left"] > 4.0
    assert fast.sum() > 400
    assert slip_of(channels)[fast].mean() < 0.3


# Jumps of friction

RECOVERY = {  # seconds from dry asphalt under the wheel to 90 % of the request, after snow
    "least_squares": 0.15,
    "slip_window": 0.6,
    "acceleration_ratio": 1.0,
    "maximum_transmissible_torque": 0.8,
    "adhesion_limit": 1.3,
    "pi_slip": 0.6,
    "feedback_linearisation": 0.3,
    "fuzzy": 1.2,
}
PEAK_ON_ICE = {  # largest slip after dry asphalt ends at 26 km/h with 1200 N m at the wheel; 0.79 without control
    "least_squares": 0.4,
    "slip_window": 0.7,
    "acceleration_ratio": 0.65,
    "maximum_transmissible_torque": 0.6,
    "adhesion_limit": 0.45,
    "pi_slip": 0.4,
    "feedback_linearisation": 0.32,
    "fuzzy": 0.72,
}


@pytest.mark.parametrize("name", CONTROLS)
def test_torque_recovers_after_a_jump_up(name):
    """Snow, then dry asphalt after 10 m; the bounds are the measured times and what noise may add."""
    channels = launch(name, ("packed_snow_1", "dry_asphalt"), 2600.0, 1.0, 8.0, (10.0,))
    on_dry = int(np.argmax(channels["tire_forces.friction_coefficient.front_left"] > 0.8))
    served = channels["torque_command.drive.front_left"][on_dry:] >= 0.9 * 1300.0
    assert served.any()
    assert np.argmax(served) * PERIOD < RECOVERY[name]


@pytest.mark.parametrize("name", CONTROLS)
def test_slip_is_limited_after_a_jump_down(name):
    """Dry asphalt, then 15 m of ice: below the largest slip without control, by the method's own margin."""
    slips = {}
    for law in (name, "off"):
        channels = launch(law, ("dry_asphalt", "ice", "dry_asphalt"), 2400.0, 1.0, 8.0, (10.0, 15.0))
        on_ice = channels["tire_forces.friction_coefficient.front_left"] < 0.1
        slips[law] = slip_of(channels)[on_ice]
    assert slips[name].max() < PEAK_ON_ICE[name]
    assert slips["off"].max() > 0.75
    assert slips[name].mean() < 0.7 * slips["off"].mean()


# Without free wheels


@pytest.mark.parametrize("surface", ["packed_snow_1", "wet_asphalt_1"])
def test_the_observer_takes_the_place_of_free_wheels(surface):
    """The same car with the observer instead: the mean slip is still less than twice that of the peak."""
    more = (("asr", "reference.source", "observer"),)
    channels = launch("least_squares", (surface,), 3000.0, 1.0, 5.0, (), more)
    star = {"wet_asphalt_1": 0.1308, "packed_snow_1": 0.0907}[surface]
    assert 0.5 * star < slip_of(channels)[400:].mean() < 2.0 * star


def test_a_car_that_drives_all_four_wheels_has_traction_control():
    """Snow, 1250 N m at each wheel: a fifth faster at least, with a third of the slip; no wheel shows the speed."""
    more = (("*", "vehicle.driven_wheels", WHEEL_NAMES),)
    off, on = (launch(law, ("packed_snow_1",), 5000.0, 1.5, 6.0, (), more) for law in ("off", "least_squares"))
    for wheel in WHEEL_NAMES:
        assert slip_of(on, wheel)[300:].mean() < slip_of(off, wheel)[300:].mean() / 3
    assert on["twist.longitudinal"][-1] > 1.2 * off["twist.longitudinal"][-1]


def test_least_squares_at_the_default_period():
    """10 ms halve the samples of the window: still within 0.8..1.5 S* on the mean of the last 6 s (measured 1.3)."""
    channels = launch("least_squares", ("packed_snow_1",), 3800.0, 6.0, 12.0, (), (("*", "control_period", 0.01),))
    assert 0.8 * 0.0907 < slip_of(channels)[600:].mean() < 1.5 * 0.0907
