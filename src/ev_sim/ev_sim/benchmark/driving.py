"""The runs of a cell: one batch for each law, with the same seeded draws for all of them."""

from __future__ import annotations

import itertools
import json
import math
import shlex
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration, configure
from ev_core.parameters.declaration import flatten
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_sim.batches.variation import EVERY_ROLE
from ev_sim.benchmark.board import FRICTION, MOTOR_FAULT, SIDES, TOLD_FRICTION, Board, Cell, Variation, by_role
from ev_sim.benchmark.entry_speed import CLEAN, END, HASH, Driven, at_highest_clean, searched_at
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.understeer import axle_cornering_stiffnesses
from ev_sim.recording.recording import combined_hash
from ev_sim.scenarios.scenario import Overrides, Run, Scenario, load_scenario
from ev_sim.scenarios.slow_ramp import COLUMN, SCALE, angle_at, driven_slowly
from ev_sim.surfaces import SURFACES

BELIEF = ("known.error_factor", "error_factor")  # how laws call the friction that they believe in over the true one
TYRES = ("single_track", "known.observer", "observer")  # groups in which laws keep what they believe of the tyres
SCALE_OF_ANGLES = f"{COLUMN}.{SCALE}"
_SEEDS, _FAULTS, _ANYTHING = f"{EVERY_ROLE}.seed", "faults", 2**31


@dataclass(frozen=True)
class Draws:
    """By ROLE.PARAMETER a value for each run, for all laws; `told` are factors of the friction that they believe."""

    values: Mapping[str, Sequence[Any]]
    told: Sequence[float]


@dataclass(frozen=True)
class LawInCell:
    """All runs of a law in a cell: as one is configured, what varies, and by ROLE.PARAMETER what is alike in all."""

    run: Run
    vary: Mapping[str, Sequence[Any]]
    fixed: Mapping[str, Any]

    def only(self, draw: int) -> LawInCell:
        """One of the runs."""
        return replace(self, vary={name: [column[draw]] for name, column in self.vary.items()})


@dataclass(frozen=True)
class DrivenCell:
    """What was measured in a cell: by law and name one number for each draw, NaN where there is none.

    `commands` and `hashes` have by law for each draw the line that drives it alone, and the signal hash that this line
    gives, empty where a number is not finite; `clean` whether it was, where an entry speed was looked for.
    """

    cell: Cell
    metrics: dict[str, Mapping[str, np.ndarray]]
    commands: dict[str, Sequence[str]]
    hashes: dict[str, Sequence[str]]
    clean: dict[str, np.ndarray]


def drive_cell(board: Board, cell: Cell, laws: Sequence[str], threads: int | None = None) -> DrivenCell:
    """Drive all draws of a cell with each law; ParameterError for what the file of the board gets wrong."""
    driven = DrivenCell(cell, {}, {}, {}, {})
    for law, runs in laws_in_cell(board, cell, laws).items():
        words, found = drive_law(board, cell, runs, threads)
        driven.metrics[law] = {name: of for name, of in found.items() if name not in (CLEAN, HASH, END)}
        driven.clean[law] = found.get(CLEAN, np.ones(board.draws)) == 1.0
        driven.commands[law] = list(map(shlex.join, words))
        driven.hashes[law] = [each and combined_hash({runs.run.name: each}) for each in found[HASH].tolist()]
    return driven


def drive_law(board: Board, cell: Cell, runs: LawInCell, threads: int | None = None) -> tuple[list[list[str]], Driven]:
    """Drive a law in a cell: what came of it, and the words that drive each run alone.

    They do so over DDS, or with --offline or --in-process behind them another way.
    """
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    speeds, found = at_highest_clean(board, manoeuvre, runs.run, runs.vary, threads)
    words = ["scripts/run.sh", manoeuvre.scenario, *(["--run", manoeuvre.run] if manoeuvre.run else [])]
    words += ["--vehicle", cell.car.partition(":")[0], "--duration"]
    commands = []
    for draw, end in enumerate(found[END].tolist()):
        values = {**runs.fixed, **{name: column[draw] for name, column in {**runs.vary, **speeds}.items()}}
        set_to = [word for name, value in values.items() for word in ("--set", f"{name}={json.dumps(value)}")]
        commands.append([*words, repr(manoeuvre.duration if math.isnan(end) else end), *set_to])
    return commands, found


