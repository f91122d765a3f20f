"""A board as its file declares it: cars, roads, manoeuvres, variations, laws, and their cells.

How it works: the YAML text becomes records (`records.record`), which refuse entries of another
kind. `_refuse` then holds names and bounds against each other: cars, layouts, roads, manoeuvres,
variations and laws. What needs a configured run (whether a parameter exists, fits or is varied
twice) is refused later, by `cell_runs` and `added`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import yaml

from ev_core.parameters.data_file import TEXT, TextOfFile, read_data
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.surfaces import SURFACES
from ev_stack.measures.metric import HIGHER, LOWER
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.measures.registry import METRICS
from ev_stack.scenarios.files import configured_file
from ev_stack.scenarios.parameter_file import marked, read_yaml
from ev_study.benchmark.manoeuvre import ENTRY_SPEED, Manoeuvre
from ev_study.benchmark.records import is_of, mapping, record, refuse_unknown

COSTS = ("handling", "energy")
SIDES = ("left", "right")
ROLE = "electronic_differential"  # that every law of a board plays
# Of these roles a law's values begin with the name of the role.
FURTHER = ("asr",)  # roles that it may play as well
CASES = ("training", "validation", "held_out")
_ALIKE = ("method", "reference", "allocation", "estimation", "asr.method")  # in the closed division
# Variations that are no parameters.
FRICTION = "friction"
TOLD_FRICTION = "told_friction"
MOTOR_FAULT = "motor_fault"


@dataclass(frozen=True, slots=True)
class Road:
    """Surfaces under the left and the right wheels, one behind the other.

    The lengths of all but the last [m].

    `friction` and `stiffness` are factors on c1 and c3, and on c2 of all its surfaces.
    """

    left: list[str]
    right: list[str]
    length: list[float] = field(default_factory=list)
    friction: float = 1.0
    stiffness: float = 1.0


@dataclass(frozen=True, slots=True)
class Variation:
    """A parameter and one of: the bounds of a factor on what the car has, of a value, of a whole number; or a choice.

    Of `motor_fault` the value is the share that the motor of one driven wheel still gives; `begin`
    are bounds of when that begins [s], `probability` that there is a fault at all.
    """

    parameter: str
    factor: list[float] = field(default_factory=list)
    value: list[float] = field(default_factory=list)
    count: list[int] = field(default_factory=list)
    choice: list[float] = field(default_factory=list)
    begin: list[float] = field(default_factory=list)
    probability: float = 1.0

    @property
    def bounds(self) -> list[float]:
        """The lower and the upper one."""
        return self.factor or self.value or self.count or [0.0, 1.0]


@dataclass(frozen=True, slots=True)
class Cases:
    """Cases for a seed: cars, bounds of `friction` and `stiffness` of roads, more variations."""

    cars: list[str]
    friction: list[float]
    stiffness: list[float]
    variations: list[Variation] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Cell:
    """A car in a manoeuvre on a road, driven and compared at once."""

    board: str
    version: int
    car: str
    manoeuvre: str
    road: str

    def id(self, cost: str) -> str:
        """CAR:LAYOUT:MANOEUVRE:ROAD:COST:vN."""
        return f"{self.car}:{self.manoeuvre}:{self.road}:{cost}:v{self.version}"


@dataclass(frozen=True, slots=True)
class Board:
    """All that a board declares.

    `reference` is the law that costs are counted against, `scales` by metric what its differences
    are divided by at least, `unstable` the sideslip from which on a run counts as unstable [rad].
    `closed` are the laws of the closed division, which differ in their controller alone; all others
    are in the open one. A law states a method of the electronic differential and its parameters,
    and those of other roles as asr.method, asr.PARAMETER. `tuned` are the laws that are tuned, and
    patterns of the numbers that are free then.
    """

    version: int
    seed: int
    draws: int
    reference: str
    unstable: float
    scales: Mapping[str, float]
    cars: list[str]
    layouts: Mapping[str, list[str]]
    roads: Mapping[str, Road]
    manoeuvres: Mapping[str, Manoeuvre]
    variations: list[Variation]
    laws: Mapping[str, Mapping[str, Any]]
    closed: list[str] = field(default_factory=list)
    training: Cases | None = None
    validation: Cases | None = None
    held_out: Cases | None = None
    tuned: Mapping[str, list[str]] = field(default_factory=dict)
    name: str = ""

    def cells(self, pattern: str = "*") -> list[Cell]:
        """Return the cells of which an id fits a pattern as of file names.

        Raises ParameterError if none does.
        """
        every = []
        for car in self.cars:
            for name, manoeuvre in self.manoeuvres.items():
                if car not in manoeuvre.without:
                    for road in manoeuvre.roads:
                        every.append(Cell(self.name, self.version, car, name, road))
        found = []
        for cell in every:
            # A cell is driven once for both costs, so a pattern of either chooses it.
            if any(fnmatchcase(cell.id(cost), pattern) for cost in COSTS):
                found.append(cell)
        if not found:
            raise unknown_name("cell", pattern, [each.id(cost) for each in every for cost in COSTS])
        return found


def read_board(name: str) -> Board:
    """Return the board of a name in config/benchmarks, or of a path.

    Raises ParameterError, in one line, for what is wrong in it.
    """
    path = configured_file("benchmark", name)
    try:
        content = read_yaml(read_data(path, TEXT).decode())
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror}") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        why = " ".join(str(error).split())
        raise ParameterError(f"{path}: not readable as YAML: {why}") from None
    try:
        # Marked, so that a path in the board is one beside its file, and leads less far than a
        # user's.
        board = _board(name, marked("", dict(mapping("a board", content)), path))
        _refuse(board, path)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from None
    return board


def _board(name: str, whole: dict[str, Any]) -> Board:
    """Return the board that the content of a file states; its records are made before."""
    recorded = whole.pop("recorded", [])
    manoeuvres = {}
    for each, stated in mapping("manoeuvres", whole.get("manoeuvres")).items():
        what = f"manoeuvre {each}"
        # What a manoeuvre has itself goes before that of the board.
        manoeuvres[each] = record(Manoeuvre, what, {"recorded": recorded, **mapping(what, stated)})
    roads = {}
    for each, stated in mapping("roads", whole.get("roads")).items():
        roads[each] = record(Road, f"road {each}", stated)
    whole |= {"manoeuvres": manoeuvres, "roads": roads, "variations": _variations(whole)}
    for entry in CASES:
        if entry in whole:
            stated = dict(mapping(entry, whole[entry]))
            whole[entry] = record(Cases, entry, stated | {"variations": _variations(stated)})
    return record(Board, "a board", whole | {"name": name})


def _variations(of: Mapping[str, Any]) -> list[Variation]:
    return [record(Variation, "a variation", each) for each in of.get("variations") or ()]


def by_role(law: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Values of a law by the role that they belong to; the electronic differential is first."""
    found: dict[str, dict[str, Any]] = {ROLE: {}}
    for name, value in law.items():
        role, _, parameter = name.partition(".")
        # A dot may also belong to a group of the differential's own parameters.
        own, of = (role, parameter) if role in FURTHER else (ROLE, name)
        found.setdefault(own, {})[of] = value
    return found


