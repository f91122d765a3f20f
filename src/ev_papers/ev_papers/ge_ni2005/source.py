"""Ge & Ni (2005), figs 3 and 4: slip targets for each rear wheel beside equal torques.

A run is called by its control (`equal_torque`, or the reading of the law) and by what differs from the source's run:
`_free_speed` where u is not held, `_full_car` where loads and lateral forces are those of a full car, `_switched` where
there is no boundary layer, `_lower_target` where the target slip is changed to one that is reached, `_estimated` where
the law estimates the speed, `_rear_steered` where the rear wheels turn, too.

Figure 3 is drawn with the law, in each reading of it, 4 with equal torques; 3 s with u held.

A source has its place ORDER, the functions MEASURES that measure the numbers of published.csv, and its PANELS.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.ge_ni2005 import measures, paper
from ev_papers.ge_ni2005.measures import BASELINE
from ev_papers.ge_ni2005.quantities import (
    OVER_TIME,
    QUANTITIES,
    SIDES,
    ground_speed,
    rim_speed,
    slip,
)
from ev_stack.figures.panels import Curve, Panel, degrees, level, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, Parameters, Runs, channel, metric, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.check import Check
from ev_study.verdicts.measure import Template, measures_of
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import PublishedPanel, scheme
from ev_study.verdicts.sources import Published, published
from ev_study.verdicts.verdict import metrics_at_hand

READINGS = ("rate", "offset", "increment")
FREE_SPEED, FULL_CAR = "_free_speed", "_full_car"
CASES = (
    "",
    FREE_SPEED,
    FULL_CAR,
    FULL_CAR + FREE_SPEED,
)  # what the names of runs end with: car and speed
# What the law is claimed to change against equal torques; on the speed of the car with u free, on all else with u held.
ORDERINGS = tuple(
    f"ge.claim.{name}"
    for name in ("beta", "radius", "centripetal", "yaw_rate", "v", "slip_use", "speed")
)
SWITCHED = "_switched"
LOWER_TARGET = (
    0.088  # of the runs *_lower_target: between the slips of both wheels with equal torques [1]
)
CHATTER_ALONE = (SWITCHED, "_lower_target")  # runs that differ from others in this only
CHATTERING = (
    "rate_lower_target",
    "offset_lower_target",
    "increment",
)  # runs that come to their target slip
SETTLED = (
    2.0,
    3.0,
)  # [s], where the steady turn with equal torques is drawn that follows from the printed equations
WIDEST_RADIUS = 200.0  # [m], beyond which fig. (b) shows nothing: the path begins straight


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Each quantity of figs 3 and 4 at 3 s in each run, and what the source is judged by, on both cars."""
    driven = ScenarioRuns(runs, vehicle, parameters)
    values = {
        f"{quantity}_{name}": metric(
            lambda n=name, m=measure: m(run_named(runs, n)),
            unit,
            OVER_TIME.get(quantity, f"at {paper.INSTANT:g} s"),
        )
        for name in runs
        for quantity, (unit, measure) in QUANTITIES.items()
        if quantity == "chatter" or not any(case in name for case in CHATTER_ALONE)
    }
    judged = metrics_at_hand("ge_ni2005", "ge_ni2005", driven)
    return values | judged | _elsewhere(driven) | _within_the_figures(driven)


def _elsewhere(driven: ScenarioRuns) -> dict[str, Metric]:
    """The orderings in the other cases of car and speed: u free, and the car whose forces follow the loads."""
    found: dict[str, Metric] = {}
    for id in ORDERINGS:
        of = published("ge_ni2005")[id]
        judged = FREE_SPEED if id == "ge.claim.speed" else ""
        for case in CASES:
            if case != judged and case.endswith(judged):
                runs = {run + judged: run + case for run in (BASELINE, *READINGS)}
                ending = (judged.replace("_", " "), case.replace("_", " "))
                checks = [
                    replace(
                        check.renamed(runs), name=check.name.removesuffix(ending[0]) + ending[1]
                    )
                    for check in of.checks
                ]
                found |= _metrics(of, checks, driven)
    return found


