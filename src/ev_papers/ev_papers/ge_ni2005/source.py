"""Ge & Ni (2005), figs 3 and 4: slip targets for each rear wheel beside equal torques.

A run is called by its control (`equal_torque`, or the reading of the law) and by what differs from
the source's run: `_free_speed` where u is not held, `_full_car` where loads and lateral forces are
those of a full car, `_switched` where there is no boundary layer, `_lower_target` where the target
slip is changed to one that is reached, `_estimated` where the law estimates the speed,
`_rear_steered` where the rear wheels turn, too.

Figure 3 is drawn with the law, in each reading of it, 4 with equal torques; 3 s with u held.

A source has its place ORDER, its PANELS, and in MEASURES the functions that published.csv names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.ge_ni2005 import measures, paper
from ev_papers.ge_ni2005.measures import BASELINE
from ev_papers.ge_ni2005.quantities import QUANTITIES, SIDES, ground_speed, rim_speed, slip
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

ORDER = 1  # among the sources, in tables
MEASURES = measures_of(measures)
SOURCE = "ge_ni2005"
READINGS = ("rate", "offset", "increment")
# Ends of the names of runs: a car with forces that follow the loads, a speed that is not held.
FULL_CAR = "_full_car"
FREE_SPEED = "_free_speed"
CASES = ("", FREE_SPEED, FULL_CAR, FULL_CAR + FREE_SPEED)
SWITCHED = "_switched"
LOWERED = "_lower_target"
CHATTER_ALONE = (SWITCHED, LOWERED)  # runs in which nothing else is of interest
CHATTERING = ("rate_lower_target", "offset_lower_target", "increment")  # they come to their target
# Claims of a change against equal torques, judged on the source's own car with u held.
SPEED = "ge.claim.speed"
ORDERINGS = (
    "ge.claim.beta",
    "ge.claim.radius",
    "ge.claim.centripetal",
    "ge.claim.yaw_rate",
    "ge.claim.v",
    "ge.claim.slip_use",
    SPEED,
)
LOWER_TARGET = 0.088  # of the runs *_lower_target: between both slips with equal torques [1]
SETTLED = (2.0, 3.0)  # [s], where the steady turn of the printed equations is drawn
WIDEST_RADIUS = 200.0  # [m], beyond which fig. (b) shows nothing: the path begins straight
_RUNS = {"3": READINGS, "4": (BASELINE,)}  # by figure
_TITLES = {  # by panel
    "a": "Sideslip angle",
    "b": "Radius of the path",
    "c": "Centripetal acceleration",
    "d": "Yaw rate w and lateral speed v",
    "e": "Slips of the driven wheels",
    "f": "Speeds of the driven wheels",
}
_ENDS = {"b": (0.0, 70.0), "c": (0.0, 0.6)}  # of the ordinate, which the scan has kept
_IDS = {  # by figure and panel, where they are not those of the curve alone
    "4b": ("ge.fig4b.axis", "ge.eq.radius"),
    "4c": ("ge.fig4c.axis", "ge.eq.centripetal"),
    "3f": ("ge.fig3f_4f",),
    "4f": ("ge.fig3f_4f", "ge.eq.speeds"),
}

Series = Callable[[Recording], np.ndarray]  # (n,) of a run


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Each quantity of figs 3 and 4 at 3 s in each run, and the judged numbers on both cars."""
    found = {}
    for name in runs:
        for quantity, of in QUANTITIES.items():
            if quantity == "chatter" or not any(end in name for end in CHATTER_ALONE):
                found[f"{quantity}_{name}"] = metric(
                    lambda name=name, of=of: of.of(run_named(runs, name)), of.unit, of.formula
                )
    driven = ScenarioRuns(runs, vehicle, parameters)
    found |= metrics_at_hand(SOURCE, SOURCE, driven)
    for id in ORDERINGS:
        found |= _in_other_cases(id, driven)
    return found | _chatter_within_the_figures(driven)


