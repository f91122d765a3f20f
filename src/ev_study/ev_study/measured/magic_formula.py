"""The Magic Formula 6.1 for arrays, with inclination, pressure and shifts, which the tyres of the plant leave out.

Axes ISO: a slip angle to the left of the wheel is positive and makes a side force to the right, so
P_Ky1 is negative. Source: Pacejka, Tire and Vehicle Dynamics, 3rd ed. 2012, eqs 4.E1 to 4.E67,
without turn slip; all scale factors are 1.

How it works: each force is a sine of an arctangent of the slip (`_curve`) with four factors B, C,
D, E that depend on load, pressure and inclination; under combined slip it is weighed by a cosine of
the other slip (`_weight`). The names of the coefficients are those of property files, in upper
case. The small epsilon of the printed quotients are left out: loads of a rig are above zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Coefficients = Mapping[str, float]


@dataclass(frozen=True)
class Points:
    """Inputs and answers of a tyre, (n,) each.

    Slip ratio, angles [rad], load [N], pressure [Pa], forces [N].
    """

    slip_ratio: np.ndarray
    slip_angle: np.ndarray
    inclination: np.ndarray
    load: np.ndarray
    pressure: np.ndarray
    longitudinal_force: np.ndarray
    lateral_force: np.ndarray

    def some(self, chosen: np.ndarray) -> Points:
        """Those that are marked or numbered."""
        return Points(**{name: getattr(self, name)[chosen] for name in self.__dataclass_fields__})


def _changes(c: Coefficients, x: Points) -> tuple[np.ndarray, np.ndarray]:
    """df_z and dp_i (eqs 4.E2a, 4.E2b)."""
    return (x.load - c["FNOMIN"]) / c["FNOMIN"], (x.pressure - c["NOMPRES"]) / c["NOMPRES"]


def _curve(d: np.ndarray, shape: float, b: np.ndarray, e: np.ndarray, x: np.ndarray) -> np.ndarray:
    bx = b * x
    # E above 1 would turn the curve back on itself (the book demands at most 1 in eqs 4.E14,
    # 4.E24).
    bent: np.ndarray = d * np.sin(shape * np.arctan(bx - np.minimum(e, 1.0) * (bx - np.arctan(bx))))
    return bent


def longitudinal(c: Coefficients, x: Points) -> np.ndarray:
    """F_x0 of pure slip [N] (eqs 4.E9 to 4.E18)."""
    dfz, dp = _changes(c, x)
    # kappa_x and S_Hx (4.E10, 4.E17).
    slip = x.slip_ratio + c["PHX1"] + c["PHX2"] * dfz
    # mu_x, D_x and E_x (4.E13, 4.E12, 4.E14).
    friction = (c["PDX1"] + c["PDX2"] * dfz) * (1 + c["PPX3"] * dp + c["PPX4"] * dp**2)
    d = friction * (1 - c["PDX3"] * x.inclination**2) * x.load
    e = (c["PEX1"] + c["PEX2"] * dfz + c["PEX3"] * dfz**2) * (1 - c["PEX4"] * np.sign(slip))
    # K_xk and B_x = K_xk/(C_x D_x) (4.E15, 4.E16): B follows from the stiffness at zero slip.
    stiffness = x.load * (c["PKX1"] + c["PKX2"] * dfz) * np.exp(c["PKX3"] * dfz)
    b = stiffness * (1 + c["PPX1"] * dp + c["PPX2"] * dp**2) / (c["PCX1"] * d)
    return _curve(d, c["PCX1"], b, e, slip) + x.load * (c["PVX1"] + c["PVX2"] * dfz)


def _lateral_friction(c: Coefficients, x: Points) -> np.ndarray:
    dfz, dp = _changes(c, x)
    found: np.ndarray = (c["PDY1"] + c["PDY2"] * dfz) * (1 + c["PPY3"] * dp + c["PPY4"] * dp**2)
    return found * (1 - c["PDY3"] * x.inclination**2)


def lateral(c: Coefficients, x: Points) -> np.ndarray:
    """F_y0 of pure slip [N] (eqs 4.E19 to 4.E30)."""
    dfz, dp = _changes(c, x)
    camber = x.inclination
    # K_ya (4.E25): rises with the load up to PKY2 times the nominal one, and falls beyond it.
    at = x.load / c["FNOMIN"] / ((c["PKY2"] + c["PKY5"] * camber**2) * (1 + c["PPY2"] * dp))
    stiffness = c["PKY1"] * c["FNOMIN"] * (1 + c["PPY1"] * dp) * (1 - c["PKY3"] * np.abs(camber))
    stiffness = stiffness * np.sin(c["PKY4"] * np.arctan(at))
    # S_Vyg and K_yg0 (4.E28, 4.E30): inclination pushes the wheel without any slip angle.
    shift_v = x.load * (c["PVY3"] + c["PVY4"] * dfz) * camber
    of_camber = x.load * (c["PKY6"] + c["PKY7"] * dfz) * (1 + c["PPY5"] * dp)
    # alpha_y with S_Hy (4.E20, 4.E27), by tan(alpha) as alpha* is defined for a wheel that rolls
    # ahead.
    angle = (
        np.tan(x.slip_angle)
        + c["PHY1"]
        + c["PHY2"] * dfz
        + (of_camber * camber - shift_v) / stiffness
    )
    d = _lateral_friction(c, x) * x.load
    # E_y (4.E24).
    bend = 1 + c["PEY5"] * camber**2 - (c["PEY3"] + c["PEY4"] * camber) * np.sign(angle)
    e = (c["PEY1"] + c["PEY2"] * dfz) * bend
    return (
        _curve(d, c["PCY1"], stiffness / (c["PCY1"] * d), e, angle)
        + x.load * (c["PVY1"] + c["PVY2"] * dfz)
        + shift_v
    )


def _weight(shape: float, b: np.ndarray, x: np.ndarray, centre: np.ndarray | float) -> np.ndarray:
    # G over its value at the shift (4.E51/52, 4.E59/60): the weight is 1 without the other slip.
    found: np.ndarray = np.cos(shape * np.arctan(b * x)) / np.cos(shape * np.arctan(b * centre))
    return found


def combined_longitudinal(c: Coefficients, x: Points) -> np.ndarray:
    """F_x [N] (eqs 4.E50 to 4.E57), E_xa 0."""
    b = (c["RBX1"] + c["RBX3"] * x.inclination**2) * np.cos(np.arctan(c["RBX2"] * x.slip_ratio))
    return longitudinal(c, x) * _weight(c["RCX1"], b, np.tan(x.slip_angle) + c["RHX1"], c["RHX1"])


def combined_lateral(c: Coefficients, x: Points) -> np.ndarray:
    """F_y [N] (eqs 4.E58 to 4.E67), E_yk 0."""
    dfz, _ = _changes(c, x)
    tangent, camber = np.tan(x.slip_angle), x.inclination
    b = (c["RBY1"] + c["RBY4"] * camber**2) * np.cos(np.arctan(c["RBY2"] * (tangent - c["RBY3"])))
    centre = c["RHY1"] + c["RHY2"] * dfz
    # S_Vyk and D_Vyk (4.E66, 4.E67): driving or braking alone makes a side force (ply steer).
    of_slip = _lateral_friction(c, x) * x.load * (c["RVY1"] + c["RVY2"] * dfz + c["RVY3"] * camber)
    of_slip = (
        of_slip
        * np.cos(np.arctan(c["RVY4"] * tangent))
        * np.sin(c["RVY5"] * np.arctan(c["RVY6"] * x.slip_ratio))
    )
    return lateral(c, x) * _weight(c["RCY1"], b, x.slip_ratio + centre, centre) + of_slip
