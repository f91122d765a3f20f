"""The coefficients of a tyre by the Magic Formula, as tyre property files name them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

from ev_msgs_py.contract.record import per_wheel
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
class MfTyres:
    """Tyres of MF-Tyre 5.2 or 6.x that stand upright at their nominal pressure, alike to both sides, by wheel.

    Coefficients of terms with camber, pressure or turn slip are left out, and so are those that make a force without
    slip or one that differs from left to right (conicity, ply steer: P_H, P_V, P_Ey3, R_Bx alpha shifts, R_V): two
    tyres of an axle are mounted as mirror images of each other. Names and equations: Pacejka, Tire and Vehicle
    Dynamics, 3rd ed. 2012, section 4.3.2, eqs 4.E9 to 4.E65.
    """

    fnomin: list[float] = per_wheel(4000.0, unit="N", about="nominal load, scaled by LFZO")
    pcx1: list[float] = per_wheel(1.65, unit="1", about="shape factor of the longitudinal force")
    pdx1: list[float] = per_wheel(1.0, unit="1", about="longitudinal friction at nominal load")
    pdx2: list[float] = per_wheel(unit="1", about="its change with load")
    pex1: list[float] = per_wheel(unit="1", about="longitudinal curvature at nominal load")
    pex2: list[float] = per_wheel(unit="1", about="its change with load")
    pex3: list[float] = per_wheel(unit="1", about="its change with squared load")
    pex4: list[float] = per_wheel(unit="1", about="its share that changes from driving to braking")
    pkx1: list[float] = per_wheel(20.0, unit="1", about="longitudinal slip stiffness over load at nominal load")
    pkx2: list[float] = per_wheel(unit="1", about="its change with load")
    pkx3: list[float] = per_wheel(unit="1", about="exponent of its change with load")
    pcy1: list[float] = per_wheel(1.3, unit="1", about="shape factor of the side force")
    pdy1: list[float] = per_wheel(1.0, unit="1", about="lateral friction at nominal load")
    pdy2: list[float] = per_wheel(unit="1", about="its change with load")
    pey1: list[float] = per_wheel(unit="1", about="lateral curvature at nominal load")
    pey2: list[float] = per_wheel(unit="1", about="its change with load")
    pky1: list[float] = per_wheel(15.0, unit="1", about="largest cornering stiffness over nominal load")
    pky2: list[float] = per_wheel(2.0, unit="1", about="load of the largest cornering stiffness over nominal load")
    pky4: list[float] = per_wheel(2.0, unit="1", about="curvature of the cornering stiffness over load")
    rbx1: list[float] = per_wheel(unit="1", about="slope of the weight of side slip on the longitudinal force")
    rbx2: list[float] = per_wheel(unit="1", about="its change with slip ratio")
    rcx1: list[float] = per_wheel(unit="1", about="shape factor of that weight")
    rex1: list[float] = per_wheel(unit="1", about="curvature of that weight at nominal load")
    rex2: list[float] = per_wheel(unit="1", about="its change with load")
    rby1: list[float] = per_wheel(unit="1", about="slope of the weight of the slip ratio on the side force")
    rby2: list[float] = per_wheel(unit="1", about="its change with slip angle")
    rcy1: list[float] = per_wheel(unit="1", about="shape factor of that weight")
    rey1: list[float] = per_wheel(unit="1", about="curvature of that weight at nominal load")
    rey2: list[float] = per_wheel(unit="1", about="its change with load")
    rhy1: list[float] = per_wheel(
        unit="1", about="slip ratio at which that weight is centred, negative, at nominal load"
    )
    rhy2: list[float] = per_wheel(unit="1", about="its change with load")
    takes_tangent: list[float] = per_wheel(
        1.0, unit="1", about="1: slip angle as its tangent (6.x), 0: as the angle (5.2)"
    )


MF_NAMES = tuple(f.name for f in fields(MfTyres))
# The polynomials of the plant are good for so much (`elementary.unbranched`), which is beyond what tyres have.
_LIMITS = {
    **dict.fromkeys(("pcx1", "pcy1", "pky4", "rcx1", "rcy1"), (0.0, 3.0)),
    "pkx3": (-2.0, 2.0),
}


def mf_tyres(front: Sequence[float], rear: Sequence[float]) -> MfTyres:
    """The tyres of a car from the numbers of an axle's each, those of the record where there are none."""
    if not front:
        return MfTyres()
    return MfTyres(*([f, f, r, r] for f, r in zip(front, rear, strict=True)))


def refuse_mf_tyre(axle: str, numbers: Sequence[float]) -> None:
    """ParameterError if the numbers of an axle's tyre are not those of MfTyres or give no friction."""
    if len(numbers) != len(MF_NAMES):
        raise ParameterError(
            f"curve mf_tyre needs {axle}_file, or {axle}_mf with {len(MF_NAMES)} elements, not {len(numbers)}"
        )
    for name in ("fnomin", "pcx1", "pdx1", "pkx1", "pcy1", "pdy1", "pky1", "pky2"):
        value = numbers[MF_NAMES.index(name)]
        if value <= 0.0:
            raise ParameterError(f"{name.upper()} of the {axle} tyres is {value:g}, allowed is above 0")
    for name, (low, high) in _LIMITS.items():
        value = numbers[MF_NAMES.index(name)]
        if not low <= value <= high:
            raise ParameterError(f"{name.upper()} of the {axle} tyres is {value:g}, allowed is {low:g} to {high:g}")
