"""The tyres of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import ParameterError, parameter
from ev_msgs_py.vehicle.mf_tyre import refuse_mf_tyre

# How many of the coefficients of a curve give no friction unless they are positive.
POSITIVE_COEFFICIENTS = {
    "burckhardt": 0,
    "rational": 2,
    "two_exponential": 3,
    "magic_formula": 3,
    "linear": 1,
    "mf_tyre": 0,
}


@dataclass(frozen=True, slots=True)
class Tyre:
    """Friction curve, combined slip and carcass of the tyres; all four are alike, but for `mf_tyre`, axle by axle.

    The carcass values are assumptions: no source gives them, and a passenger-car tyre has about these (relaxation
    lengths of 0.2 to 0.4 m). Steady driving does not depend on them.
    """

    curve: str = parameter(
        "burckhardt",
        choices=tuple(POSITIVE_COEFFICIENTS),
        about="friction curve over slip; mf_tyre: tyres front and rear by the Magic Formula with load dependence, from "
        "tyre property files",
        own=True,
    )
    coefficients: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0, 0.0),
        unit="1",
        low=-50.0,
        high=1000.0,
        about="coefficients on dry asphalt, in the order of the curve (rational: peak, peak slip; two_exponential: "
        "mu_s, S0, S1; magic_formula: B, C, D, E; linear: slope); burckhardt takes those of the surface",
    )
    combined: str = parameter(
        "slip_vector",
        choices=("slip_vector", "uncoupled", "weighted"),
        about="slip_vector: one curve over the resulting slip; uncoupled: each direction on its own; weighted: by the "
        "weighting functions of mf_tyre, which needs it",
    )
    lateral_curve: str = parameter(
        "same",
        choices=("same", "linear", "constant_stiffness"),
        about="lateral curve. same: that of the friction; linear: F_y = -C alpha N/N_static, which follows the load; "
        "constant_stiffness: F_y = -C alpha, whatever the load. Both lines need `uncoupled` and know no friction limit",
        source="constant_stiffness: Ge & Ni 2005",
    )
    lateral_ratio: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="lateral over longitudinal slip stiffness of the curve"
    )
    front_cornering_stiffness: float = parameter(
        60000.0, unit="N/rad", low=0.0, high=1e6, about="of each front tyre at its static load, of a lateral line"
    )
    rear_cornering_stiffness: float = parameter(
        60000.0, unit="N/rad", low=0.0, high=1e6, about="of each rear tyre at its static load, of a lateral line"
    )
    load_sensitivity: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="degressive load: friction and slip stiffness over load fall by this share for each `nominal_load` more; "
        "mf_tyre has its own",
    )
    nominal_load: float = parameter(
        4000.0, unit="N", low=100.0, high=1e5, about="load of a tyre at which `load_sensitivity` changes nothing"
    )
    front_file: str = parameter("", about="tyre property file (.tir) of the front tyres; empty for none")
    rear_file: str = parameter("", about="tyre property file (.tir) of the rear tyres; empty for none")
    front_mf: tuple[float, ...] = parameter(
        (), unit="1", low=-1e6, high=1e6, about="coefficients of the front tyres of mf_tyre, in the order of `MfTyres`"
    )
    rear_mf: tuple[float, ...] = parameter(
        (), unit="1", low=-1e6, high=1e6, about="coefficients of the rear tyres of mf_tyre, in the order of `MfTyres`"
    )
    longitudinal_stiffness: float = parameter(
        350e3, unit="N/m", low=1e4, high=1e7, about="carcass stiffness between rim and contact patch, along the wheel"
    )
    lateral_stiffness: float = parameter(
        200e3, unit="N/m", low=1e4, high=1e7, about="carcass stiffness between rim and contact patch, across the wheel"
    )
    longitudinal_damping_time: float = parameter(
        0.01, unit="s", low=1e-3, high=0.1, about="carcass damping over stiffness, along the wheel"
    )
    lateral_damping_time: float = parameter(
        0.02, unit="s", low=1e-3, high=0.1, about="carcass damping over stiffness, across the wheel"
    )
    contact_length: float = parameter(
        0.05,
        unit="m",
        low=0.01,
        high=1.0,
        about="rolled distance in which the slip of the contact patch settles, about half of its length",
    )

    def __post_init__(self) -> None:
        if len(self.coefficients) != 4:
            raise ParameterError("coefficients needs four elements (those that the curve does not have are zero)")
        needed = POSITIVE_COEFFICIENTS[self.curve]
        if min(self.coefficients[:needed], default=1.0) <= 0.0:
            raise ParameterError(
                f"coefficients {list(self.coefficients)} give no friction: curve {self.curve} needs the first "
                f"{needed} positive"
            )
        if (self.combined == "weighted") != (self.curve == "mf_tyre"):
            raise ParameterError(
                f"combined is {self.combined} with curve {self.curve}: mf_tyre and weighted go together"
            )
        if self.curve == "mf_tyre":
            for given, allowed in ((self.lateral_ratio, 1.0), (self.load_sensitivity, 0.0)):
                if given != allowed:
                    raise ParameterError("curve mf_tyre needs lateral_ratio 1 and load_sensitivity 0: it has its own")
            for axle, file, numbers in (
                ("front", self.front_file, self.front_mf),
                ("rear", self.rear_file, self.rear_mf),
            ):
                if not file:
                    refuse_mf_tyre(axle, numbers)
        if self.lateral_curve != "same" and self.combined != "uncoupled":
            raise ParameterError(
                f"lateral_curve {self.lateral_curve} needs combined uncoupled: a line has no share of a slip vector"
            )
