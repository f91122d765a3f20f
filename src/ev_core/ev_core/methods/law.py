"""A law as functions, the values that they get, and the object that steps them in Python.

How it works: the first arguments of a law's function name what it needs (`GIVEN`), the others are
signals by their annotations. A `Law` holds the function and what belongs to it. For each object
`Given` makes the values of these names once, so that a step only adds the signals. Compiled code is
made of the same functions (`compiled.part_source`).
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from functools import cache, lru_cache, partial, wraps
from itertools import chain
from operator import attrgetter
from types import MappingProxyType, SimpleNamespace
from typing import Any, TypeVar, get_type_hints

from ev_core.methods.law_error import WrongResultError, named
from ev_core.parameters.declaration import entries, number_tree
from ev_core.parameters.record import entries_without_number, fill, names, numbers
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.arguments import refusal
from ev_msgs_py.compilable import FUNCTIONS
from ev_msgs_py.contract.frame import PLACES
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.refusal import shown, unknown_name

F = TypeVar("F", bound=Callable[..., Any])

# What the functions of a law may ask for by the names of their first arguments; the signals follow,
# each as an argument or several as one NamedTuple.
GIVEN = ("p", "car", "c", "s", "period")

# Fields of a law that other ones replace, by the switches that have to be on.
Options = Mapping[tuple[str, ...], Mapping[str, Any]]
# A number of the vehicle is a switch as well: it is on where it is not 0.
OF_VEHICLE = "vehicle."
# Those have words of their own for what is expected (`hooks`, `_wrong_state`).
_WORDED = ("parameters", "state", "needs", "writes", "requires", "in_real_time")


@dataclass(frozen=True, slots=True)
class NoParameters:
    """Nothing to choose."""


@dataclass(slots=True)
class NoState:
    """Nothing lasts between steps."""


@dataclass(frozen=True)
class Law:
    """A method as functions; its first arguments name what they need of

    - `p`: the numbers of the parameters, groups nested, a choice as its place among the choices,
      a switch as 0 or 1; its annotation is the parameter dataclass,
    - `car`: the numbers of the vehicle (`car.car_numbers`),
    - `c`: what `prepare(parameters, vehicle, period)` made, a named tuple of numbers, tuples of
      numbers and such,
    - `s`: the state, a declared record, to be changed in place; its annotation is the record,
    - `period`: the control period [s].

    `function` gives the answer of a role that answers. For a role that integrates it advances the
    state, and `outputs` then give what the role writes: one signal, or a tuple of them in the order
    of `writes`. `start` makes the initial state where it is not that of the declaration.
    `in_real_time` has defaults of others there, by ROLE.PARAMETER. `notes` gives texts about the
    run so far. `mirrored` claims that left and right are alike to it (`check.mirror`).

    `options` has fields that replace those of the law where switches among its parameters, or
    numbers of the vehicle, are on: so a switch can add signals that are read or written. `idle`
    names groups of parameters that do nothing; the option that uses them replaces it.
    """

    function: Callable[..., Any]
    parameters: type
    state: type = NoState
    outputs: Callable[..., Any] | None = None
    prepare: Callable[[Any, Vehicle, float], Any] | None = None
    start: Callable[..., Any] | None = None
    notes: Callable[..., tuple[str, ...]] | None = None
    load_files: Callable[[Any], Any] | None = None
    needs: tuple[Callable[[Any, Vehicle], str], ...] = ()
    requires: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    in_real_time: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    writes: tuple[type, ...] | None = None
    heavy: bool = False
    mirrored: bool = False
    options: Options = field(default_factory=lambda: MappingProxyType({}))
    idle: tuple[str, ...] = ()

    @property
    def is_compilable(self) -> bool:
        """True if its functions are marked as `compilable`."""
        return self.function in FUNCTIONS and (self.outputs is None or self.outputs in FUNCTIONS)

    @property
    def switches(self) -> tuple[str, ...]:
        """Names of what puts options on."""
        return tuple(dict.fromkeys(chain.from_iterable(self.options)))

    def switched_on(self, parameters: Any, vehicle: Vehicle) -> list[str]:
        """The switches that these parameters and this vehicle put on."""
        found: list[str] = []
        for name in self.switches:
            owner = vehicle if name.startswith(OF_VEHICLE) else parameters
            if attrgetter(name.removeprefix(OF_VEHICLE))(owner):
                found.append(name)
        return found

    def with_options(self, on: Collection[str]) -> Law:
        """The law with the options that take no other switches than these."""
        changes: dict[str, Any] = {}
        for switches, changed in self.options.items():
            if all(switch in on for switch in switches):
                changes |= changed
        return replace(self, **changes) if changes else self

    def names(self) -> list[str]:
        """One name for each number of the state."""
        return names(self.state())

    def __call__(self, parameters: Any, vehicle: Vehicle, period: float) -> LawObject:
        """A new object of the law, at rest."""
        return LawObject(self, parameters, vehicle, period)


def named_after(function: F, law: Callable[..., Any]) -> F:
    """A function made around a law, under the law's name, module and docstring.

    Users know the method by these.
    """
    for attribute in ("__module__", "__name__", "__qualname__", "__doc__"):
        setattr(function, attribute, getattr(law, attribute))
    return function


@cache
def given_names(function: Callable[..., Any]) -> tuple[str, ...]:
    """The names of `GIVEN` that a function asks for, in its order.

    TypeError unless they come first.
    """
    arguments = inspect.signature(function).parameters
    asked = tuple(arguments)
    count = sum(name in GIVEN for name in asked)
    for name in asked[:count]:
        if name in GIVEN:
            continue
        known = ", ".join(GIVEN)
        # A name without annotation is no signal, so most likely one of these in another spelling.
        if arguments[name].annotation is inspect.Parameter.empty:
            raise TypeError(
                f"{function.__name__}: {name} is not known, expected {known} and signals"
            )
        raise TypeError(
            f"{function.__name__}: {name} stands too early, {known} come before the signals"
        )
    return asked[:count]


@cache
def asked_for(function: Callable[..., Any]) -> tuple[type, ...]:
    """The types of the arguments that a function of a law has besides `GIVEN`.

    They are signals, and NamedTuples of signals.
    """
    hints = get_type_hints(function)
    names = [*inspect.signature(function).parameters]
    # Those of `GIVEN` come first.
    signals = names[len(given_names(function)) :]
    return tuple(hints.get(name, Any) for name in signals)


def signals_in(asked: type) -> tuple[type, ...]:
    """The signals that an argument of this type carries.

    That is itself, or those of the fields of a NamedTuple.
    """
    if asked in PLACES or asked is Instant or not hasattr(asked, "_fields"):
        return (asked,)
    return tuple(signal for each in get_type_hints(asked).values() for signal in signals_in(each))


def signals_read(function: Callable[..., Any]) -> tuple[type, ...]:
    """The signals that the function of a law reads, in the order of its arguments."""
    return tuple(signal for asked in asked_for(function) for signal in signals_in(asked))


def _record_of(asked: type, signals: Iterator[Any]) -> Any:
    """The next signal, or the NamedTuple that the next signals make up."""
    if signals_in(asked) == (asked,):
        return next(signals)
    return asked(*(_record_of(each, signals) for each in get_type_hints(asked).values()))


def with_single_signals(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of a law as one that takes each signal by itself."""
    asked = asked_for(function)
    given = len(given_names(function))
    if all(signals_in(each) == (each,) for each in asked):
        return function

    @wraps(function)
    def step(*arguments: Any) -> Any:
        signals = iter(arguments[given:])
        return function(*arguments[:given], *(_record_of(each, signals) for each in asked))

    return step


