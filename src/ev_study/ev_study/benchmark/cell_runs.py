"""Settings of all runs of a cell: layout, road, steering angles, and its laws for the car."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.methods.hooks import SAME
from ev_core.parameters.declaration import flatten
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_sim.surfaces import SURFACES
from ev_sim.understeer import axle_cornering_stiffnesses
from ev_stack.batches.variation import EVERY_ROLE
from ev_stack.measures.metric import NotMeasured
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.running.steering_angles import angle_at, driven_slowly, on_its_own_angles
from ev_stack.scenarios.records import Overrides, Run, Scenario
from ev_stack.scenarios.scenario import load_scenario
from ev_stack.scenarios.slow_ramp import COLUMN, SCALE
from ev_study.benchmark.board import COSTS, SIDES, Board, Cell, by_role
from ev_study.benchmark.entry_speed import CLEAN, DRIVEN, searched_at

# groups in which laws keep what they believe of the tyres
TYRES = ("single_track", "known.observer", "observer")
SCALE_OF_ANGLES = f"{COLUMN}.{SCALE}"
SEEDS = f"{EVERY_ROLE}.seed"
# Fields beside the metrics in the record of a run (ranking/result.py) or in what is driven
# (entry_speed.py).
FIELDS = (
    "cell",
    "law",
    "draw",
    "unstable",
    *(f"{cost}_cost" for cost in COSTS),
    "signal_hash",
    "command",
)
FIELDS += ("demand_met", "once_more", CLEAN, DRIVEN)


def values_of(board: Board, cell: Cell) -> dict[str, Any]:
    """Values of all runs of a cell by ROLE.PARAMETER: layout, road, and those of the manoeuvre."""
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    for name in named_metrics(manoeuvre.measured):
        if name in FIELDS:
            raise ParameterError(
                f"metric {name} of {cell.manoeuvre} has the name of a field of records, expected is"
                " another name"
            )
    # The names are what counts here; any value of the range gives them.
    searched = searched_at(manoeuvre, np.array(manoeuvre.searched[:1]))
    varied = [each.parameter for each in board.variations]
    for number, name in enumerate(varied):
        _refuse_twice("the board varies", [name], [*varied[:number], *searched])
    # a factor is on what is set
    absolute = [each.parameter for each in board.variations if not each.factor]
    _refuse_twice(f"manoeuvre {cell.manoeuvre} sets", manoeuvre.values, [*absolute, *searched])
    values = {**_layout_and_road(board, cell), **manoeuvre.values}
    if manoeuvre.steering_on:
        values[SCALE_OF_ANGLES] = _scale_of_angles(board, replace(cell, road=manoeuvre.steering_on))
    if manoeuvre.entry_speed:
        # The lower bound: a run that is only configured needs some speed.
        values |= {name: column[0] for name, column in searched.items()}
    return values


def _refuse_twice(subject: str, names: Iterable[str], others: Sequence[str]) -> None:
    """ParameterError if a ROLE.PARAMETER is set or varied a second time: one of the values would be lost."""
    for name, other in itertools.product(names, others):
        role, _, parameter = name.partition(".")
        role_of_other, _, same = other.partition(".")
        if parameter == same and (role == role_of_other or EVERY_ROLE in (role, role_of_other)):
            raise ParameterError(
                f"{subject} {name}, and {other} is varied already, expected one of them"
            )


def _layout_and_road(board: Board, cell: Cell) -> dict[str, Any]:
    road = board.roads[cell.road]
    sides = {
        side: [f"{side}_{n}" if n else side for n in range(len(surfaces))]
        for side, surfaces in zip(SIDES, (road.left, road.right), strict=True)
    }
    values: dict[str, Any] = {
        "pattern": "constant",
        # Every surface of the road gets a name and numbers of its own: a draw changes only these.
        "own": [name for names in sides.values() for name in names],
        **sides,
    }
    if road.length:
        values |= {"pattern": "segments", "length": road.length}
    values |= surfaces_of(board, cell, 1.0)
    layout = {f"{EVERY_ROLE}.vehicle.driven_wheels": driven_wheels(board, cell)}
    return layout | {f"{MASTER}.road.{name}": value for name, value in values.items()}


def driven_wheels(board: Board, cell: Cell) -> list[str]:
    """The wheels that the layout of a cell drives."""
    return board.layouts[cell.car.partition(":")[2]]


def _scale_of_angles(board: Board, cell: Cell) -> float:
    """Ratio of this car's steering-wheel angle to the scenario's, from a slow ramp on a road."""
    values = {
        **_layout_and_road(board, cell),
        **board.manoeuvres[cell.manoeuvre].values,
        # The run that finds the scale has none itself.
        SCALE_OF_ANGLES: 1.0,
    }
    scenario = _scenario(board, cell, values)
    ramp = scenario.parameters.slow_ramp
    try:
        angle = angle_at(
            driven_slowly(scenario.runs[0], ramp), ramp.lateral_acceleration, ramp.read
        )
    except NotMeasured as why:
        raise ParameterError(f"steering angles of {cell.manoeuvre} for {cell.car}: {why}") from None
    # The scenario's angles are those of its own car at the same lateral acceleration.
    return angle / ramp.reference_angle


def surfaces_of(board: Board, cell: Cell, factor: float) -> dict[str, list[float]]:
    """All surfaces of a road as one's own with a factor on the friction, at the same slips: left ones, right ones."""
    road = board.roads[cell.road]
    sides = [SURFACES[name] for name in (*road.left, *road.right)]
    return {
        "own_c1": [factor * road.friction * side.c1 for side in sides],
        "own_c2": [road.stiffness * side.c2 for side in sides],
        "own_c3": [factor * road.friction * side.c3 for side in sides],
        "own_rolling_resistance": [side.rolling_resistance for side in sides],
    }


