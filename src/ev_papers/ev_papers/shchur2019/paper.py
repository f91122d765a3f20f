"""Numbers that Shchur (2019) prints, and what follows from his equations with his parameters.

I. Z. Shchur, "Active power steering system in electronic differential of electric vehicle with
individual drive of two front wheels" (in Ukrainian), 2019. Equation numbers are his. The parameters
are written down here once more instead of being taken from the run, so that a run with other
parameters is judged against the paper all the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

J_P = 2.8  # inertia of the steering system at the wheels [kg m^2]
B_P = 7.5  # its damping [N m s/rad]
K_P = 65.0  # its stiffness [N m/rad]
I_RATIO = 16.0  # steering-wheel angle over road-wheel angle, i
TRACK = 1.462  # distance of the front wheels, d [m]
R_K = 0.294  # wheel radius [m]
WHEELBASE = 2.405  # L [m]
L_CM = 0.45  # centre of mass in front of the rear axle, as a fraction of L
GAMMA = 5.0  # amplification of the hand torque
K_CK = 0.051  # stiffness of the law, at the column [N m/rad]
B_CK = 0.062  # damping of the law, at the column [N m s/rad]
MASS = 1400.0  # [kg]
ROLLING_RESISTANCE = 0.015  # k_r [1]
DRAG_COEFFICIENT = 0.3  # c_d [1]
FRONTAL_AREA = 2.1  # A [m^2]
AIR_DENSITY = 1.24  # [kg/m^3]
GRAVITY = 9.81  # not printed [m/s^2]

HAND_TORQUE_OBJECT = 5.0  # step of curve 1 in fig. 1a [N m]
HAND_TORQUE_CLOSED_LOOP = 1.0  # step of curve 2 in fig. 1a and of fig. 1b [N m]

TURN_ANGLE = math.radians(30.0)  # road-wheel angle of both turns, left positive [rad]
LEFT_TURN = (10.0, 18.0)  # [s]
RIGHT_TURN = (37.0, 45.0)  # [s]
SPEED_LEFT_TURN = 15.0 / 3.6  # [m/s]
SPEED_RIGHT_TURN = 30.0 / 3.6  # [m/s]
FIRST_ACCELERATION = (0.0, 4.0)  # [s]
SECOND_ACCELERATION = (25.0, 29.0)  # [s]


@dataclass(frozen=True, slots=True)
class SecondOrder:
    """J d'' + b d' + k d = torque, with J [kg m^2], b [N m s/rad] and k [N m/rad]; underdamped."""

    inertia: float
    damping: float
    stiffness: float

    @property
    def decay(self) -> float:
        """Decay rate of the oscillation [1/s]."""
        return self.damping / (2 * self.inertia)

    @property
    def damped_frequency(self) -> float:
        """Angular frequency of the oscillation [rad/s]."""
        return math.sqrt(self.stiffness / self.inertia - self.decay**2)

    def steady_angle(self, torque: float) -> float:
        """Road-wheel angle under a constant torque about the kingpins [rad]."""
        return torque / self.stiffness

    def deviation(self, time: float) -> float:
        """Step response minus its final value, over it, `time` seconds after the step [1]."""
        phase = self.damped_frequency * time
        swing = math.cos(phase) + self.decay / self.damped_frequency * math.sin(phase)
        return -math.exp(-self.decay * time) * swing

    def rate(self, time: float) -> float:
        """Slope of the step response, as a fraction of its final value [1/s]."""
        natural = self.stiffness / self.inertia
        decayed = math.exp(-self.decay * time)
        return decayed * natural / self.damped_frequency * math.sin(self.damped_frequency * time)


OBJECT = SecondOrder(J_P, B_P, K_P)
CLOSED_LOOP = SecondOrder(J_P, B_P + I_RATIO**2 * B_CK, K_P + I_RATIO**2 * K_CK)


def differential_torque(hand_torque: float, road_wheel_angle: float, rate: float = 0.0) -> float:
    """Right minus left wheel torque of the law at an angle [rad] and its rate, eq. 4 [N m]."""
    lever = 2 * R_K * I_RATIO / TRACK
    return lever * (GAMMA * hand_torque - I_RATIO * (K_CK * road_wheel_angle + B_CK * rate))


def hand_torque_assisted(road_wheel_angle: float) -> float:
    """Hand torque that holds a road-wheel angle with the law (eq. 5 at rest) [N m]."""
    return CLOSED_LOOP.stiffness * road_wheel_angle / ((1 + GAMMA) * I_RATIO)


@dataclass(frozen=True, slots=True)
class Turn:
    """Angles of the front wheels [rad], radii of their paths and of the centre of mass [m].

    All are positive in a left turn and negative in a right turn, also the radius of eq. 11, which
    the paper prints without the sign of delta: both wheels would turn backwards in a right turn.
    """

    right_angle: float
    left_angle: float
    right_radius: float
    left_radius: float
    radius: float


def turn(road_wheel_angle: float) -> Turn:
    """The turn at a road-wheel angle [rad] (eqs 8, 9, 11)."""
    cotangent = 1 / math.tan(road_wheel_angle)
    right = math.atan(WHEELBASE / (WHEELBASE * cotangent + TRACK / 2))
    left = math.atan(WHEELBASE / (WHEELBASE * cotangent - TRACK / 2))
    radius = math.copysign(WHEELBASE * math.hypot(cotangent, L_CM), road_wheel_angle)
    return Turn(right, left, WHEELBASE / math.sin(right), WHEELBASE / math.sin(left), radius)


def wheel_speeds(speed: float, road_wheel_angle: float) -> tuple[float, float]:
    """Speeds of the right and left front wheel at a speed of the car [m/s], eq. 10 [rad/s]."""
    at = turn(road_wheel_angle)
    return speed * at.right_radius / at.radius / R_K, speed * at.left_radius / at.radius / R_K


def speed_difference(speed: float, road_wheel_angle: float) -> float:
    """Right minus left speed of the front rims at a speed of the car [m/s], eq. 12 [m/s]."""
    right, left = wheel_speeds(speed, road_wheel_angle)
    return R_K * (right - left)


def resisting_torque(mean_square_speed: float) -> float:
    """Wheel torque against rolling resistance and drag by the mean of V^2, eq. 13 [N m]."""
    rolling = ROLLING_RESISTANCE * GRAVITY * MASS
    drag = 0.5 * AIR_DENSITY * DRAG_COEFFICIENT * FRONTAL_AREA * mean_square_speed
    return R_K * (rolling + drag)


def accelerating_torque(start: float, end: float, duration: float) -> float:
    """Mean wheel torque while the speed rises evenly from start to end [m/s] (Fig 3) [N m]."""
    # The mean of V^2 over an even rise, which is more than the square of the mean speed.
    mean_square = (start**2 + start * end + end**2) / 3
    return R_K * MASS * (end - start) / duration + resisting_torque(mean_square)
