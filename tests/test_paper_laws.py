"""The electronic differentials of Ge & Ni, Tatar & Chudzik and Zhileykin, each alone and computed by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_control.electronic_differential.axle_redistribution import AxleRedistribution
from ev_control.electronic_differential.free_wheel_speed import free_wheel_speed
from ev_control.electronic_differential.slip_angle_observer import (
    SlipAngleObserver,
    SlipAngleObserverParameters,
    axle_slip_angles,
)
from ev_control.electronic_differential.slip_ratio import slip_ratio
from ev_control.electronic_differential.slip_target import SlipTarget
from ev_control.electronic_differential.steering_correction import SteeringCorrection
from ev_msgs_py.methods import find_method
from ev_msgs_py.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels

FRONT, REAR = ("front_left", "front_right"), ("rear_left", "rear_right")
PERIOD = 0.01
GE_NI = Vehicle(
    name="ge_ni2005",
    mass=2500.0,
    wheelbase=1.72,
    front_track=1.12,
    rear_track=1.12,
    centre_of_mass_to_rear_axle=0.82,
    wheel_radius=0.32,
    driven_wheels=REAR,
)
FOUR = Vehicle(
    name="zhileykin_4x4",
    mass=2400.0,
    wheelbase=2.7,
    front_track=1.55,
    rear_track=1.55,
    centre_of_mass_to_rear_axle=1.35,
    wheel_radius=0.35,
    yaw_inertia=4200.0,
    driven_wheels=WHEEL_NAMES,
)
LAWS = ((SlipTarget, GE_NI), (SteeringCorrection, FOUR), (AxleRedistribution, FOUR))


def made(kind: type, car: Vehicle, **changed):
    return kind(dataclasses.replace(kind.parameters(), **changed), car, PERIOD)


@dataclasses.dataclass(frozen=True)
class Motion:
    """All that a law may measure."""

    torque: float = 2400.0
    brake: float = 0.0
    angle: float = 0.0
    speeds: Wheels = NO_WHEELS
    u: float = 5.0
    v: float = 0.0
    r: float = 0.0
    a_x: float = 0.0
    a_y: float = 0.0

    def mirrored(self) -> Motion:
        fl, fr, rl, rr = self.speeds
        return dataclasses.replace(
            self, angle=-self.angle, speeds=Wheels(fr, fl, rr, rl), v=-self.v, r=-self.r, a_y=-self.a_y
        )

    def parts(self):
        driver = DriverCommand(self.torque, self.brake, 0.0)
        column = SteeringColumnState(16 * self.angle, 0.0, 0.0, self.angle, 0.0)
        wheels = WheelStates(NO_WHEELS, self.speeds, NO_WHEELS)
        imu = InertialMeasurement(self.r, self.a_x, self.a_y)
        return driver, column, wheels, imu, BodyVelocity(self.u, self.v, self.r)


def step(law, motion: Motion) -> WheelTorqueRequest:
    driver, column, *rest = motion.parts()
    return law.step(driver, column) if isinstance(law, SteeringCorrection) else law.step(driver, column, *rest)


motions = st.builds(
    Motion,
    torque=st.floats(-3000.0, 3000.0),
    brake=st.sampled_from((0.0, 0.0, 500.0)),
    angle=st.floats(-0.5, 0.5),
    speeds=st.builds(Wheels, *[st.floats(-10.0, 100.0)] * 4),
    u=st.floats(-5.0, 30.0),
    v=st.floats(-5.0, 5.0),
    r=st.floats(-1.0, 1.0),
    a_x=st.floats(-5.0, 5.0),
    a_y=st.floats(-5.0, 5.0),
)
sequences = st.lists(motions, min_size=1, max_size=8)


@pytest.mark.parametrize("name", ["slip_target", "steering_correction", "axle_redistribution"])
def test_laws_are_registered(name):
    assert find_method("electronic_differential", name).name == name


@pytest.mark.parametrize(
    ("kind", "driven", "message"),
    [
        (SlipTarget, FRONT, "slip_target needs rear_left and rear_right among"),
        (SlipTarget, WHEEL_NAMES, "slip_target needs rear_left and rear_right as the only"),
        (SteeringCorrection, ("rear_left",), "steering_correction needs rear_left and rear_right among"),
        (AxleRedistribution, REAR, "axle_redistribution needs front_left, front_right, rear_left and rear_right among"),
    ],
)
def test_layouts_that_do_not_fit_are_refused(kind, driven, message):
    with pytest.raises(ValueError, match=message):
        made(kind, dataclasses.replace(FOUR, driven_wheels=driven))


@settings(deadline=None)
@given(sequence=sequences, source=st.sampled_from(("truth", "estimated")))
@pytest.mark.parametrize(("kind", "car"), LAWS)
def test_laws_mirror_to_the_bit(kind, car, sequence, source):
    changed = {} if kind is SteeringCorrection else {"source": source}
    law, mirror = made(kind, car, **changed), made(kind, car, **changed)
    for motion in sequence:
        fl, fr, rl, rr = step(mirror, motion.mirrored()).drive
        assert step(law, motion).drive == (fr, fl, rr, rl)


@settings(deadline=None)
@given(sequence=sequences)
@pytest.mark.parametrize(("kind", "car"), LAWS[1:])
def test_sharing_laws_keep_the_sum_and_the_sign(kind, car, sequence):
    """The shares add up to the driver's torque within rounding, and no wheel works against the others."""
    law = made(kind, car)
    for motion in sequence:
        drive = step(law, motion).drive
        assert sum(drive) == pytest.approx(motion.torque, rel=1e-12, abs=1e-300)
        assert all(torque * motion.torque >= 0.0 for torque in drive)


