"""The coefficients of a tyre by the Magic Formula, as tyre property files name them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

from ev_msgs_py.contract.record import entry
from ev_msgs_py.parameters.declaration import ParameterError

# What a file may leave out, and what it then is; the others have to be there.
OPTIONAL = {
    "pdx2": 0.0,
    "pex1": 0.0,
    "pex2": 0.0,
    "pex3": 0.0,
    "pex4": 0.0,
    "pkx2": 0.0,
    "pkx3": 0.0,
    "pdy2": 0.0,
    "pey1": 0.0,
    "pey2": 0.0,
    "pky4": 2.0,
    "rex1": 0.0,
    "rex2": 0.0,
    "rey1": 0.0,
    "rey2": 0.0,
    "rhy1": 0.0,
    "rhy2": 0.0,
}


@dataclass(slots=True)
class MfTyre:
    """A tyre of MF-Tyre 5.2 or 6.x that stands upright at its nominal pressure, alike to both sides.

    Coefficients of terms with camber, pressure or turn slip are left out, and so are those that make a force without
    slip or one that differs from left to right (conicity, ply steer: P_H, P_V, P_Ey3, R_Bx alpha shifts, R_V): two
    tyres of an axle are mounted as mirror images of each other. Names and equations: Pacejka, Tire and Vehicle
    Dynamics, 3rd ed. 2012, section 4.3.2, eqs 4.E9 to 4.E65.
    """

    fnomin: float = entry(4000.0, unit="N", about="nominal load, scaled by LFZO")
    pcx1: float = entry(1.65, unit="1", about="shape factor of the longitudinal force")
    pdx1: float = entry(1.0, unit="1", about="longitudinal friction at nominal load")
    pdx2: float = entry(unit="1", about="its change with load")
    pex1: float = entry(unit="1", about="longitudinal curvature at nominal load")
    pex2: float = entry(unit="1", about="its change with load")
    pex3: float = entry(unit="1", about="its change with squared load")
    pex4: float = entry(unit="1", about="its share that changes from driving to braking")
    pkx1: float = entry(20.0, unit="1", about="longitudinal slip stiffness over load at nominal load")
    pkx2: float = entry(unit="1", about="its change with load")
    pkx3: float = entry(unit="1", about="exponent of its change with load")
    pcy1: float = entry(1.3, unit="1", about="shape factor of the side force")
    pdy1: float = entry(1.0, unit="1", about="lateral friction at nominal load")
    pdy2: float = entry(unit="1", about="its change with load")
    pey1: float = entry(unit="1", about="lateral curvature at nominal load")
    pey2: float = entry(unit="1", about="its change with load")
    pky1: float = entry(15.0, unit="1", about="largest cornering stiffness over nominal load")
    pky2: float = entry(2.0, unit="1", about="load of the largest cornering stiffness over nominal load")
    pky4: float = entry(2.0, unit="1", about="curvature of the cornering stiffness over load")
    rbx1: float = entry(unit="1", about="slope of the weight of side slip on the longitudinal force")
    rbx2: float = entry(unit="1", about="its change with slip ratio")
    rcx1: float = entry(unit="1", about="shape factor of that weight")
    rex1: float = entry(unit="1", about="curvature of that weight at nominal load")
    rex2: float = entry(unit="1", about="its change with load")
    rby1: float = entry(unit="1", about="slope of the weight of the slip ratio on the side force")
    rby2: float = entry(unit="1", about="its change with slip angle")
    rcy1: float = entry(unit="1", about="shape factor of that weight")
    rey1: float = entry(unit="1", about="curvature of that weight at nominal load")
    rey2: float = entry(unit="1", about="its change with load")
    rhy1: float = entry(unit="1", about="slip ratio at which that weight is centred, negative, at nominal load")
    rhy2: float = entry(unit="1", about="its change with load")
    takes_tangent: float = entry(1.0, unit="1", about="1: slip angle as its tangent (6.x), 0: as the angle (5.2)")


MF_NAMES = tuple(f.name for f in fields(MfTyre))


def refuse_mf_tyre(axle: str, numbers: Sequence[float]) -> None:
    """ParameterError if the numbers of an axle's tyre are not those of MfTyre or give no friction."""
    if len(numbers) != len(MF_NAMES):
        raise ParameterError(
            f"curve mf_tyre needs {axle}_file, or {axle}_mf with {len(MF_NAMES)} elements, not {len(numbers)}"
        )
    for name in ("fnomin", "pcx1", "pdx1", "pkx1", "pcy1", "pdy1", "pky1", "pky2"):
        value = numbers[MF_NAMES.index(name)]
        if value <= 0.0:
            raise ParameterError(f"{name.upper()} of the {axle} tyres is {value:g}, allowed is above 0")
