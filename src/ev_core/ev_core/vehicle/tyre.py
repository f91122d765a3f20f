"""The tyres of a vehicle, and the coefficients of one by the Magic Formula."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

from ev_core.parameters.declaration import own, parameter, setting
from ev_core.parameters.record import per_wheel
from ev_core.vehicle.tmeasy import estimated_tmeasy, refuse_tmeasy, tyre_size
from ev_msgs_py.refusal import ParameterError

# What a file may leave out, and what it then is; the others have to be there.
_ZERO = "pdx2 pex1 pex2 pex3 pex4 pkx2 pkx3 pdy2 pey1 pey2 rex1 rex2 rey1 rey2 rhy1 rhy2"
OPTIONAL = {**dict.fromkeys(_ZERO.split(), 0.0), "pky4": 2.0}
# The polynomials of the plant are good for so much (`elementary.unbranched`), which is beyond what
# tyres have.
_LIMITS = {
    **dict.fromkeys(("pcx1", "pcy1", "pky4", "rcx1", "rcy1"), (0.0, 3.0)),
    "pkx3": (-2.0, 2.0),
}
# How many of the coefficients of a curve give no friction unless they are positive.
POSITIVE_COEFFICIENTS = {
    "burckhardt": 0,
    "rational": 2,
    "two_exponential": 3,
    "magic_formula": 3,
    "linear": 1,
    "mf_tyre": 0,
    "dry_friction": 4,
    "tmeasy": 0,
}
# Curves with load dependence of their own, axle by axle, and the combination of slips of each.
OF_LOAD = {"mf_tyre": "weighted", "tmeasy": "normalized"}


@dataclass(slots=True)
class MfTyres:
    """Tyres of MF-Tyre 5.2 or 6.x by wheel: upright, at nominal pressure, alike to both sides.

    Coefficients of terms with camber, pressure or turn slip are left out, and so are those that
    make a force without slip or one that differs from left to right (conicity, ply steer: P_H, P_V,
    P_Ey3, R_Bx alpha shifts, R_V): two tyres of an axle are mounted as mirror images of each other.
    Names and equations: Pacejka, Tire and Vehicle Dynamics, 3rd ed. 2012, section 4.3.2, eqs 4.E9
    to 4.E65.
    """

    fnomin: list[float] = per_wheel(4000.0, unit="N", about="nominal load, scaled by LFZO")
    pcx1: list[float] = per_wheel(1.65, unit="1", about="shape factor of the longitudinal force")
    pdx1: list[float] = per_wheel(1.0, unit="1", about="longitudinal friction at nominal load")
    pdx2: list[float] = per_wheel(unit="1", about="its change with load")
    pex1: list[float] = per_wheel(unit="1", about="longitudinal curvature at nominal load")
    pex2: list[float] = per_wheel(unit="1", about="its change with load")
    pex3: list[float] = per_wheel(unit="1", about="its change with squared load")
    pex4: list[float] = per_wheel(unit="1", about="its share that changes from driving to braking")
    pkx1: list[float] = per_wheel(
        20.0, unit="1", about="longitudinal slip stiffness over load at nominal load"
    )
    pkx2: list[float] = per_wheel(unit="1", about="its change with load")
    pkx3: list[float] = per_wheel(unit="1", about="exponent of its change with load")
    pcy1: list[float] = per_wheel(1.3, unit="1", about="shape factor of the side force")
    pdy1: list[float] = per_wheel(1.0, unit="1", about="lateral friction at nominal load")
    pdy2: list[float] = per_wheel(unit="1", about="its change with load")
    pey1: list[float] = per_wheel(unit="1", about="lateral curvature at nominal load")
    pey2: list[float] = per_wheel(unit="1", about="its change with load")
    pky1: list[float] = per_wheel(
        15.0, unit="1", about="largest cornering stiffness over nominal load"
    )
    pky2: list[float] = per_wheel(
        2.0, unit="1", about="load of the largest cornering stiffness over nominal load"
    )
    pky4: list[float] = per_wheel(
        2.0, unit="1", about="curvature of the cornering stiffness over load"
    )
    rbx1: list[float] = per_wheel(
        unit="1", about="slope of the weight of side slip on the longitudinal force"
    )
    rbx2: list[float] = per_wheel(unit="1", about="its change with slip ratio")
    rcx1: list[float] = per_wheel(unit="1", about="shape factor of that weight")
    rex1: list[float] = per_wheel(unit="1", about="curvature of that weight at nominal load")
    rex2: list[float] = per_wheel(unit="1", about="its change with load")
    rby1: list[float] = per_wheel(
        unit="1", about="slope of the weight of the slip ratio on the side force"
    )
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


def mf_tyres(front: Sequence[float], rear: Sequence[float]) -> MfTyres:
    """The tyres of a car from the numbers of the tyres of each axle.

    An axle without numbers has those of the record.
    """
    if not front:
        return MfTyres()
    return MfTyres(*([f, f, r, r] for f, r in zip(front, rear, strict=True)))


def refuse_mf_tyre(axle: str, numbers: Sequence[float]) -> None:
    """Refuse numbers of an axle's tyre that are not those of MfTyres or give no friction."""
    if len(numbers) != len(MF_NAMES):
        raise ParameterError(
            f"curve mf_tyre needs {axle}_file, or {axle}_mf with {len(MF_NAMES)} elements, not "
            f"{len(numbers)}"
        )
    for name in ("fnomin", "pcx1", "pdx1", "pkx1", "pcy1", "pdy1", "pky1", "pky2"):
        value = numbers[MF_NAMES.index(name)]
        if value <= 0.0:
            raise ParameterError(
                f"{name.upper()} of the {axle} tyres is {value:g}, expected above 0"
            )
    for name, (low, high) in _LIMITS.items():
        value = numbers[MF_NAMES.index(name)]
        if not low <= value <= high:
            raise ParameterError(
                f"{name.upper()} of the {axle} tyres is {value:g}, expected {low:g} to {high:g}"
            )