def _within_the_figures(driven: ScenarioRuns) -> dict[str, Metric]:
    """The chatter within the 3 s of the figures: at the printed target, and at a lower one of ours."""
    of = published("ge_ni2005")["ge.claim.chatter"]
    check, *_ = of.checks
    found = _metrics(
        replace(of, text=Template(("T = k sgn(D) read as increment",))), [check], driven
    )
    for reading in ("rate", "offset"):
        run = f"{reading}_lower_target"
        words = {
            "increment": run,
            f"increment{SWITCHED}": run + SWITCHED,
            paper.TARGET: LOWER_TARGET,
        }
        changed = f"T = k sgn(D) read as {reading}; target slip CHANGED from {paper.TARGET:g} to {LOWER_TARGET:g}"
        lower = replace(check.renamed(words), name=run)
        found |= _metrics(replace(of, text=Template((changed,))), [lower], driven)
    return found


def _metrics(of: Published, checks: Sequence[Check], driven: ScenarioRuns) -> dict[str, Metric]:
    """The numbers of an id on other runs than those that it is judged on, by id and run."""
    found = replace(of, checks=tuple(checks)).metrics(dict.fromkeys(of.needs, driven))
    return {f"{of.id}.{name.replace(' ', '_')}": metric for name, metric in found.items()}


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Figs 3 and 4 for both cars, with u held and free, and the torques with and without boundary layer."""
    torques = [
        panel(
            f"{readable(name)}: torque, rear {side}",
            "torque [N m]",
            lambda name=name, side=side: _curves(
                runs,
                (name, name + SWITCHED),
                lambda run: channel(run, f"torque_request.drive.rear_{side}"),
            ),
            scale=name,
        )
        for name in CHATTERING
        for side in SIDES
    ]
    return {
        **{f"fig3_fig4{case}": Sheet(_case(runs, vehicle, case)) for case in CASES},
        "boundary_layer": Sheet(torques),
    }


def panels(runs: Runs, vehicle: Vehicle, names: Sequence[str]) -> dict[str, list[Panel]]:
    """The panels of figs 3 and 4 by their letter, with a curve for each of the runs."""

    def of(
        title: str,
        ylabel: str,
        quantity: Callable[[Recording], np.ndarray],
        steady: float,
        scale: str = "",
    ) -> Panel:
        published = (
            [level(steady, *SETTLED, "published, equal torque")] if BASELINE in names else []
        )
        return panel(title, ylabel, lambda: [*_curves(runs, names, quantity), *published], scale)

    def radius(run: Recording) -> np.ndarray:
        values = motion.radius_of_path(run)
        return np.where(np.abs(values) < WIDEST_RADIUS, values, np.nan)

    def wheels(
        title: str,
        ylabel: str,
        quantity: Callable[[Recording, str], np.ndarray],
        steady: Sequence[float],
    ) -> list[Panel]:
        return [
            of(
                f"{title}, rear {side}",
                ylabel,
                lambda run, side=side: quantity(run, side),
                value,
                title,
            )
            for side, value in zip(SIDES, steady, strict=True)
        ]

    turn = paper.steady_turn()
    speeds, slips = paper.rear_speeds(), [paper.slip_of(load) for load in paper.rear_loads()]
    rims = [speed / (1 - each) for speed, each in zip(speeds, slips, strict=True)]

    return {
        "a": [
            of(
                "a  Sideslip angle",
                "angle [deg]",
                degrees(motion.sideslip_angle),
                np.degrees(turn.sideslip),
            )
        ],
        "b": [of("b  Radius of the path", "radius [m]", radius, turn.radius)],
        "c": [
            of(
                "c  Centripetal acceleration",
                "acceleration [m/s²]",
                motion.lateral_acceleration_on_path,
                turn.centripetal_acceleration,
            )
        ],
        "d": [
            of(
                "d  Yaw rate",
                "yaw rate [deg/s]",
                degrees(lambda run: channel(run, motion.YAW_RATE)),
                np.degrees(turn.yaw_rate),
            ),
            of(
                "d  Lateral speed",
                "speed [m/s]",
                lambda run: channel(run, "twist.lateral"),
                turn.lateral_speed,
            ),
        ],
        "e": wheels("e  Slip", "slip [1]", slip, slips),
        "f": [
            *wheels(
                "f  Ground speed along the wheel",
                "speed [m/s]",
                lambda run, side: ground_speed(run, side, vehicle),
                speeds,
            ),
            *wheels(
                "f  Rim speed", "speed [m/s]", lambda run, side: rim_speed(run, side, vehicle), rims
            ),
        ],
    }


def _case(runs: Runs, vehicle: Vehicle, case: str) -> list[Panel]:
    """All panels of a case of car and speed, and the speed of the car where it is free, else what the laws ask for."""
    names = [name + case for name in (BASELINE, *READINGS)]
    by_letter = panels(runs, vehicle, names)

    def torque_difference(run: Recording) -> np.ndarray:
        return np.subtract(
            *(channel(run, f"torque_request.drive.rear_{side}") for side in ("right", "left"))
        )

    if FREE_SPEED in case:
        title, ylabel, quantity = (
            "Longitudinal speed",
            "speed [m/s]",
            lambda run: channel(run, "twist.longitudinal"),
        )
    else:
        title, ylabel, quantity = (
            "Torque requests, right minus left",
            "torque [N m]",
            torque_difference,
        )
    by_letter["c"].append(panel(title, ylabel, lambda: _curves(runs, names, quantity)))
    return [
        replace(each, title=f"{each.title}{',' * bool(case)}{readable(case)}")
        for panels_of_letter in by_letter.values()
        for each in panels_of_letter
    ]


def _curves(
    runs: Runs, names: Iterable[str], quantity: Callable[[Recording], np.ndarray]
) -> list[Curve]:
    """A curve of each run by its control: what else all of them have in common stands in the titles."""
    chosen = {
        name.replace(FULL_CAR, "").replace(FREE_SPEED, ""): run_named(runs, name) for name in names
    }
    return [Curve(run.time, quantity(run), readable(name)) for name, run in chosen.items()]


ORDER = 1  # among the sources, in tables
MEASURES = measures_of(measures)

_RUNS = {"3": READINGS, "4": (BASELINE,)}
_TITLES = {
    "a": "Sideslip angle",
    "b": "Radius of the path",
    "c": "Centripetal acceleration",
    "d": "Yaw rate w and lateral speed v",
    "e": "Slips of the driven wheels",
    "f": "Speeds of the driven wheels",
}
_ENDS = {"b": (0.0, 70.0), "c": (0.0, 0.6)}  # of the ordinate, which the scan has kept
_IDS = {
    "4b": ("ge.fig4b.axis", "ge.eq.radius"),
    "4c": ("ge.fig4c.axis", "ge.eq.centripetal"),
    "3f": ("ge.fig3f_4f",),
    "4f": ("ge.fig3f_4f", "ge.eq.speeds"),
}


def _panel(figure: str, letter: str) -> PublishedPanel:
    def draw(driven: ScenarioRuns) -> Sheet:
        shown = panels(driven.runs, driven.vehicle, _RUNS[figure])[letter]
        ends = _ENDS.get(letter, (None, None))
        return Sheet([replace(each, ends=ends) for each in shown], columns=1)

    needs = (ScenarioNeed("ge_ni2005", runs=(BASELINE, *READINGS)),)
    ids = _IDS.get(figure + letter, (f"ge.fig{figure}{letter}",))
    return PublishedPanel(figure, letter, _TITLES[letter], ids, needs, draw)


PANELS = (
    scheme("1", "the model", "ge.fig1"),
    scheme("2", "the law", "ge.fig2"),
    *(_panel(figure, letter) for letter in _TITLES for figure in _RUNS),
)