@settings(deadline=None)
@given(sequence=sequences, reading=st.sampled_from(("rate", "offset", "increment")), layer=st.booleans())
def test_slip_target_stays_within_its_limit(sequence, reading, layer):
    """Each torque is within half of its equal share of it (largest_correction 0.5); no pedal, no correction."""
    law = made(SlipTarget, GE_NI, reading=reading, boundary_layer=layer)
    for motion in sequence:
        drive, share = step(law, motion).drive, motion.torque / 2
        assert drive[:2] == (0.0, 0.0)
        if motion.torque <= 0.0 or motion.brake > 0.0:
            assert drive[2:] == (share, share)
        else:
            assert all(0.5 * share * (1 - 1e-12) <= torque <= 1.5 * share * (1 + 1e-12) for torque in drive[2:])


@pytest.mark.parametrize(("kind", "car"), LAWS)
def test_brakes_go_by_the_front_share(kind, car):
    assert step(made(kind, car), Motion(torque=0.0, brake=1000.0)).brake == pytest.approx((300, 300, 200, 200))


# Slip target


def test_slip_ratio_has_the_divisor_of_the_paper():
    """(10 - 8)/10 driving, (8 - 10)/10 braking, and no slip at rest."""
    assert slip_ratio(10.0, 8.0, 0.5) == pytest.approx(0.2, rel=1e-14)
    assert slip_ratio(8.0, 10.0, 0.5) == pytest.approx(-0.2, rel=1e-14)
    assert slip_ratio(0.0, 0.0, 0.5) == 0.0


def left_turn(slip_left: float, slip_right: float) -> Motion:
    """Speed 5 m/s, delta = 0.03 rad, r = 0.1 rad/s; rear wheels V = 5 -+ 0.1 * 0.56 m/s at the given slip ratios."""
    speeds = Wheels.rear(4.944 / (1 - slip_left) / 0.32, 5.056 / (1 - slip_right) / 0.32)
    return Motion(angle=0.03, r=0.1, speeds=speeds)


OUTER_TARGET = 0.19 - 0.11 * (0.1 - 0.03 * 5.0 / 1.72)  # 0.18859


