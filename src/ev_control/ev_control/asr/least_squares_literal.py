"""The least-squares traction control exactly as the dissertation prints it (eqs 2.34 to 2.36, steps 1 to 5)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ev_control.asr.slip_curve_fit import SlipCurveFit
from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.reference_speed import ReferenceSpeedParameters
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class LeastSquaresLiteralParameters:
    """The length of the window, which the source leaves open."""

    samples: int = parameter(
        25, unit="1", low=2, high=1000, about="samples in the window of the fit, n", source="assumption"
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class LeastSquaresLiteralWheel(LimitedWheel):
    """Samples, and the torque of the previous step [N m]."""

    fit: SlipCurveFit = field(default_factory=SlipCurveFit)
    previous: float = 0.0


@method("asr", "least_squares_literal")
class LeastSquaresLiteral(TractionControl):
    """Hold the torque of the previous step while the fitted curve falls; this keeps a spinning wheel spinning.

    X = 1 - w_free/w, Y = M/M_nom, y = A x + B sqrt(x) over the window, dy/dx < 0 at the present X: the previous torque
    is the limit of this step (dissertation, eqs 2.34 to 2.36). For comparison only, because it does next to nothing:
    the torque that it holds is the one that spins the wheel, so it ends the rise of the torque but never takes any
    back. And Y is the law's own command: a driver who asks for a constant torque makes a curve that says nothing of
    the road. What the source does not define is left out: a sample at rest (0/0), with X < 0 (its root), or a
    window whose equations have no single solution.
    """

    parameters = LeastSquaresLiteralParameters

    def __init__(self, parameters: LeastSquaresLiteralParameters, vehicle: Vehicle, period: float) -> None:
        self._samples = parameters.samples
        self._nominal = vehicle.motor.nominal_torque * vehicle.gear_ratio
        super().__init__("least_squares_literal", self._new, parameters.reference, vehicle, period)

    def _new(self) -> LeastSquaresLiteralWheel:
        return LeastSquaresLiteralWheel(fit=SlipCurveFit(self._samples, 0.0))

    def _limit(self, wheel: LeastSquaresLiteralWheel, motion: WheelMotion, wanted: float) -> float:
        """The previous torque [N m] while the curve falls, else none."""
        slip = 1 - motion.rolling / motion.speed if motion.speed != 0.0 else -1.0
        limit = math.inf
        if 0.0 < slip <= 1.0:
            wheel.fit.add(slip, motion.torque / self._nominal)
            found = wheel.fit.coefficients() if wheel.fit.is_full else None
            if found is not None and found[0] + found[1] / (2 * math.sqrt(slip)) < 0.0:
                limit = wheel.previous
        wheel.previous = min(wanted, limit)
        return limit