def _in_other_cases(id: str, driven: ScenarioRuns) -> dict[str, Metric]:
    """An ordering in the cases of car and speed in which it is not judged."""
    of = published(SOURCE)[id]
    found: dict[str, Metric] = {}
    for case in CASES[1:]:
        # What is claimed of a speed is judged as a force, which makes one only where u is held.
        if id == SPEED and case.endswith(FREE_SPEED):
            continue
        runs = {run: run + case for run in (BASELINE, *READINGS)}
        checks = []
        for check in of.checks:
            # Of those that are shown each has runs of its own.
            if check.is_judged:
                name = check.name + case.replace("_", " ")
                checks.append(replace(check.renamed(runs), name=name))
        found |= _judged(of, checks, driven)
    return found


def _chatter_within_the_figures(driven: ScenarioRuns) -> dict[str, Metric]:
    """Chatter within the 3 s of the figures, at the printed target and at a lower one of ours."""
    of = published(SOURCE)["ge.claim.chatter"]
    check = of.checks[0]
    found = _judged(_with_note(of, "T = k sgn(D) read as increment"), [check], driven)
    # The other readings do not come to the printed target in this time.
    for reading in ("rate", "offset"):
        run = reading + LOWERED
        words = {
            "increment": run,
            f"increment{SWITCHED}": run + SWITCHED,
            paper.TARGET: LOWER_TARGET,
        }
        changed = (
            f"T = k sgn(D) read as {reading}; "
            f"target slip CHANGED from {paper.TARGET:g} to {LOWER_TARGET:g}"
        )
        lower = replace(check.renamed(words), name=run)
        found |= _judged(_with_note(of, changed), [lower], driven)
    return found


def _with_note(of: Published, text: str) -> Published:
    return replace(of, text=Template((text,)))


