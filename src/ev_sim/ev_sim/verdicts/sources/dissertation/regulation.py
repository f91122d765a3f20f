"""The traction control of the dissertation, eqs 2.34 to 2.36 and figure 2.8."""

from __future__ import annotations

import math

from ev_sim.report.quantities.slip_curve import LARGEST_ERROR, SlipCurve, first_passed_peak, slip_and_road_torque
from ev_sim.report.samples import run_named
from ev_sim.verdicts.check import Comparison, Number, holds, smaller
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns, StudyCases, StudyNeed
from ev_sim.verdicts.sources.dissertation.runs import PART
from ev_sim.verdicts.tolerance import absolute, relative

LAUNCHES = StudyNeed(
    "asr_shootout", ("--controls", "off", "least_squares_literal", "--roads", "snow", "wet"), slow=False
)
_FIT = (
    "Y is the road torque M - J w' instead of the motor's, over windows of 0.125 s in which the slip only rises (n and "
    "the sample time are not printed)"
)


def _fit(driven: ScenarioRuns) -> SlipCurve:
    """The fit where the left wheel first passes its peak."""
    return first_passed_peak(run_named(driven.runs, "urban_mixed"), driven.vehicle, "front_left")


def _beyond_the_zero_of_the_slope(driven: ScenarioRuns) -> float:
    """Distance of (B/(2 A))^2 from where A + B/(2 sqrt(x)) changes its sign, found by halving [1]."""
    curve = _fit(driven)
    if not curve.a < 0.0 < curve.b:
        return math.inf
    low, high = 1e-12, 1.0
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if curve.a + curve.b / (2 * math.sqrt(middle)) > 0.0 else (low, middle)
    return abs(curve.peak - low)


def _rises_then_falls(driven: ScenarioRuns) -> bool:
    """Whether the fitted curve rises to its peak, and the samples go beyond it, where it falls."""
    run, curve = run_named(driven.runs, "urban_mixed"), _fit(driven)
    x = slip_and_road_torque(run, driven.vehicle, "front_left")[0][curve.window]
    at = curve.at
    return bool(x[0] < curve.peak < x[-1] and at(x[0]) < at(curve.peak) > at(x[-1]))


def _mean_slip(driven: StudyCases, road: str, control: str) -> float:
    return float(driven.results[f"{road}: {control}"].measured["mean_slip"])


def _holds_the_wheel(road: str) -> Comparison:
    return smaller(
        "1",
        lambda driven: _mean_slip(driven, road, "least_squares_literal"),
        lambda driven: _mean_slip(driven, road, "off"),
        0.05,
        "a wheel that is held at its limit slips less; by 5 % it does for noise alone",
        f"mean slip on {road} against none",
    )


DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.asr.F",
        (),
        Number("1", 0.001, relative(0.0, "exact"), lambda: LARGEST_ERROR),
        inputs="the fit of figure 2.8 has it as a constant; it hangs on n and M_nom; of the ASR largest_error, off by "
        "default",
    ),
    judged(
        "diss.asr.peak",
        PART,
        Number("1", 0.0, absolute(1e-9, "algebra"), _beyond_the_zero_of_the_slope),
        assumption=_FIT,
    ),
    judged("diss.asr.literal", LAUNCHES, _holds_the_wheel("snow"), _holds_the_wheel("wet")),
    judged("diss.fig2.8", PART, holds(_rises_then_falls, "shape; the curve is lost"), assumption=_FIT),
)