def laws_in_cell(board: Board, cell: Cell, laws: Sequence[str]) -> dict[str, LawInCell]:
    """By law its runs in a cell, the same draws for all; ParameterError for what the file of the board gets wrong."""
    fixed = values_of(board, cell)
    base = run_of(board, cell, fixed)
    draws, found = drawn(board, cell, base.configurations), {}
    for law in laws:
        playing = law_of(board, law, base)
        values = law_values(board, law, base)
        of_law = {f"{role}.{name}": value for role, of in values.items() for name, value in of.items()}
        _refuse_lost(f"manoeuvre {cell.manoeuvre}", law, fixed.keys() - of_law.keys(), base.configurations, playing)
        run = replace(base, configurations={**base.configurations, **playing})
        found[law] = LawInCell(run, {**draws.values, **own_draws(playing, draws)}, {**fixed, **of_law})
    return found


def values_of(board: Board, cell: Cell) -> dict[str, Any]:
    """By ROLE.PARAMETER what is the same in all runs of a cell: layout, road, and what the manoeuvre sets."""
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    searched = searched_at(manoeuvre, np.array(manoeuvre.searched[:1]))
    varied = [each.parameter for each in board.variations]
    for number, name in enumerate(varied):
        _refuse_twice("the board varies", [name], [*varied[:number], *searched])
    anew = [each.parameter for each in board.variations if not each.factor]  # a factor is on what is set
    _refuse_twice(f"manoeuvre {cell.manoeuvre} sets", manoeuvre.values, [*anew, *searched])
    values = {**_layout_and_road(board, cell), **manoeuvre.values}
    if manoeuvre.steering_on:
        values[SCALE_OF_ANGLES] = _scale_of_angles(board, replace(cell, road=manoeuvre.steering_on))
    if manoeuvre.entry_speed:
        values |= {name: column[0] for name, column in searched.items()}
    return values


def _refuse_lost(
    who: str, law: str, names: Iterable[str], run: Mapping[str, Configuration], playing: Mapping[str, Configuration]
) -> None:
    """ParameterError if a law does not have what is set for its role by ROLE.PARAMETER in the run without it."""
    for name in sorted(names):
        role, _, parameter = name.partition(".")
        if role in playing and playing[role].values().get(parameter) != run[role].values().get(parameter):
            raise ParameterError(f"{who} sets {name}, which law {law} does not take over, allowed is in the law")


def _refuse_twice(who: str, names: Iterable[str], others: Sequence[str]) -> None:
    """ParameterError if a ROLE.PARAMETER is set or varied a second time: one of the values would be lost."""
    for name, other in itertools.product(names, others):
        role, _, parameter = name.partition(".")
        role_of_other, _, same = other.partition(".")
        if parameter == same and (role == role_of_other or EVERY_ROLE in (role, role_of_other)):
            raise ParameterError(f"{who} {name}, and {other} is varied already, allowed is one of them")


def _layout_and_road(board: Board, cell: Cell) -> dict[str, Any]:
    road = board.roads[cell.road]
    sides = {
        side: [f"{side}_{n}" if n else side for n in range(len(surfaces))]
        for side, surfaces in zip(SIDES, (road.left, road.right), strict=True)
    }
    values: dict[str, Any] = {
        "pattern": "constant",
        "own": [name for names in sides.values() for name in names],
        **sides,
    }
    if road.length:
        values |= {"pattern": "segments", "length": road.length}
    values |= _surfaces(board, cell, 1.0)
    layout = {f"{EVERY_ROLE}.vehicle.driven_wheels": _driven(board, cell)}
    return layout | {f"{MASTER}.road.{name}": value for name, value in values.items()}


def _driven(board: Board, cell: Cell) -> list[str]:
    return board.layouts[cell.car.partition(":")[2]]


def _scale_of_angles(board: Board, cell: Cell) -> float:
    """By what this car has to turn the steering wheel farther than that of the scenario, from a slow ramp on a road."""
    values = {**_layout_and_road(board, cell), **board.manoeuvres[cell.manoeuvre].values, SCALE_OF_ANGLES: 1.0}
    scenario = _scenario(board, cell, values)
    ramp = scenario.parameters.slow_ramp
    try:
        angle = angle_at(driven_slowly(scenario.runs[0], ramp), ramp.lateral_acceleration, ramp.read)
    except NotMeasured as why:
        raise ParameterError(f"steering angles of {cell.manoeuvre} for {cell.car}: {why}") from None
    return angle / ramp.reference_angle


def _surfaces(board: Board, cell: Cell, factor: float) -> dict[str, list[float]]:
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
    """The run of a cell with the law of the scenario's file."""
    return _scenario(board, cell, values).runs[0]