def _judged(of: Published, checks: Sequence[Check], driven: ScenarioRuns) -> dict[str, Metric]:
    """Numbers of an id on other runs than those that it is judged on, by id and run."""
    found = replace(of, checks=tuple(checks)).metrics(dict.fromkeys(of.needs, driven))
    return {f"{of.id}.{name.replace(' ', '_')}": metric for name, metric in found.items()}


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Figs 3 and 4 for both cars, u held and free, and torques with and without layer."""
    sheets = {f"fig3_fig4{case}": Sheet(_case(runs, vehicle, case)) for case in CASES}
    torques = []
    for name in CHATTERING:
        for side in SIDES:
            torques.append(_torque(runs, name, side))
    return {**sheets, "boundary_layer": Sheet(torques)}


def _torque(runs: Runs, name: str, side: str) -> Panel:
    """Torque request of a rear wheel with and without boundary layer."""

    def curves() -> list[Curve]:
        both = (name, name + SWITCHED)
        return _curves(runs, both, lambda run: channel(run, f"torque_request.drive.rear_{side}"))

    return panel(f"{readable(name)}: torque, rear {side}", "torque [N m]", curves, scale=name)


def panels(runs: Runs, vehicle: Vehicle, names: Sequence[str]) -> dict[str, list[Panel]]:
    """Panels of figs 3 and 4 by their letter, with a curve for each of the runs."""

    def one(title: str, ylabel: str, of: Series, steady: float, scale: str = "") -> Panel:
        def curves() -> list[Curve]:
            found = _curves(runs, names, of)
            # The closed form is that of equal torques.
            if BASELINE in names:
                found.append(level(steady, *SETTLED, "published, equal torque"))
            return found

        return panel(title, ylabel, curves, scale)

    def both_wheels(
        title: str,
        ylabel: str,
        of: Callable[[Recording, str], np.ndarray],
        steady: Sequence[float],
    ) -> list[Panel]:
        left, right = steady
        return [
            one(f"{title}, rear left", ylabel, lambda run: of(run, "left"), left, title),
            one(f"{title}, rear right", ylabel, lambda run: of(run, "right"), right, title),
        ]

    def yaw_rate(run: Recording) -> np.ndarray:
        return channel(run, motion.YAW_RATE)

    turn = paper.steady_turn()
    speeds = paper.rear_speeds()
    slips = [paper.slip_of(load) for load in paper.rear_loads()]
    rims = [speed / (1 - each) for speed, each in zip(speeds, slips, strict=True)]
    return {
        "a": [
            one(
                "a  Sideslip angle",
                "angle [deg]",
                degrees(motion.sideslip_angle),
                np.degrees(turn.sideslip),
            )
        ],
        "b": [one("b  Radius of the path", "radius [m]", _radius, turn.radius)],
        "c": [
            one(
                "c  Centripetal acceleration",
                "acceleration [m/s²]",
                motion.lateral_acceleration_on_path,
                turn.centripetal_acceleration,
            )
        ],
        "d": [
            one("d  Yaw rate", "yaw rate [deg/s]", degrees(yaw_rate), np.degrees(turn.yaw_rate)),
            one(
                "d  Lateral speed",
                "speed [m/s]",
                lambda run: channel(run, "twist.lateral"),
                turn.lateral_speed,
            ),
        ],
        "e": both_wheels("e  Slip", "slip [1]", slip, slips),
        "f": [
            *both_wheels(
                "f  Ground speed along the wheel",
                "speed [m/s]",
                lambda run, side: ground_speed(run, side, vehicle),
                speeds,
            ),
            *both_wheels(
                "f  Rim speed",
                "speed [m/s]",
                lambda run, side: rim_speed(run, side, vehicle),
                rims,
            ),
        ],
    }


def _radius(run: Recording) -> np.ndarray:
    values = motion.radius_of_path(run)
    return np.where(np.abs(values) < WIDEST_RADIUS, values, np.nan)


def _case(runs: Runs, vehicle: Vehicle, case: str) -> list[Panel]:
    """All panels of a case, with the speed of the car where it is free, else with the requests."""
    names = [name + case for name in (BASELINE, *READINGS)]
    by_letter = panels(runs, vehicle, names)
    if FREE_SPEED in case:
        title, ylabel, quantity = "Longitudinal speed", "speed [m/s]", _longitudinal_speed
    else:
        title, ylabel = "Torque requests, right minus left", "torque [N m]"
        quantity = _torque_difference
    by_letter["c"].append(panel(title, ylabel, lambda: _curves(runs, names, quantity)))
    ending = f",{readable(case)}" if case else ""
    shown = []
    for of_letter in by_letter.values():
        for each in of_letter:
            shown.append(replace(each, title=each.title + ending))
    return shown


def _longitudinal_speed(run: Recording) -> np.ndarray:
    return channel(run, "twist.longitudinal")


def _torque_difference(run: Recording) -> np.ndarray:
    right = channel(run, "torque_request.drive.rear_right")
    return right - channel(run, "torque_request.drive.rear_left")


def _curves(runs: Runs, names: Iterable[str], quantity: Series) -> list[Curve]:
    """Curve of each run by its control; the titles have what the runs have in common."""
    found = []
    for name in names:
        run = run_named(runs, name)
        control = name.replace(FULL_CAR, "").replace(FREE_SPEED, "")
        found.append(Curve(run.time, quantity(run), readable(control)))
    return found


def _panel(figure: str, letter: str) -> PublishedPanel:
    def draw(driven: ScenarioRuns) -> Sheet:
        shown = panels(driven.runs, driven.vehicle, _RUNS[figure])[letter]
        ends = _ENDS.get(letter, (None, None))
        return Sheet([replace(each, ends=ends) for each in shown], columns=1)

    needs = (ScenarioNeed(SOURCE, runs=(BASELINE, *READINGS)),)
    ids = _IDS.get(figure + letter, (f"ge.fig{figure}{letter}",))
    return PublishedPanel(figure, letter, _TITLES[letter], ids, needs, draw)


def _panels() -> tuple[PublishedPanel, ...]:
    found = [scheme("1", "the model", "ge.fig1"), scheme("2", "the law", "ge.fig2")]
    # The panel with the law and the one with equal torques are read together.
    for letter in _TITLES:
        found += [_panel("3", letter), _panel("4", letter)]
    return tuple(found)


PANELS = _panels()