@dataclass(frozen=True, slots=True)
class Tyre:
    """Friction curve, combined slip and carcass of the tyres.

    All four are alike, but for curves in OF_LOAD, axle by axle. The carcass values are assumptions:
    no source gives them, and a passenger-car tyre has about these (relaxation lengths of 0.2 to
    0.4 m). Steady driving does not depend on them.
    """

    curve: str = own(
        "burckhardt",
        choices=tuple(POSITIVE_COEFFICIENTS),
        about="friction curve over slip; with load dependence, tyres front and rear from tyre "
        "property files: mf_tyre by the Magic Formula, tmeasy by TMeasy",
    )
    coefficients: tuple[float, ...] = setting(
        (0.0, 0.0, 0.0, 0.0),
        unit="1",
        low=-50.0,
        high=1000.0,
        about="coefficients on dry asphalt, in the order of the curve (rational: peak, peak slip; "
        "two_exponential: "
        "mu_s, S0, S1; magic_formula: B, C, D, E; linear: slope; dry_friction: mu_A, v_A, "
        "mu_S, v_S [m/s]); burckhardt takes those of the surface",
    )
    combined: str = setting(
        "slip_vector",
        choices=("slip_vector", "uncoupled", "weighted", "normalized"),
        about="slip_vector: one curve over the resulting slip; uncoupled: each direction on its "
        "own; weighted: by the weighting functions of mf_tyre, which needs it; normalized: by the "
        "normalized slips of tmeasy, which needs it",
    )
    lateral_curve: str = parameter(
        "same",
        choices=("same", "linear", "constant_stiffness"),
        about="lateral curve. same: that of the friction; linear: F_y = -C alpha N/N_static, which "
        "follows the load; "
        "constant_stiffness: F_y = -C alpha, whatever the load. Both lines need `uncoupled` and "
        "know no friction limit",
        source="constant_stiffness: Ge & Ni 2005",
    )
    lateral_ratio: float = setting(
        1.0,
        unit="1",
        low=0.1,
        high=10.0,
        about="lateral over longitudinal slip stiffness of the curve",
    )
    front_cornering_stiffness: float = setting(
        60000.0,
        unit="N/rad",
        low=0.0,
        high=1e6,
        about="of each front tyre at its static load, of a lateral line",
    )
    rear_cornering_stiffness: float = setting(
        60000.0,
        unit="N/rad",
        low=0.0,
        high=1e6,
        about="of each rear tyre at its static load, of a lateral line",
    )
    load_sensitivity: float = setting(
        0.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="degressive load: friction and slip stiffness over load fall by this share for each "
        "`nominal_load` more; mf_tyre and tmeasy have their own",
    )
    nominal_load: float = setting(
        4000.0,
        unit="N",
        low=100.0,
        high=1e5,
        about="load of a tyre at which `load_sensitivity` changes nothing",
    )
    front_file: str = setting(
        "", about="tyre property file (.tir) of the front tyres; empty for none"
    )
    rear_file: str = setting(
        "", about="tyre property file (.tir) of the rear tyres; empty for none"
    )
    front_mf: tuple[float, ...] = setting(
        (),
        unit="1",
        low=-1e6,
        high=1e6,
        about="coefficients of the front tyres of mf_tyre, in the order of `MfTyres`",
    )
    rear_mf: tuple[float, ...] = setting(
        (),
        unit="1",
        low=-1e6,
        high=1e6,
        about="coefficients of the rear tyres of mf_tyre, in the order of `MfTyres`",
    )
    front_tmeasy: tuple[float, ...] = setting(
        (),
        unit="1",
        low=0.0,
        high=1e7,
        about="numbers of the front tyres of tmeasy, in the order of `TMEASY_NAMES`",
    )
    rear_tmeasy: tuple[float, ...] = setting(
        (),
        unit="1",
        low=0.0,
        high=1e7,
        about="numbers of the rear tyres of tmeasy, in the order of `TMEASY_NAMES`",
    )
    estimated_from: str = setting(
        "",
        about="size and load index, such as 205/55R16 91V, from which rules of thumb give the "
        "tyres of tmeasy where none are measured; empty for none",
    )
    longitudinal_stiffness: float = setting(
        350e3,
        unit="N/m",
        low=1e4,
        high=1e7,
        about="carcass stiffness between rim and contact patch, along the wheel",
    )
    lateral_stiffness: float = setting(
        200e3,
        unit="N/m",
        low=1e4,
        high=1e7,
        about="carcass stiffness between rim and contact patch, across the wheel",
    )
    longitudinal_damping_time: float = setting(
        0.01, unit="s", low=1e-3, high=0.1, about="carcass damping over stiffness, along the wheel"
    )
    lateral_damping_time: float = setting(
        0.02, unit="s", low=1e-3, high=0.1, about="carcass damping over stiffness, across the wheel"
    )
    contact_length: float = setting(
        0.05,
        unit="m",
        low=0.01,
        high=1.0,
        about="rolled distance in which the slip of the contact patch settles, about half of its "
        "length",
    )
    radius_over_load: float = setting(
        0.0,
        unit="m/N",
        low=0.0,
        high=1e-5,
        about="by how much the rolling radius shrinks for each newton above the static load: "
        "(1 - lambda) over the vertical stiffness, with lambda about 2/3 in r_D = lambda r_0 + "
        "(1 - lambda) r_S (Rill, Road Vehicle Dynamics, 2012, chapter 3)",
    )

    def __post_init__(self) -> None:
        if len(self.coefficients) != 4:
            raise ParameterError(
                "coefficients needs four elements (those that the curve does not have are zero)"
            )
        needed = POSITIVE_COEFFICIENTS[self.curve]
        if min(self.coefficients[:needed], default=1.0) <= 0.0:
            raise ParameterError(
                f"coefficients {list(self.coefficients)} give no friction: curve {self.curve} "
                "needs the first "
                f"{needed} positive"
            )
        for curve, combined in OF_LOAD.items():
            if (self.combined == combined) != (self.curve == curve):
                raise ParameterError(
                    f"combined is {self.combined} with curve {self.curve}: {curve} and {combined} "
                    "go together"
                )
        if self.curve == "dry_friction" and (
            self.combined != "slip_vector" or self.coefficients[3] <= self.coefficients[1]
        ):
            raise ParameterError("curve dry_friction needs combined slip_vector, and v_S above v_A")
        if self.curve in OF_LOAD:
            self._check_of_load()
        elif self.estimated_from:
            raise ParameterError(f"estimated_from needs curve tmeasy, not {self.curve}")
        if self.lateral_curve != "same" and self.combined != "uncoupled":
            raise ParameterError(
                f"lateral_curve {self.lateral_curve} needs combined uncoupled: a line has no share "
                "of a slip vector"
            )

    def _check_of_load(self) -> None:
        for given, needed in ((self.lateral_ratio, 1.0), (self.load_sensitivity, 0.0)):
            if given != needed:
                raise ParameterError(
                    f"curve {self.curve} needs lateral_ratio 1 and load_sensitivity 0: it has its "
                    "own"
                )
        files = [self.front_file, self.rear_file]
        if self.estimated_from:
            tyre_size(self.estimated_from)
            if self.curve == "mf_tyre" or any((*files, self.front_tmeasy, self.rear_tmeasy)):
                raise ParameterError(
                    "estimated_from needs curve tmeasy, and neither files nor numbers of its tyres"
                )
            return
        for axle, file in zip(("front", "rear"), files, strict=True):
            if not file:
                refuse = refuse_mf_tyre if self.curve == "mf_tyre" else refuse_tmeasy
                refuse(axle, self.numbers(axle))

    def numbers(self, axle: str) -> tuple[float, ...]:
        """The numbers of the tyres of an axle, of a curve in OF_LOAD."""
        if self.estimated_from:
            return estimated_tmeasy(self.estimated_from)
        of = "mf" if self.curve == "mf_tyre" else self.curve
        found: tuple[float, ...] = getattr(self, f"{axle}_{of}")
        return found
