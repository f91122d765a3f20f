"""Zhileykin (2018), Figs 3 to 5: rear drive and the 4x4 into a bend on ice, one run and the sweep of what is not given.

The source has one run whose drive force and steering angle it does not give. So each claim is judged on the run of the
scenario and, since a single run proves nothing, on the cases of the sweep: it has to hold in most of them. The law is
that with the factor K = 1 of its proportionalities; what other factors, and no law at all, do stands beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_papers.zhileykin2018 import grid as grid
from ev_papers.zhileykin2018.grid import FIXED, REAR_DRIVE
from ev_papers.zhileykin2018.paper import BEND, CALM, LIMIT, NOMINAL, STEERING, SWING
from ev_papers.zhileykin2018.quantities import SHARES, deviation_from_circle, turn_arounds
from ev_sim.measures import motion
from ev_sim.measures.handling import peak_sideslip
from ev_sim.measures.motion import ROAD_WHEEL_ANGLE, moving
from ev_sim.measures.samples import channel, run_named
from ev_sim.verdicts.check import Number, Shown, between, holds
from ev_sim.verdicts.declaration import Declaration, judged, no_verdict, not_judgeable
from ev_sim.verdicts.need import ScenarioRuns, StudyCases, StudyNeed

SWEEP = StudyNeed("zhileykin2018_sweep")
NEEDS = (BEND, SWEEP)
_CAR = "drive force, steering angle, car but for its mass, slopes of the tyre curve"
_THRESHOLD = "the source gives no threshold; 15 deg are assumed"
_MOST = between(0.5, 1.0, "force and angle of the source are unknown: most of the cases")


def _peak(name: str) -> Callable[..., float]:
    return lambda runs, sweep: peak_sideslip(run_named(runs.runs, name))


def _off_the_circle(name: str) -> Callable[..., float]:
    return lambda runs, sweep: deviation_from_circle(run_named(runs.runs, name), STEERING[1])


def _rear_slides_out(runs: ScenarioRuns, sweep: StudyCases) -> bool:
    """Whether the rear axle has the larger slip angle where rear drive passes the limit: it, not the front, slides."""
    run, vehicle = run_named(runs.runs, REAR_DRIVE), runs.vehicle
    n = motion.first(moving(run) & (np.abs(motion.sideslip_angle(run)) >= LIMIT), "a sideslip angle of 15 deg")
    u, v, r, delta = (
        channel(run, name)[n] for name in ("twist.longitudinal", "twist.lateral", "twist.yaw_rate", ROAD_WHEEL_ANGLE)
    )
    rear_arm = vehicle.centre_of_mass_to_rear_axle
    front = delta - math.atan2(v + (vehicle.wheelbase - rear_arm) * r, u)
    rear = -math.atan2(v - rear_arm * r, u)
    return bool(abs(rear) > abs(front))


def _spins(runs: ScenarioRuns, sweep: StudyCases) -> float:
    return float(grid.spins(sweep.results).mean())


def _held(sweep: StudyCases, control: str) -> int:
    """In how many of the cases in which rear drive spins a control holds."""
    return int((grid.holds(sweep.results, control) & grid.spins(sweep.results)).sum())


def _holds(runs: ScenarioRuns, sweep: StudyCases) -> float:
    return _held(sweep, NOMINAL) / max(int(grid.spins(sweep.results).sum()), 1)


def _of_rear_drive(runs: ScenarioRuns, sweep: StudyCases) -> str:
    return f"{_CAR} (rear drive spins in {grid.spins(sweep.results).sum()} of {grid.SIZE} cases)"


def _of_law(runs: ScenarioRuns, sweep: StudyCases) -> str:
    held = {name: _held(sweep, name) for name in grid.CONTROLS}
    return (
        f"{_CAR}; K = 1, which holds {held['k1']} of the {grid.spins(sweep.results).sum()} cases in which rear drive "
        f"spins (K = 0.5: {held['k05']}, eq 4 as an equality: {held['equality']}, no law but a fixed half for each "
        f"axle: {held[FIXED]})"
    )


def _calm(share: str) -> Callable[..., float]:
    return lambda runs, sweep: float(grid.is_calm(sweep.results, NOMINAL, share).mean())


def _turn_arounds(share: str) -> Callable[..., float]:
    return lambda runs, sweep: turn_arounds(SHARES[share](run_named(runs.runs, NOMINAL)), SWING)


def _of_share(share: str) -> Callable[..., str]:
    def text(runs: ScenarioRuns, sweep: StudyCases) -> str:
        calm = {name: int(grid.is_calm(sweep.results, name, share).sum()) for name in grid.BY_LAW}
        return (
            f"{_CAR}; K = 1, calm in {calm['k1']} of {grid.SIZE} cases (K = 0.5: {calm['k05']}, eq 4 as an equality: "
            f"{calm['equality']})"
        )

    return text


def _without_oscillation(id: str, share: str) -> Declaration:
    return judged(
        id,
        NEEDS,
        Number("1", 0.0, between(0.0, CALM, "a turn-around is that of entering the bend"), _turn_arounds(share)),
        Number("1", 1.0, _MOST, _calm(share), "share of calm cases"),
        assumption=_of_share(share),
    )


def _more_than_rear_drive(runs: ScenarioRuns, sweep: StudyCases) -> float:
    return float(grid.holds(sweep.results, NOMINAL).sum() - grid.holds(sweep.results, REAR_DRIVE).sum())


DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "zhil.fig3",
        NEEDS,
        Number("rad", LIMIT, between(LIMIT, math.inf, _THRESHOLD), _peak(REAR_DRIVE)),
        holds(_rear_slides_out, "a comparison of two angles far apart", "rear axle slides more"),
        Number("1", 1.0, _MOST, _spins, "share of cases"),
        assumption=_of_rear_drive,
    ),
    judged(
        "zhil.fig4",
        NEEDS,
        Number("rad", LIMIT, between(0.0, LIMIT, _THRESHOLD), _peak(NOMINAL)),
        Number("1", 1.0, _MOST, _holds, "share of the cases in which rear drive spins"),
        Shown("m", _off_the_circle(NOMINAL), "from a circle, largest, steering held"),
        Shown("m", _off_the_circle(REAR_DRIVE), "of rear drive"),
        assumption=_of_law,
    ),
    _without_oscillation("zhil.fig5a", "h_n"),
    _without_oscillation("zhil.fig5b", "h_2"),
    _without_oscillation("zhil.fig5c", "h_4"),
    not_judgeable("zhil.fig3_5.curves", "curves not in the text"),
    no_verdict("zhil.fig1", "a scheme"),
    no_verdict("zhil.fig2", "a scheme"),
    judged(
        "zhil.better",
        NEEDS,
        Number(
            "1",
            2.0,
            between(2.0, grid.SIZE, "one case is the choice of the grid"),
            _more_than_rear_drive,
            "cases held more",
        ),
        assumption=_of_law,
    ),
)
