"""The least-squares traction control exactly as the dissertation prints it (eqs 2.34 to 2.36, steps 1 to 5)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.slip_curve import SlipCurveParameters, fits, fitted_curve, slope
from ev_control.estimation.slip_curve_fit import SlipCurveFit, add_sample, is_full
from ev_control.law import LimitedWheel, LimpModeParameters, ReferenceSpeedParameters, WheelMotion, traction_control
from ev_core.law import Car, compilable, entry, group, parameter, part


@dataclass(frozen=True, slots=True)
class LeastSquaresLiteralParameters(SlipCurveParameters):
    """The length of the window, which the source leaves open."""

    samples: int = parameter(25, unit="1", low=2, high=1000, about="samples in the window of the fit, n")
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class LeastSquaresLiteralWheel(LimitedWheel):
    """What the law knows of a wheel."""

    fit: SlipCurveFit = part(SlipCurveFit)
    previous: float = entry(unit="N m", about="torque of the previous step")


@traction_control("least_squares_literal", LeastSquaresLiteralParameters, LeastSquaresLiteralWheel)
@compilable
def least_squares_literal(
    p: LeastSquaresLiteralParameters,
    car: Car,
    w: LeastSquaresLiteralWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Hold the torque of the previous step while the fitted curve falls; this keeps a spinning wheel spinning.

    X = 1 - w_free/w, Y = M/M_nom, y = A x + B sqrt(x) over the window, dy/dx < 0 at the present X: the previous torque
    is the limit of this step (dissertation, eqs 2.34 to 2.36). For comparison only, because it does next to nothing:
    the torque that it holds is the one that spins the wheel, so it ends the rise of the torque but never takes any
    back. And Y is the law's own command: a driver who asks for a constant torque makes a curve that says nothing of
    the road. What the source does not define is left out: a sample at rest (0/0), with X < 0 (its root), or a
    window whose equations have no single solution.
    """
    slip = 1.0 - motion.rolling / motion.speed if motion.speed != 0.0 else -1.0
    held = inf
    if 0.0 < slip <= 1.0:
        torque = motion.torque / (car.motor.nominal_torque * car.gear_ratio)
        add_sample(w.fit, p.samples, 0.0, slip, torque, p.template)
        curve = fitted_curve(w.fit)
        if is_full(w.fit) and fits(p, w.fit, curve) and slope(w.fit, curve, slip) < 0.0:
            held = w.previous
    w.previous = min(wanted, held)
    return held