def run_of(board: Board, cell: Cell, values: Mapping[str, Any]) -> Run:
    """The run of a cell with the law of the scenario's file.

    ParameterError if a slow ramp gives no angles of its car: those of another are no test of it.
    """
    return on_its_own_angles(_scenario(board, cell, values).runs[0], {})[0]


def _scenario(board: Board, cell: Cell, values: Mapping[str, Any]) -> Scenario:
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    prepared = tuple((*name.split(".", 1), value) for name, value in values.items())
    overrides = Overrides((), (), manoeuvre.duration, cell.car.partition(":")[0], prepared)
    return load_scenario(manoeuvre.scenario, overrides, (manoeuvre.run,) if manoeuvre.run else ())


def law_values(board: Board, law: str, base: Run) -> dict[str, dict[str, Any]]:
    """Parameters of a law by role: those of the board, and the car's cornering stiffnesses."""
    found = by_role(board.laws[law])
    for role, values in found.items():
        common = base.configurations[role].common
        known = configure(role, {**flatten(common), **values}).values()
        # Of the nominal car on dry asphalt: a law does not know the drawn road.
        stiffness = axle_cornering_stiffnesses(common.vehicle)
        for group in TYRES:
            for axle, value in zip(("front", "rear"), stiffness, strict=True):
                name = f"{group}.{axle}_cornering_stiffness"
                # What the board gives the law stays.
                if name in known and name not in values:
                    values[name] = value
        varied = [SEEDS, *(each.parameter for each in board.variations)]
        _refuse_twice("it states", [f"{role}.{name}" for name in values], varied)
    return found


def law_of(board: Board, law: str, base: Run) -> dict[str, Configuration]:
    """A law of the board for the car of a run, by role."""
    try:
        found = law_values(board, law, base)
        common = {role: flatten(base.configurations[role].common) for role in found}
        return {role: configure(role, {**common[role], **values}) for role, values in found.items()}
    except ParameterError as error:
        raise ParameterError(f"law {law}: {error}") from None


def with_law(run: Run, law: Mapping[str, Configuration]) -> Run:
    """A run with the nodes of a law, and with the options of other nodes that these require."""
    configurations = {**run.configurations, **law}
    for node in law.values():
        for what, needed in node.method.requires.items():
            role, _, parameter = what.partition(".")
            # An option, such as speed mode of the plant: other methods are the manoeuvre's matter.
            if parameter and needed != SAME and role not in law and role in configurations:
                configurations[role] = configurations[role].changed({parameter: needed})
    return replace(run, configurations=configurations)
