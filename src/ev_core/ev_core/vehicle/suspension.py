"""Springs, links and bushes of the axles, and the body that rolls on them.

How it works: a body with a `sprung_mass` m_s rolls by phi to the outside of a bend, about an axis
through the roll centres at heights h_f and h_r of the axles. Its centre of mass, at height h_s,
lies d = h_s - h_axis above the axis and moves sideways by d phi; the other m_u = m - m_s stays
upright at the height of the wheel centres. With c the centre of mass of the whole car, which
moves by e phi, e = m_s d/m, and F_y the sum of the side forces of the tyres:

    m a_y = F_y                                              Newton, for the whole car
    m_s a_s = m_s (F_y/m - (1 - m_s/m) d phi'')              the part of F_y that the links pass on
    J_x phi'' = d m_s a_s + m_s g d phi - k phi - b phi'     Euler, about the centre of mass of m_s

    (J_x + (1 - m_s/m) m_s d^2) phi'' = m_s d F_y/m - (k - m_s g d) phi - b phi'

with k and b the roll stiffness and damping of both axles. m_s g d phi is the moment of the weight,
which moves outwards. An axle takes what its links pass on at the height of the roll centre, the
side force of its own masses, and its part of springs and dampers:

    front: (l_r/L) (m_s h_f + m_u r) F_y/m + k_f phi + b_f phi'
    rear:  (l_f/L) (m_s h_r + m_u r) F_y/m + k_r phi + b_r phi'

Both together are h_s m_s a_s + r m_u a_u + m_s g d phi - J_x phi'', the moment about the ground,
but for (r - h_axis) m_u e phi'', which is left out. The steady phi is m_s d a_y/(k - m_s g d): the
weight adds the factor k/(k - m_s g d) to what springs take. Sources: Pacejka, Tire and Vehicle
Dynamics, 3rd ed. 2012, sections 1.2.2 (load transfer over c_phi - m g h') and 1.3.1 (plane motion
with roll, by Lagrange); Milliken & Milliken, Race Car Vehicle Dynamics, 1995, chapter 18 (shares).
Angles are small; camber, roll steer, the tilt of the axis, products of inertia and the sideways
place of c in the yaw moment of longitudinal forces are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.parameters.declaration import setting
from ev_msgs_py.refusal import ParameterError


@dataclass(frozen=True, slots=True)
class Suspension:
    """Roll stiffness, roll centres, compliance steer, and a body that rolls.

    The defaults are axles without any of them, below a rigid body.
    """

    sprung_mass: float = setting(
        0.0,
        unit="kg",
        low=0.0,
        high=60000.0,
        about="of the body that rolls on both axles, m_s; 0: the body does not roll",
    )
    sprung_mass_height: float = setting(
        0.0,
        unit="m",
        low=0.0,
        high=4.0,
        about="of its centre of mass above the road, h_s; 0 for `centre_of_mass_height`, which "
        "pitches the car",
    )
    roll_inertia: float = setting(
        0.0,
        unit="kg m^2",
        low=0.0,
        high=1e6,
        about="of the sprung mass about the axis ahead through its centre of mass, J_x",
    )
    front_roll_damping: float = setting(
        0.0, unit="N m s/rad", low=0.0, high=1e6, about="of the front dampers, as the body rolls"
    )
    rear_roll_damping: float = setting(
        0.0, unit="N m s/rad", low=0.0, high=1e6, about="of the rear dampers, as the body rolls"
    )

    front_roll_stiffness: float = setting(
        0.0,
        unit="N m/rad",
        low=0.0,
        high=1e7,
        about="of springs and stabiliser in front; 0 for `front_roll_share`",
    )
    rear_roll_stiffness: float = setting(
        0.0,
        unit="N m/rad",
        low=0.0,
        high=1e7,
        about="of springs and stabiliser behind; 0 for `front_roll_share`",
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
        about="time in which the loads of a body that does not roll follow a lateral "
        "acceleration; 0 for the plant's `load_transfer_lag`",
    )
    front_compliance_steer: float = setting(
        0.0,
        unit="rad/N",
        low=-1e-4,
        high=1e-4,
        about="angle by which a side force on the front axle turns its wheels out of the bend: "
        "understeer",
    )
    rear_compliance_steer: float = setting(
        0.0,
        unit="rad/N",
        low=-1e-4,
        high=1e-4,
        about="angle by which a side force on the rear axle turns its wheels into the bend: "
        "understeer",
    )

    def __post_init__(self) -> None:
        if (self.front_roll_stiffness > 0.0) != (self.rear_roll_stiffness > 0.0):
            raise ParameterError(
                "front_roll_stiffness and rear_roll_stiffness are given both or neither"
            )
        if 0.0 < self.roll_lag < 0.002:
            raise ParameterError(f"roll_lag is {self.roll_lag:g} s, expected 0 or 0.002 to 1 s")

        needed = {
            "front_roll_stiffness": "of both axles",
            "roll_inertia": "above 0",
        }
        for name, expected in needed.items():
            if self.rolls and getattr(self, name) == 0.0:
                raise ParameterError(f"sprung_mass needs {name} {expected}, expected it beside it")
        if self.rolls and self.roll_lag > 0.0:
            raise ParameterError(
                f"roll_lag is {self.roll_lag:g} s, expected 0 beside sprung_mass: the body itself "
                "takes its time"
            )

    @property
    def has_roll_stiffness(self) -> bool:
        """True if stiffness and roll centres give the shares of the lateral load transfer."""
        return self.front_roll_stiffness > 0.0

    @property
    def rolls(self) -> bool:
        """True if the body rolls."""
        return self.sprung_mass > 0.0

    @property
    def stiffness(self) -> float:
        """Roll stiffness of both axles, k [N m/rad]."""
        return self.front_roll_stiffness + self.rear_roll_stiffness

    def axis_height(self, front_load_share: float) -> float:
        """Height of the roll axis below the centre of mass [m]."""
        return (
            front_load_share * self.front_roll_centre_height
            + (1.0 - front_load_share) * self.rear_roll_centre_height
        )

    def front_roll_share(self, height: float, front_load_share: float) -> float:
        """Share of the front axle in the lateral load transfer of a body that does not roll [1].

        A side force acts in the roll centres without rolling the body, the rest of its moment by
        the arm of the centre of mass (`height` [m], share of the front axle in the weight [1]) over
        the roll axis is shared by stiffness. Source: Milliken & Milliken, Race Car Vehicle
        Dynamics, 1995, chapter 18; the moment of the weight that moves out is left out.
        """
        axis = self.axis_height(front_load_share)
        elastic = self.front_roll_stiffness / self.stiffness
        return (
            front_load_share * self.front_roll_centre_height + (height - axis) * elastic
        ) / height


class RollingBody(NamedTuple):
    """Constants of a body that rolls, by the symbols of the head of this module; all 0 without."""

    lever: float = 0.0  # e [m]: by so much the centre of mass of the car moves over the angle
    inertia: float = 0.0  # J_x + (1 - m_s/m) m_s d^2 [kg m^2]
    weight: float = 0.0  # m_s d [kg m], which gravity times the angle turns over
    front_link: float = 0.0  # m times the height at which the front axle takes F_y/m [kg m]
    rear_link: float = 0.0  # the same of the rear axle [kg m]

    def front_and_rear_moment(self, suspension: Suspension, gravity: float) -> tuple[float, float]:
        """Steady roll moments that the axles take over the lateral acceleration [kg m]."""
        angle = self.gradient(suspension, gravity)
        return (
            self.front_link + suspension.front_roll_stiffness * angle,
            self.rear_link + suspension.rear_roll_stiffness * angle,
        )

    def gradient(self, suspension: Suspension, gravity: float) -> float:
        """Steady roll angle over the lateral acceleration [rad s^2/m]."""
        return self.weight / (suspension.stiffness - self.weight * gravity)


def rolling_body(
    suspension: Suspension, mass: float, heights: tuple[float, float], front_load_share: float
) -> RollingBody:
    """The constants of a car's body; `heights` are those of the car's centre of mass and wheels."""
    if not suspension.rolls:
        return RollingBody()
    sprung = suspension.sprung_mass
    height, wheel_height = heights
    arm = (suspension.sprung_mass_height or height) - suspension.axis_height(front_load_share)
    upright = (mass - sprung) * wheel_height
    rear_load_share = 1.0 - front_load_share
    return RollingBody(
        lever=sprung / mass * arm,
        inertia=suspension.roll_inertia + (1.0 - sprung / mass) * sprung * arm * arm,
        weight=sprung * arm,
        front_link=front_load_share * (sprung * suspension.front_roll_centre_height + upright),
        rear_link=rear_load_share * (sprung * suspension.rear_roll_centre_height + upright),
    )