def _expect(is_so: bool, otherwise: str) -> None:
    if not is_so:
        raise ParameterError(otherwise)


def _refuse(board: Board, path: Path) -> None:
    """ParameterError for names that nothing declares, and for bounds that are none."""
    _expect(1 <= board.draws <= 100_000, f"draws is {board.draws}, expected 1 to 100000")
    _expect(
        board.seed >= 0 and 0.0 < board.unstable <= 1.57,  # beyond it a car slides backwards
        f"seed is {board.seed}, unstable {board.unstable}, expected 0 or more, above 0 to 1.57",
    )
    cars = list(board.cars)
    variations = list(board.variations)
    for name in CASES:
        cases: Cases | None = getattr(board, name)
        if cases is not None:
            cars += cases.cars
            variations += cases.variations
            for bounds in (cases.friction, cases.stiffness):
                _expect(
                    _rise(bounds) and bounds[0] > 0.0 and bounds[1] <= 2.0,
                    f"{name} has the bounds {bounds}, expected two numbers that rise, above 0 to 2",
                )
    # Those of training, validation and the end as well: a mistake there would show only then.
    for car in cars:
        configured_file("vehicle", TextOfFile.of(car.partition(":")[0], path))
    refuse_unknown("layout", [car.partition(":")[2] for car in cars], board.layouts)
    for name, road in board.roads.items():
        _expect(
            # The last surface goes on for ever.
            len(road.left) == len(road.right) == len(road.length) + 1,
            f"road {name} needs as many surfaces left as right, and a length for all but the last",
        )
        refuse_unknown(f"surface of {name}", [*road.left, *road.right], SURFACES)
    for name, manoeuvre in board.manoeuvres.items():
        roads = [*manoeuvre.roads, manoeuvre.steering_on]
        refuse_unknown(f"road of {name}", filter(None, roads), board.roads)
        refuse_unknown(f"car of {name}", manoeuvre.without, cars)
        _refuse_search(name, manoeuvre)
        _refuse_metrics(board.scales, name, manoeuvre)
    for variation in variations:
        _refuse_variation(variation)
    _refuse_laws(board)


