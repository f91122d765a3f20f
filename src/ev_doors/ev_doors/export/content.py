"""Content of an export: the roles that are kept of a run, as parts in order.

How it works: the parts are those that a run steps: the law of each role and behind it its sensors
and faults, each with a row of constants and its state. Which parameters may change later is found
out, not declared: laws and rules are called with parameters that note what is read (`_watched`).
What was read while something was set up is in the constants already, and is fixed.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any, NamedTuple

from ev_core.compiled.part import ROW_CODE, code_of, given_to, in_one_line
from ev_core.compiled.part_source import HEAD, constants_row, law_of
from ev_core.compiling.code_store import key_of, reach_of
from ev_core.compiling.machine_code import Code
from ev_core.faults import row
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import restarts, rows_of
from ev_core.lockstep.run import roles_in_order
from ev_core.methods.law import Given, given_names
from ev_core.parameters.declaration import entries
from ev_core.parameters.record import numbers
from ev_core.sensors import measuring
from ev_core.sensors.row import SensorRow
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.scenarios.records import Run


class Channel(NamedTuple):
    """A number that goes in or comes out, and its place in the frame."""

    name: str
    unit: str
    place: int


class Tunable(NamedTuple):
    """A parameter that may change from step to step, as its law reads it; its place in the row."""

    name: str
    unit: str
    low: float
    high: float
    place: int


class Part(NamedTuple):
    """One function of each control period: the law of a role, its sensors, or its faults.

    `begin` and `end` say where it writes in the frame, `seeds` where the seed stands in its
    constants. Its state is put back to its start at the instants `restarts`.
    """

    role: str
    code: Code
    constants: list[float]
    state: list[float]
    begin: int
    end: int
    seeds: tuple[int, ...] = ()
    tunables: tuple[Tunable, ...] = ()
    restarts: tuple[int, ...] = ()

    @property
    def is_changed(self) -> bool:
        """Mark of a part with constants that change, so that each object has its own."""
        return bool(self.seeds or self.tunables)


class Content:
    """A run with `only` some of its roles, or `without` some, as `ev_stack.Simulation` steps it.

    What the roles that are left out would write are its inputs. `bare` are those kept without their
    sensors and faults.

    ParameterError, in one line, for an unknown role, for one that is not compiled, and where
    nothing is left.
    """

    def __init__(
        self,
        run: Run,
        only: Collection[str] = (),
        without: Collection[str] = (),
        bare: bool = False,
    ) -> None:
        for role in (*only, *without):
            if role not in run.configurations:
                raise unknown_name("role", role, run.configurations)
        without = [
            role for role in run.configurations if role in without or (only and role not in only)
        ]
        self.run, self.period = run, run.period
        answering, integrating = roles_in_order(run.configurations)
        self.roles = tuple(role for role in (*answering, *integrating) if role not in without)
        if not self.roles:
            raise ParameterError(
                f"{run.name}: all roles are left out, expected to keep one at least"
            )
        self._kept = {role: run.configurations[role] for role in self.roles}
        # As in `ev_stack.Simulation`: what answers in front of the first input is shown at once.
        first = min(
            (answering.index(role) for role in without if role in answering), default=len(answering)
        )
        # An input in the place of what integrates counts from the start of an instant: none answers
        # before.
        if any(role in integrating for role in without):
            first = 0
        before = answering[:first]
        # A parameter that another method requires of this one must not change alone.
        required = {name for each in run.configurations.values() for name in each.method.requires}
        self.parts = [part for each in self._kept.values() for part in _parts(each, required, bare)]
        self.before = sum(part.role in before for part in self.parts)
        self.answering = sum(part.role in answering for part in self.parts)
        # The random parts of a method, such as a road, are constants: another seed would need
        # others.
        self.takes_seeds = not any(each.has_random_method for each in self._kept.values())
        self.seed = max(each.common.seed for each in self._kept.values())

    @cached_property
    def outputs(self) -> list[Channel]:
        """All that the kept roles write."""
        return _channels(signal for each in self._kept.values() for signal in each.method.writes)

    @cached_property
    def inputs(self) -> list[Channel]:
        """Signals that the kept roles read of those that are left out."""
        written = {signal for each in self._kept.values() for signal in each.method.writes}
        return _channels(
            s for each in self._kept.values() for s in each.method.inputs if s not in written
        )

    @property
    def size(self) -> int:
        """Numbers of a frame, up to the last one that is read or written."""
        return 1 + max(channel.place for channel in (*self.inputs, *self.outputs))

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all code, constants and states, and of the order and names of everything."""
        digest = hashlib.sha256(
            repr((self.period, self.inputs, self.outputs, self.before, self.answering)).encode()
        )
        for part in self.parts:
            # The key changes with the text of the code and all that it reaches.
            digest.update(repr((key_of(*part.code), *part[2:])).encode())
        return digest.hexdigest()