def declared_law(label: str, function: Callable[..., Any], how: Mapping[str, Any]) -> Law:
    """The law of a declaration.

    TypeError, in one line that begins with `label`, where it cannot be made. Parameters and state
    are what the annotations of `p` and `s` name, unless `how` has them, as for a function that
    another function makes.
    """
    known = tuple(each.name for each in fields(Law))[1:]
    for name in how:
        if name not in known:
            raise TypeError(f"{label}: {unknown_name('argument', name, known)}")
    hints = get_type_hints(function)
    for name, part, made in (("p", "parameters", "parameter(...)"), ("s", "state", "entry(...)")):
        if name in given_names(function) and name not in hints and part not in how:
            expected = f"the dataclass of its {part}, made of {made}"
            raise TypeError(f"{label}: {name} has no annotation, expected {expected}")
    annotated = {"parameters": hints.get("p", NoParameters), "state": hints.get("s", NoState)}
    law = Law(function, **{**annotated, **how})
    if wrong := _wrong_state(law.state) or _wrong_kind(how) or _wrong_arguments(law):
        raise TypeError(f"{label}: {wrong}")
    return law


def _wrong_kind(how: Mapping[str, Any]) -> str:
    """Name what a declaration gives of another kind than a law has; empty if there is none."""
    kinds = get_type_hints(Law)
    for name, given in how.items():
        if name in _WORDED:
            continue
        if wrong := refusal(name, given, kinds[name]):
            return wrong
    return ""


