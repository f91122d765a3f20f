"""Parameters of the torque redistribution of Zhileykin (2018) besides those of its equations."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.slip_angle_observer import SlipAngleObserverParameters
from ev_control.shared.torque_split import BrakeSplitParameters
from ev_core.law import Car, compilable, group, parameter

SOURCES = ("truth", "estimated")
TRUTH, ESTIMATED = range(len(SOURCES))


FACTORS = ("given", "inertia", "equality")
GIVEN, INERTIA, EQUALITY = range(len(FACTORS))
SECOND_BRANCHES = ("printed", "derived", "rear_share")
PRINTED, DERIVED, REAR_SHARE = range(len(SECOND_BRANCHES))
LARGEST_ACCELERATION = 100.0  # [m/s^2], more than any car's; with the next one it keeps the factor of eq 4 finite
LEAST_FORCE = 1.0  # [N]


@dataclass(frozen=True, slots=True)
class NeutralSteerParameters:
    """How the equations are read where the source leaves a choice."""

    factor: str = parameter(
        "given",
        choices=FACTORS,
        about="front share over cos(phi), K: k; 2 J_z/(m L^2), which eq 4 gives without resistance; or "
        "2 J_z j/(L^2 X), eq 4 as an equality with the measured acceleration j and the drive force X that is asked for",
        source="Zhileykin 2018, eqs 4 and 5, prints proportionality",
    )
    k: float = parameter(
        1.0, unit="1", low=0.0, high=5.0, about="K of the factor `given`; 1 reads proportional as equal"
    )
    second_branch: str = parameter(
        "printed",
        choices=SECOND_BRANCHES,
        about="front share while the rear slides: K (1 - cos(phi)); K cos(phi), which follows from the line above "
        "eq 5; or 1 - K cos(phi), which follows if that line means the rear share",
        source="Zhileykin 2018, eq 5, which does not follow from the line above it",
    )
    largest_front_share: float = parameter(
        0.5, unit="1", low=0.0, high=0.9, about="limit of the front share h_n", source="Zhileykin 2018"
    )


@compilable
def front_share(
    p: NeutralSteerParameters, car: Car, front_slides: bool, cos_phi: float, acceleration: float, force: float
) -> float:
    """Share h_n [1] of the front axle, by the acceleration j [m/s^2], its angle phi to the car's axis and X [N].

    K cos(phi) while the front slides (eq 4, where |W12| = 0 gives h_n X = 2 J_z j cos(phi)/L^2), and `second_branch`
    while the rear does (eq 5), within 0..largest_front_share.
    """
    factor, lever = p.k, 2.0 * car.yaw_inertia / (car.wheelbase * car.wheelbase)
    if p.factor == INERTIA:
        factor = lever / car.mass
    elif p.factor == EQUALITY:
        factor = lever * min(acceleration, LARGEST_ACCELERATION) / max(force, LEAST_FORCE)
    share = factor * cos_phi
    if not front_slides and p.second_branch == PRINTED:
        share = factor * (1.0 - cos_phi)
    elif not front_slides and p.second_branch == REAR_SHARE:
        share = 1.0 - share
    return min(max(share, 0.0), p.largest_front_share)


@compilable
def rear_difference(car: Car, road_wheel_angle: float, front_share: float) -> float:
    """The difference q = L |Theta| h_n/(2 B (1 - h_n)) [1], at most 1 (eq 7 at constant speed); Theta [rad], h_n < 1.

    Of the rear torque the slower wheel gets (1 + q)/2 and the faster one (1 - q)/2.
    """
    q = car.wheelbase * abs(road_wheel_angle) * front_share / (2.0 * car.rear_track * (1.0 - front_share))
    return min(q, 1.0)


BRAKING = ("deceleration", "command")
DECELERATION, COMMAND = range(len(BRAKING))
REAR_WHEELS = ("by_speed", "by_geometry")
BY_SPEED, BY_GEOMETRY = range(len(REAR_WHEELS))
AXLES = ("front", "rear")
FRONT, REAR = range(len(AXLES))


@dataclass(frozen=True, slots=True)
class AxleRedistributionParameters(NeutralSteerParameters):
    """How the source is read, where the slip angles come from, and deadbands."""

    source: str = parameter(
        "truth",
        choices=SOURCES,
        about="slip angles: from the true velocity of the twist topic, or from the observer",
        source="Zhileykin 2018 uses the true ones",
    )
    braking: str = parameter(
        "deceleration",
        choices=BRAKING,
        about="when all torque goes to the rear axle: while the car slows down, j_x <= 0; or while the driver brakes, "
        "by a negative drive torque or the brake",
        source="Zhileykin 2018: phi = pi, j_y = 0, j_x <= 0, that is while the car slows down",
    )
    rear_wheels: str = parameter(
        "by_speed",
        choices=REAR_WHEELS,
        about="rear wheel that gets more: the slower one; or the inner one, which is the slower one unless it spins",
        source="Zhileykin 2018, eq 7: the lagging wheel",
    )
    first_branch: str = parameter(
        "front",
        choices=AXLES,
        about="axle that counts as sliding until the slip angles differ by more than the deadband",
        source="assumption: equal slip angles count as a sliding front",
    )
    slip_angle_deadband: float = parameter(
        0.005,
        unit="rad",
        low=0.0,
        high=0.5,
        about="difference of the magnitudes of the slip angles that changes the branch; straight ahead it is undefined",
    )
    acceleration_deadband: float = parameter(
        0.1,
        unit="m/s^2",
        low=1e-6,
        high=5.0,
        about="acceleration below which its direction is undefined and the last one is held",
    )
    speed_deadband: float = parameter(
        0.1,
        unit="rad/s",
        low=0.0,
        high=10.0,
        about="difference of the rear wheel speeds that changes which one is the slower",
    )
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