def _channels(signals: Iterable[type]) -> list[Channel]:
    named = dict.fromkeys(signal for signal in signals if signal in frame.PLACES)
    units, places = frame.units(), frame.channels()
    found = [Channel(name, units[name], places[name]) for s in named for name in TOPICS[s].channels]
    return sorted(found, key=lambda channel: channel.place)


def _parts(configuration: Configuration, required: Collection[str], bare: bool) -> list[Part]:
    """The part of a method, and those of its sensors and faults."""
    method, parameters, common = configuration.method, configuration.given, configuration.common
    role, vehicle, period = configuration.role, common.vehicle, common.control_period
    if method.law is None or not method.law.is_compilable:
        raise ParameterError(
            f"{role} method {method.name} is not compiled, which an export needs: mark it"
            " @compilable"
        )
    given = given_to(method, parameters, vehicle, period)
    with in_one_line(method, parameters, vehicle, period) as look_at:
        code = code_of(method, given)
        look_at(reach_of(code.text, code.names))
    constants = constants_row(given.trees, given.values["c"], period).tolist()
    tunables = [each for each in _tunables(configuration, given) if each.name not in required]
    span, again = (
        frame.span(method.writes),
        tuple(int(n) for n in restarts(configuration) if n < math.inf),
    )
    state = numbers(given.values["s"])
    parts = [Part(role, code, constants, state, *span, tunables=tuple(tunables), restarts=again)]
    for each in () if bare else rows_of(configuration):
        seed = measuring.SEED if isinstance(each, SensorRow) else row.SEED
        # Each row of a sensor or fault has a seed of its own, at the same place within the row.
        seeds = tuple(range(each.head + seed, len(each.constants), each.width))
        parts.append(
            Part(role, ROW_CODE[type(each)], list(each.constants), list(each.state), *span, seeds)
        )
    return parts


def _tunables(configuration: Configuration, given: Given) -> list[Tunable]:
    """Parameters that may change live.

    They are numbers that set nothing up, that no rule ties to others, and that do something without
    another option.
    """
    method = configuration.method
    law, used = law_of(method), set[str]()
    # What is read while the law is set up is fixed: a change later would not reach it.
    parameters, common = _watched(configuration.given, used), configuration.common
    if law.prepare:
        _read_all(law.prepare(parameters, common.vehicle, common.control_period))
    for need in law.needs:
        need(parameters, common.vehicle)
    if law.start:
        values = {**given.values, "p": _watched(given.values["p"], used)}
        law.start(*(values[name] for name in given_names(law.start)))
    # Behind the head of the row of constants, in the order of the record.
    places = {name: len(HEAD) + n for n, name in enumerate(_names(given.trees["p"]))}
    return [
        Tunable(
            f"{configuration.role}.{each.name}",
            each.spec.unit,
            *_bounds(each.spec),
            places[each.name],
        )
        for each in entries(configuration.given)
        if each.type is float
        and not each.is_array
        and not each.spec.read_only
        and each.name not in used
        and not method.is_idle(each.name)
    ]


def _read_all(made: Any) -> None:
    """Read all of what was made beforehand: a group may have been handed on whole."""
    if isinstance(made, tuple):
        for each in made:
            _read_all(each)
    elif is_dataclass(made):
        for field in fields(made):
            _read_all(getattr(made, field.name))


def _bounds(spec: Any) -> tuple[float, float]:
    return (
        -math.inf if spec.low is None else spec.low,
        math.inf if spec.high is None else spec.high,
    )


def _names(tree: Mapping[str, Any], prefix: str = "") -> list[str]:
    found: list[str] = []
    for name, value in tree.items():
        found += (
            _names(value, f"{prefix}{name}.") if isinstance(value, Mapping) else [prefix + name]
        )
    return found


def _watched(parameters: Any, used: set[str], prefix: str = "") -> Any:
    """Copy the parameters as an object of a subclass that records the names that are read.

    Those that a rule of their dataclass reads are noted at once: an export, which does not know the
    rule, fixes them.
    """
    kind: type = type(parameters)
    names = [f.name for f in fields(kind)] if is_dataclass(kind) else [*vars(parameters)]

    def read(self: Any, name: str) -> Any:
        value = object.__getattribute__(self, name)
        if name in names and not _is_group(value):
            used.add(prefix + name)
        return value

    # A subclass, so that isinstance and the methods of the parameters still work.
    watched: Any = type(kind.__name__, (kind,), {"__slots__": (), "__getattribute__": read})
    made = watched.__new__(watched)
    for name in names:
        value = getattr(parameters, name)
        of_group = _watched(value, used, f"{prefix}{name}.") if _is_group(value) else value
        # The records are frozen.
        object.__setattr__(made, name, of_group)
    if hasattr(made, "__post_init__"):
        made.__post_init__()
    return made


def _is_group(value: Any) -> bool:
    return is_dataclass(value) or isinstance(value, SimpleNamespace)
