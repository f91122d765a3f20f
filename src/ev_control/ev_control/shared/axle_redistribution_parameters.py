"""Parameters of the torque redistribution of Zhileykin (2018) besides those of its equations."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.slip_angle_observer import SlipAngleObserverParameters
from ev_control.shared.neutral_steer import NeutralSteerParameters
from ev_control.shared.sources import SOURCES
from ev_control.shared.torque_split import BrakeSplitParameters
from ev_msgs_py.parameters.declaration import group, parameter

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
        source="assumption",
    )
    acceleration_deadband: float = parameter(
        0.1,
        unit="m/s^2",
        low=1e-6,
        high=5.0,
        about="acceleration below which its direction is undefined and the last one is held",
        source="assumption",
    )
    speed_deadband: float = parameter(
        0.1,
        unit="rad/s",
        low=0.0,
        high=10.0,
        about="difference of the rear wheel speeds that changes which one is the slower",
        source="assumption",
    )
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