def _scenario(board: Board, cell: Cell, values: Mapping[str, Any]) -> Scenario:
    manoeuvre = board.manoeuvres[cell.manoeuvre]
    prepared = tuple((*name.split(".", 1), value) for name, value in values.items())
    overrides = Overrides((), (), manoeuvre.duration, cell.car.partition(":")[0], prepared)
    return load_scenario(manoeuvre.scenario, overrides, (manoeuvre.run,) if manoeuvre.run else ())


def law_values(board: Board, law: str, base: Run) -> dict[str, dict[str, Any]]:
    """By role the parameters of a law: those of the board, and the cornering stiffnesses of the car it asks for."""
    found = by_role(board.laws[law])
    for role, values in found.items():
        common = base.configurations[role].common
        known = configure(role, {**flatten(common), **values}).values()
        stiffness = axle_cornering_stiffnesses(common.vehicle)
        for group in TYRES:
            for axle, value in zip(("front", "rear"), stiffness, strict=True):
                name = f"{group}.{axle}_cornering_stiffness"
                if name in known and name not in values:
                    values[name] = value
        varied = [_SEEDS, *(each.parameter for each in board.variations)]
        _refuse_twice("it states", [f"{role}.{name}" for name in values], varied)
    return found


def law_of(board: Board, law: str, base: Run) -> dict[str, Configuration]:
    """By role a law of the board for the car of a run."""
    try:
        found = law_values(board, law, base)
        common = {role: flatten(base.configurations[role].common) for role in found}
        return {role: configure(role, {**common[role], **values}) for role, values in found.items()}
    except ParameterError as error:
        raise ParameterError(f"law {law}: {error}") from None


def drawn(board: Board, cell: Cell, base: Mapping[str, Configuration]) -> Draws:
    """The draws of a cell, by the seed of the board and the name of the cell."""
    random = np.random.Generator(np.random.PCG64([board.seed, zlib.crc32(cell.id("").encode())]))
    values: dict[str, list[Any]] = {_SEEDS: random.integers(_ANYTHING, size=board.draws).tolist()}
    told = [1.0] * board.draws
    for variation in board.variations:
        low, high = variation.bounds
        even = (low + (high - low) * random.random(board.draws)).tolist()
        if variation.parameter == FRICTION:
            surfaces = [_surfaces(board, cell, factor) for factor in even]
            for name in ("own_c1", "own_c3"):
                values[f"{MASTER}.road.{name}"] = [each[name] for each in surfaces]
        elif variation.parameter == TOLD_FRICTION:
            told = even
        elif variation.parameter == MOTOR_FAULT:
            of_run = base[MASTER].values()[_FAULTS]
            faults = _motor_faults(variation, _driven(board, cell), even, random)
            values[f"{MASTER}.{_FAULTS}"] = [[*of_run, *each] for each in faults]
        elif variation.choice:
            chosen = random.integers(len(variation.choice), size=board.draws).tolist()
            values[variation.parameter] = [variation.choice[each] for each in chosen]
        elif variation.count:
            values[variation.parameter] = random.integers(int(low), int(high) + 1, size=board.draws).tolist()
        else:
            of_car = value_in(base, variation.parameter) if variation.factor else 1.0
            values[variation.parameter] = [of_car * each for each in even]
    return Draws(values, told)


def _motor_faults(
    variation: Variation, wheels: Sequence[str], shares: Sequence[float], random: np.random.Generator
) -> list[list[str]]:
    """The faults of each run: none, or that of the motor of one of some wheels."""
    struck = random.random(len(shares)) < variation.probability
    places = random.integers(len(wheels), size=len(shares))
    low, high = variation.begin
    begins = low + (high - low) * random.random(len(shares))
    texts = [
        f"motor_share {wheels[place]} {share:.3f} from {begin:.2f}"
        for place, share, begin in zip(places, shares, begins, strict=True)
    ]
    return [[text] if is_struck else [] for text, is_struck in zip(texts, struck, strict=True)]


def value_in(base: Mapping[str, Configuration], name: str) -> float:
    """What a variation by a factor is on; ParameterError if it is no number."""
    role, _, parameter = name.partition(".")
    known = base[MASTER if role == EVERY_ROLE else role].values() if role == EVERY_ROLE or role in base else {}
    if not isinstance(known.get(parameter), float):
        raise ParameterError(f"{name} is refused: nothing of this name has a number that a factor could change")
    return float(known[parameter])


def own_draws(law: Mapping[str, Configuration], draws: Draws) -> dict[str, Sequence[float]]:
    """What is drawn for a law alone: by the names that it has for the friction it believes in, its own factor x told.

    ParameterError if one of the products is beyond the bounds of that name.
    """
    return {
        f"{role}.{name}": [own * told for told in draws.told]
        for role, of in law.items()
        for name, own in of.values().items()
        if name in BELIEF
    }