@pytest.mark.parametrize(
    ("reading", "after_one", "after_two"), [("rate", 0.01, 0.02), ("offset", 1, 1), ("increment", 1, 2)]
)
def test_readings_of_the_switching_control(reading, after_one, after_two):
    """Both wheels are far below their targets, so they gain 50 and 100 N m (inner, outer) times the reading's step."""
    law, motion = made(SlipTarget, GE_NI, reading=reading), left_turn(0.05, 0.05)
    for factor in (after_one, after_two):
        drive = step(law, motion).drive
        assert drive[2:] == pytest.approx((1200 + 50 * factor, 1200 + 100 * factor), rel=1e-12)


def test_boundary_layer_is_linear_in_the_slip_error():
    """Errors of 0.4 and -0.25 layers give 0.4 and -0.25 of the gains; without the layer the full gains."""
    motion = left_turn(0.19 - 0.4e-3, OUTER_TARGET + 0.25e-3)
    inside = step(made(SlipTarget, GE_NI, reading="offset"), motion).drive
    assert inside[2:] == pytest.approx((1220.0, 1175.0), abs=1e-8)
    switched = step(made(SlipTarget, GE_NI, reading="offset", boundary_layer=False), motion).drive
    assert switched[2:] == pytest.approx((1250.0, 1100.0), rel=1e-12)


def test_pedal_release_forgets_the_correction():
    law = made(SlipTarget, GE_NI, reading="increment")
    step(law, left_turn(0.05, 0.05))
    assert law.state.left > 0.0
    assert step(law, dataclasses.replace(left_turn(0.05, 0.05), torque=0.0)).drive == NO_WHEELS
    assert (law.state.left, law.state.right) == (0.0, 0.0)


def test_free_wheel_speed_on_a_rolling_circle():
    """Wheels that roll on a circle of 10 m: the front middle moves with r L/sin(delta) along itself."""
    delta, r = math.atan(1.72 / 10), 0.5
    rim = r * 1.72 / math.sin(delta) / 0.32
    assert free_wheel_speed(Wheels.front(rim - 1, rim + 1), delta, r, GE_NI) == pytest.approx(5.0, rel=1e-12)


# Steering correction


@pytest.mark.parametrize(
    ("driven", "axle", "expected"),
    [
        (FRONT, "automatic", (25, 75, 0, 0)),
        (REAR, "automatic", (0, 0, 25, 75)),
        (WHEEL_NAMES, "automatic", (12.5, 37.5, 25, 25)),
        (WHEEL_NAMES, "rear", (25, 25, 12.5, 37.5)),
    ],
)
def test_half_of_the_inner_torque_moves_at_pi_over_ten(driven, axle, expected):
    """100 N m in all, steering left by pi/10: -50 % inside, +50 % outside on the corrected axle."""
    law = made(SteeringCorrection, dataclasses.replace(FOUR, driven_wheels=driven), axle=axle)
    assert step(law, Motion(torque=100.0, angle=math.pi / 10)).drive == pytest.approx(expected, rel=1e-12)


def test_correction_is_limited():
    law = made(SteeringCorrection, FOUR, largest_correction=0.2)
    assert step(law, Motion(torque=100.0, angle=0.5)).drive == pytest.approx((20, 30, 25, 25), rel=1e-12)


# Axle redistribution


def test_front_slides_by_cos_phi():
    """With cos(phi) = 0.6 and k = 0.5, h = 0.3; q = 2.7*0.1*0.3/(2*1.55*0.7) = 0.0373, by hand."""
    law = made(AxleRedistribution, FOUR, k=0.5)
    drive = step(law, Motion(torque=1000.0, angle=0.1, a_x=0.6, a_y=0.8)).drive
    q = 2.7 * 0.1 * 0.3 / (2 * 1.55 * 0.7)
    assert drive == pytest.approx((150, 150, 350 * (1 + q), 350 * (1 - q)), rel=1e-12)