def _refuse_laws(board: Board) -> None:
    refuse_unknown("reference", [board.reference], board.laws)
    for name, values in board.laws.items():
        for role, stated in by_role(mapping(f"law {name}", values)).items():
            place = "" if role == ROLE else f"{role}."
            _expect("method" in stated, f"law {name} lacks {place}method")
    refuse_unknown("law of tuned", list(board.tuned), board.laws)
    for name, patterns in board.tuned.items():
        _expect(
            isinstance(patterns, list) and all(is_of(each, "str") for each in patterns),
            f"tuned has {name} with {quoted(str(patterns))}, expected a list of texts",
        )
    refuse_unknown("law of closed", board.closed, board.laws)
    # The closed division compares controllers: all else of its laws has to be the same.
    alike = {tuple(board.laws[name].get(part) for part in _ALIKE) for name in board.closed}
    _expect(
        len(alike) <= 1,
        f"closed has laws that differ in one of {', '.join(_ALIKE)}, expected equal ones",
    )


def _refuse_variation(variation: Variation) -> None:
    what = f"variation of {variation.parameter}"
    bounds = [*variation.factor, *variation.value, *variation.count]
    _expect(
        not bounds if variation.choice else _rise(bounds),
        f"{what} has the bounds {bounds}, expected two that rise, "
        "of one of factor, value, count, or a choice",
    )
    if variation.parameter == MOTOR_FAULT:
        shares = variation.value
        begin = variation.begin
        within = _rise(shares) and shares[0] >= 0.0 and shares[1] <= 1.0
        _expect(
            within and _rise(begin) and begin[0] >= 0.0,
            f"{what} needs value and begin, expected two shares within 0 to 1 and two times",
        )
        _expect(
            0.0 <= variation.probability <= 1.0,
            f"{what} has the probability {variation.probability}, expected 0 to 1",
        )
    else:
        _expect(
            not variation.begin and variation.probability == 1.0,
            f"{what} has begin or probability, expected for {MOTOR_FAULT} alone",
        )


def _rise(bounds: Sequence[float]) -> bool:
    return len(bounds) == 2 and bounds[0] <= bounds[1]


def _refuse_metrics(scales: Mapping[str, float], name: str, manoeuvre: Manoeuvre) -> None:
    _expect(
        bool(manoeuvre.demand or manoeuvre.searched),
        f"{name} lacks demand, expected are metrics of what the driver asks for, better the more",
    )
    counted = named_metrics(manoeuvre.metrics(*COSTS))
    demanded = named_metrics(manoeuvre.demand)
    for metric, each in counted.items():
        _expect(
            metric not in METRICS or bool(each.better),
            f"metric {metric} of {name} is better neither low nor high",
        )
    for metric, each in demanded.items():
        # A metric of the costs without a direction counts as better low there, so it is no demand.
        is_low = each.better == LOWER or (metric in counted and each.better != HIGHER)
        _expect(
            not is_low,
            f"demand of {name} is {metric}, which is better low, expected is better the more",
        )
    for metric in named_metrics(manoeuvre.measured):
        # What is only recorded is divided by nothing.
        if metric in counted or metric in demanded:
            scale = scales.get(metric)
            _expect(
                is_of(scale, "float") and scale > 0.0,
                f"scales lacks a number above 0 for {metric} of {name}",
            )


def _refuse_search(name: str, manoeuvre: Manoeuvre) -> None:
    _expect(
        not (manoeuvre.entry_speed and manoeuvre.speed_scale),
        f"{name} has entry_speed and speed_scale, expected one of them",
    )
    what = "speed_scale" if manoeuvre.speed_scale else "entry_speed"
    bounds = manoeuvre.searched
    if bounds:
        is_range = len(bounds) == 2 and 0.0 < bounds[0] < bounds[1]
        _expect(
            is_range and 1 <= manoeuvre.halvings <= 30,
            f"{what} of {name} is {bounds}, expected two numbers that rise, and 1 to 30 halvings",
        )
    _expect(
        bool(manoeuvre.entry_speed) or ENTRY_SPEED not in manoeuvre.measured,
        f"entry_speed of {name} is measured, expected with the bounds entry_speed: [LOW, HIGH]",
    )