def _wrong_state(state: Any) -> str:
    """Name the mistake in the declaration of a state; empty if there is none."""
    if not isinstance(state, type) or not is_dataclass(state):
        return f"state={shown(state)} is refused, expected a class marked @dataclass(slots=True)"
    for each in fields(state):
        if each.default is each.default_factory is MISSING:
            name = f"{state.__name__}.{each.name}"
            return f"{name} has no start value, declare it by entry(0.0, unit=...)"
    for name, value in entries_without_number(state()):
        begins = f"{state.__name__}.{name} begins as {type(value).__name__}"
        return f"{begins}, expected a number: entry(0.0, unit=...)"
    return ""


def refuse_wrong_option(label: str, law: Law) -> None:
    """TypeError, in one line that begins with `label`, for switches that cannot have options."""
    declared = {each.name: each for each in entries(law.parameters)}
    for name in sorted(law.switches):
        if name.startswith(OF_VEHICLE):
            continue  # numbers of the vehicle never change in a run
        switch = declared.get(name)
        if switch is None or switch.type is not bool or switch.is_array:
            expected = f"a switch of {law.parameters.__name__}"
            raise TypeError(f"{label}: options= asks for {name}, expected {expected}")
        # A node subscribes and publishes once, when it starts: another signal would never come.
        if not switch.spec.read_only:
            raise TypeError(
                f"{label}: options= asks for {name}, which may change in a run, "
                "declare it read_only=True"
            )


def _wrong_arguments(law: Law) -> str:
    """Name the mistake in the arguments of the functions of a law; empty if there is none."""
    if not isinstance(law.needs, tuple | list):
        return "needs= is no tuple, write needs=(...,)"
    asked = inspect.signature(law.function).parameters
    if "c" in asked and not law.prepare:
        return "c is asked for and not made, declare prepare="
    for hook in filter(None, (law.outputs, law.notes, law.start)):
        # `start` makes the state, so it cannot ask for one.
        given = [name for name in GIVEN if name != "s" or hook is not law.start]
        for each in inspect.signature(hook).parameters.values():
            if each.name not in given and each.default is each.empty:
                expected = ", ".join(given)
                return f"{named(hook)} asks for {each.name}, expected are only {expected}"
    for each in asked.values():
        if each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD):
            return f"{each.name} stands for any number of arguments, name each signal"
    return ""


class Given:
    """Values for the functions of one object of a law, as plain Python takes them."""

    def __init__(self, law: Law, parameters: Any, vehicle: Vehicle, period: float) -> None:
        car_tree, car = _car(vehicle)
        self.trees = {"p": number_tree(parameters), "car": car_tree}
        self.values: dict[str, Any] = {
            "p": namespace(self.trees["p"]),
            "car": car,
            "period": period,
            "c": law.prepare(parameters, vehicle, period) if law.prepare else None,
        }
        # The last one, for `start` may ask for all others.
        self.values["s"] = self.bound(law.start)() if law.start else law.state()
        if law.start and not isinstance(self.values["s"], law.state):
            raise WrongResultError(law.start, self.values["s"], f"{law.state.__name__}(...)")

    def bound(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function with what it asks for; the signals are still to be given."""
        return partial(function, *(self.values[name] for name in given_names(function)))


@lru_cache(maxsize=16)
def _car(vehicle: Vehicle) -> tuple[dict[str, Any], SimpleNamespace]:
    """The numbers of a vehicle, as a tree and as laws read them.

    They are made once for all objects, which only read them.
    """
    tree = car_numbers(vehicle)
    return tree, namespace(tree)


def namespace(tree: Mapping[str, Any]) -> SimpleNamespace:
    """A tree of numbers with branches as attributes."""
    made = SimpleNamespace()
    for name, value in tree.items():
        setattr(made, name, namespace(value) if isinstance(value, Mapping) else value)
    return made


class LawObject:
    """Steps a law in plain Python.

    A role that answers has `step`, one that integrates `advance` and `outputs`.
    """

    def __init__(self, law: Law, parameters: Any, vehicle: Vehicle, period: float) -> None:
        given = Given(law, parameters, vehicle, period)
        self.given = given.values
        self._record = given.values["s"]
        self.step = self.advance = given.bound(with_single_signals(law.function))
        if law.outputs is not None:
            self._outputs = given.bound(law.outputs)
            self._single = law.writes is None or len(law.writes) == 1
        if law.notes is not None:
            self.reports = given.bound(law.notes)

    def outputs(self) -> tuple[Any, ...]:
        """Everything that it writes, at the instant of its state."""
        return (self._outputs(),) if self._single else self._outputs()

    @property
    def state(self) -> list[float]:
        """All that lasts between steps, as one row of numbers.

        It may be set to that of another object of the law.
        """
        return numbers(self._record)

    @state.setter
    def state(self, row: list[float]) -> None:
        fill(self._record, row)
