"""What the springs, links and bushes of the axles do to loads and angles of the wheels."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.parameters.declaration import setting
from ev_msgs_py.refusal import ParameterError


@dataclass(frozen=True, slots=True)
class Suspension:
    """Roll stiffness, roll centres and compliance steer; the defaults are an axle without any of them."""

    front_roll_stiffness: float = setting(
        0.0, unit="N m/rad", low=0.0, high=1e7, about="of springs and stabiliser in front; 0 for `front_roll_share`"
    )
    rear_roll_stiffness: float = setting(
        0.0, unit="N m/rad", low=0.0, high=1e7, about="of springs and stabiliser behind; 0 for `front_roll_share`"
    )
    front_roll_centre_height: float = setting(
        0.0, unit="m", low=-1.0, high=3.0, about="of the front axle, above the road"
    )
    rear_roll_centre_height: float = setting(
        0.0, unit="m", low=-1.0, high=3.0, about="of the rear axle, above the road"
    )
    roll_lag: float = setting(
        0.0,
        unit="s",
        low=0.0,
        high=1.0,
        about="time in which the loads follow a lateral acceleration; 0 for the plant's `load_transfer_lag`",
    )
    front_compliance_steer: float = setting(
        0.0,
        unit="rad/N",
        low=-1e-4,
        high=1e-4,
        about="angle by which a side force on the front axle turns its wheels out of the bend: understeer",
    )
    rear_compliance_steer: float = setting(
        0.0,
        unit="rad/N",
        low=-1e-4,
        high=1e-4,
        about="angle by which a side force on the rear axle turns its wheels into the bend: understeer",
    )

    def __post_init__(self) -> None:
        if (self.front_roll_stiffness > 0.0) != (self.rear_roll_stiffness > 0.0):
            raise ParameterError("front_roll_stiffness and rear_roll_stiffness are given both or neither")
        if 0.0 < self.roll_lag < 0.002:
            raise ParameterError(f"roll_lag is {self.roll_lag:g} s, allowed is 0 or 0.002 to 1 s")

    @property
    def has_roll_stiffness(self) -> bool:
        """Whether the share of the axles in the lateral load transfer follows from stiffness and roll centres."""
        return self.front_roll_stiffness > 0.0

    def front_roll_share(self, height: float, front_load_share: float) -> float:
        """Share of the front axle in the lateral load transfer [1], of a body that rolls about its roll axis.

        A side force acts in the roll centres without rolling the body, the rest of its moment by the arm of the centre
        of mass (`height` [m], share of the front axle in the weight [1]) over the roll axis is shared by stiffness.
        Source: Milliken & Milliken, Race Car Vehicle Dynamics, 1995, chapter 18; the moment of the weight that moves
        out with the roll angle is left out.
        """
        axis = (
            front_load_share * self.front_roll_centre_height + (1.0 - front_load_share) * self.rear_roll_centre_height
        )
        elastic = self.front_roll_stiffness / (self.front_roll_stiffness + self.rear_roll_stiffness)
        return (front_load_share * self.front_roll_centre_height + (height - axis) * elastic) / height
