"""The traction control of the dissertation, eqs 2.34 to 2.36 and figure 2.8."""

from __future__ import annotations

import math

from ev_papers.dissertation.measures.slip_curve import LARGEST_ERROR, SlipCurve, first_passed_peak, slip_and_road_torque
from ev_papers.dissertation.runs import PART
from ev_sim.measures.samples import run_named
from ev_sim.verdicts.check import Comparison, Number, absolute, holds, relative, smaller
from ev_sim.verdicts.declaration import Declaration, judged, no_verdict, not_judgeable
from ev_sim.verdicts.need import ScenarioRuns, StudyCases, StudyNeed
from ev_sim.verdicts.sources import published

_DRAWN = (
    "curve not in the text; scripts/run.sh figures draws it for each method, with driver pulse, and those of chapter 5 "
    "on the bench"
)
_REASONS = {
    "diss.fig1.13": "maker's curves are not in the text",
    "diss.fig1.22": "maker's curves, voltages and efficiencies are not in the text; losses and winding are assumed",
    "diss.fig2.9": "no data in the text; any speed profile from CSV can be driven",
    "diss.fig2.10": "no data in the text; config/cycles/nycc.csv is the public cycle of this name",
    "diss.fig2.11": "no data in the text; any speed profile from CSV can be driven",
    "diss.fig2.13": "seed and lengths of the segments are not given; drawn for seed 1",
}
_SCHEMES = ("diss.fig1.1", "diss.fig2.", "diss.fig4.")  # block diagrams, schemes, photographs, screens


def _judged_elsewhere(id: str) -> bool:
    return published("dissertation")[id].kind != "lost" or id == "diss.bench.timing"


def _declared(id: str) -> Declaration:
    if id in _REASONS:
        return not_judgeable(id, _REASONS[id])
    if id.startswith(_SCHEMES):
        return no_verdict(id, "a scheme, a photograph or a screen, of which the text has the equations and data")
    is_efficiency = "efficiency" in published("dissertation")[id].quantity
    return not_judgeable(id, _DRAWN + ("; it ends at eq 2.37 or 2.38 of the road with seed 1" if is_efficiency else ""))


_FIGURES_DECLARATIONS: tuple[Declaration, ...] = tuple(
    _declared(id) for id in published("dissertation") if not _judged_elsewhere(id)
)


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


_REGULATION_DECLARATIONS: tuple[Declaration, ...] = (
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


DECLARATIONS = (*_FIGURES_DECLARATIONS, *_REGULATION_DECLARATIONS)