def test_rear_slides_by_one_minus_cos_phi():
    """Sliding to the right at 2 m/s puts 0.4 rad on the rear axle and 0.3 on the front: h = k (1 - 0.6) = 0.2."""
    law = made(AxleRedistribution, FOUR, k=0.5)
    drive = step(law, Motion(torque=1000.0, angle=-0.1, v=-2.0, a_x=0.6, a_y=0.8)).drive
    assert drive.front_left + drive.front_right == pytest.approx(200.0, rel=1e-12)


def test_front_share_ends_at_one_half():
    assert step(made(AxleRedistribution, FOUR), Motion(torque=1000.0, a_x=1.0)).drive == (250.0,) * 4


@pytest.mark.parametrize("motion", [Motion(torque=-400.0, a_x=-2.0), Motion(torque=100.0, brake=50.0)])
def test_braking_puts_all_torque_on_the_rear_axle(motion):
    drive = step(made(AxleRedistribution, FOUR), motion).drive
    assert drive == (0.0, 0.0, motion.torque / 2, motion.torque / 2)


def test_deadbands_hold_branch_and_direction():
    """Straight ahead noise of the slip angles within +-0.004 rad and of the acceleration changes no torque."""
    law = made(AxleRedistribution, FOUR)
    first = step(law, Motion(torque=1000.0, a_x=0.3))
    for sign in (1, -1, 1, -1):
        noisy = Motion(torque=1000.0, v=0.01, r=sign * 0.005, a_x=sign * 0.02, a_y=0.05)
        assert step(law, noisy) == first


def bicycle(duration: float, angle: float, speed: float, stiffness: float):
    """Motions of a linear single-track car after a step of the steering angle, explicit Euler at 1 kHz."""
    v = r = 0.0
    half, dt = 1.35, 0.001
    for k in range(round(duration / dt)):
        front = stiffness * (angle - (v + half * r) / speed)
        rear = -stiffness * (v - half * r) / speed
        a_y = (front + rear) / 2400
        if k % 10 == 0:
            fl = ((speed - 0.775 * r) * math.cos(angle) + (v + half * r) * math.sin(angle)) / 0.35
            fr = ((speed + 0.775 * r) * math.cos(angle) + (v + half * r) * math.sin(angle)) / 0.35
            rim = Wheels(fl, fr, (speed - 0.775 * r) / 0.35, (speed + 0.775 * r) / 0.35)
            yield Motion(angle=angle, speeds=rim, u=speed, v=v, r=r, a_y=a_y)
        v, r = v + dt * (a_y - r * speed), r + dt * half * (front - rear) / 4200


def observed(true_stiffness: float) -> tuple[float, float]:
    """Largest and last error of the observer's slip angles in a step steer, over the largest slip angle [1]."""
    observer = SlipAngleObserver(SlipAngleObserverParameters(), FOUR, PERIOD)
    errors, largest = [], 0.0
    for motion in bicycle(2.0, 0.02, 15.0, true_stiffness):
        driver, column, wheels, imu, body = motion.parts()
        estimate = observer.step(driver, column, wheels, imu)
        truth = axle_slip_angles(body.longitudinal, body.lateral, body.yaw_rate, motion.angle, FOUR, 1.0)
        errors.append(max(abs(e - t) for e, t in zip(estimate, truth, strict=True)))
        largest = max(largest, *(abs(t) for t in truth))
    return max(errors) / largest, errors[-1] / largest


def test_observer_follows_a_step_steer_of_the_tyre_it_knows():
    """Measured 4.4 % underway, of which one period of v' (10 ms) is most, and 0.4 % settled (small angles)."""
    underway, settled = observed(160e3)
    assert underway < 0.06
    assert settled < 0.01


def test_observer_cannot_see_a_slippery_road_in_a_steady_turn():
    """With a tyre half as stiff the axles slip twice as much, and the observer's tyre decides: it misses the rest.

    The rear axle's true slip angle is twice that of the stiffer tyre; the transient of two seconds is not over, and u
    comes with it, so only 30 to 55 % of the largest slip angle is asked.
    """
    _, settled = observed(80e3)
    assert 0.3 < settled < 0.55
