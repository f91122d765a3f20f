"""The register of methods: every law, plant, column and driver, by role and name, also of installed packages.

With it stand the parameters that every node has besides those of its method.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar, get_type_hints

from ev_core.faults.fault import FaultParameters
from ev_core.methods.hooks import refuse_lacking, refuse_wrong_declaration
from ev_core.methods.law import Law, declared_law, given_names, signals_in
from ev_core.methods.law_error import in_law
from ev_core.parameters.data_file import entry_points
from ev_core.parameters.declaration import entries, group, setting
from ev_core.parameters.values import entries_by_name, refuse_undeclared
from ev_core.vehicle.car import refusal
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import EXTRA, INTEGRATED, MASTER, ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.refusal import ParameterError, quoted


@dataclass(frozen=True, slots=True)
class CommonParameters:
    """Parameters that every node of the graph has."""

    control_period: float = setting(
        0.01, unit="s", low=1e-4, high=1.0, about="step of the graph, the same for all nodes", read_only=True
    )
    mode: str = setting(
        "lockstep",
        choices=("lockstep", "realtime"),
        about="lockstep: a step when all inputs are there; realtime: a step when the wall clock says so",
        read_only=True,
    )
    seed: int = setting(0, low=0, high=2**31 - 1, about="seed of everything random in the node", read_only=True)
    scheduling_priority: int = setting(
        0, low=0, high=99, about="SCHED_FIFO for all threads of the process; 0: not asked for", read_only=True
    )
    lock_memory: bool = setting(False, about="keep the memory of the node's process from being paged", read_only=True)
    vehicle: Vehicle = group(Vehicle)


_GROUP = "ev_stack.methods"


@cache
def load_installed_methods(role: str) -> tuple[str, ...]:
    """Import what is offered for a role, and say in one line each what cannot be: it must not keep others from running.

    Only those of the role, because a plant takes longer to import than a node to start.
    """
    failed = []
    for entry_point in entry_points(group=_GROUP, name=role):
        try:
            entry_point.load()
        except Exception as error:  # whatever somebody's module raises
            failed.append(f"{entry_point.value}: {type(error).__name__}: {' '.join(str(error).split())}")
    return tuple(failed)


def not_loaded() -> tuple[str, ...]:
    """Everything that is offered and cannot be had, one line each: what fails, and what is offered for no role."""
    nobody = [point for point in entry_points(group=_GROUP) if point.name not in ROLES]
    lines = [
        f"{point.value}: offered for {quoted(point.name)}, which is no role: {', '.join(ROLES)}" for point in nobody
    ]
    return (*lines, *(line for role in ROLES for line in load_installed_methods(role)))


T = TypeVar("T")

NODES = "ev_stack.nodes"  # of entry points, named after their roles
SENSORS = "sensors"  # the group of a node's sensors
OF_ROS = ("use_sim_time", "start_type_description_service", "qos_overrides")  # parameters and groups of ROS itself
(FAULTS,) = entries(FaultParameters)
RECORDINGS = ".npz"  # what the path of recorded signals ends with
_REGISTER: dict[str, dict[str, Method]] = {}
_is_for_one = False  # while a file is run whose methods only the one knows who has asked for them


@dataclass(frozen=True, slots=True)
class Method:
    """One way to play a role: the class, the signals that its step reads, and its parameter dataclass."""

    role: str
    name: str
    factory: Any
    reads: tuple[type, ...]
    parameters: type

    @property
    def inputs(self) -> tuple[type, ...]:
        """The signals that a step waits for: those it reads, and others that the node has to receive.

        The master reads every other role that integrates, so that it leaves none behind; of optional roles it reads
        something where they are played, or nobody plays them. The others read the master
        or, if they answer at once, somebody who does so before them: that is how they learn of a new run.
        """
        topics = tuple(signal for signal in self.reads if signal is not Instant)
        role, masters = ROLES[self.role], ROLES[MASTER].writes
        if self.role == MASTER:
            others = (s for s in role.reads if s in INTEGRATED and s not in EXTRA)
            return (*topics, *(signal for signal in others if signal not in topics))
        answers = role.kind is RoleKind.ANSWERS
        heralds = [signal for signal in role.reads if signal in masters or (answers and signal not in INTEGRATED)]
        return topics if any(signal in heralds for signal in topics) else (*topics, heralds[0])

    @property
    def writes(self) -> tuple[type, ...]:
        """The signals it writes: those of its role, or the part of them that it can know."""
        known: tuple[type, ...] | None = getattr(self.factory, "writes", None)
        return ROLES[self.role].writes if known is None else known

    @property
    def requires(self) -> dict[str, str]:
        """By role the method, or by ROLE.PARAMETER its value, without which this one makes no sense."""
        return getattr(self.factory, "requires", {})

    @property
    def in_real_time(self) -> Mapping[str, str]:
        """By ROLE.PARAMETER the value that it has by default where the wall clock drives the graph."""
        return self.law.in_real_time if self.law else {}

    @property
    def mirrored(self) -> bool:
        """Whether it claims that left and right are alike to it."""
        return getattr(self.factory, "mirrored", False)

    @property
    def law(self) -> Law | None:
        """The functions that it consists of; None if it is a class."""
        return self.factory if isinstance(self.factory, Law) else None

    @property
    def documented(self) -> Any:
        """What carries its docstring."""
        return self.factory if self.law is None else self.law.function

    @property
    def plays_back(self) -> bool:
        """Whether its outputs are recorded ones, of any method."""
        return isinstance(self.name, str) and self.name.endswith(RECORDINGS)

    @property
    def place(self) -> tuple[str, str]:
        """The module that defines it, and its name there."""
        return self.documented.__module__, self.documented.__qualname__

    @property
    def text_place(self) -> tuple[str, str]:
        """The same by the file of the module, which is another module where it runs as a program."""
        return getattr(sys.modules.get(self.place[0]), "__file__", self.place[0]), self.place[1]

    @property
    def package(self) -> str:
        """The package that brings it."""
        return str(self.documented.__module__).partition(".")[0]

    @property
    def about(self) -> str:
        """First line of the docstring."""
        return (inspect.getdoc(self.documented) or "").partition("\n")[0]


def method(role: str, name: str, **how: Any) -> Callable[[T], T]:
    """Register a class or a function as a method of a role.

    A class has the hooks of `methods.hooks`: by the kind of its role those of `Answering` or `Integrating`, and what it
    declares and offers besides. A function is the law itself; the annotations of `p` and `s` name its parameter
    dataclass and its state, and `how` has what else belongs to a `methods.law.Law`.

    The annotations of `step`, `advance` or the function name the signals that are read; TypeError if there is no such
    role, if it may not read one of them, if a hook is missing, if another method has its name, or if a parameter has
    the name of one of every node.
    """
    if role not in ROLES:
        raise TypeError(f"method {name}: {quoted(role)} is no role, expected one of {', '.join(ROLES)}")

    def register(defined: T) -> T:
        factory: Any = defined
        who = f"{role} method {name}"
        is_law = not isinstance(defined, type)
        if is_law:
            factory = declared_law(who, factory, how)
            if factory.outputs is None and ROLES[role].kind is RoleKind.INTEGRATES:
                raise TypeError(f"{who}: a {role} integrates, so its law needs outputs=")
        else:
            refuse_lacking(role, name, factory)
        refuse_undeclared(who, factory.parameters)
        refuse_wrong_declaration(who, ROLES[role], factory)
        hook = "advance" if ROLES[role].kind is RoleKind.INTEGRATES else "step"
        function = factory.function if isinstance(factory, Law) else getattr(factory, hook)
        hints = get_type_hints(function)
        given = given_names(function) if is_law else ("self",)
        arguments = [name for name in inspect.signature(function).parameters if name not in given]
        if bare := [name for name in arguments if name not in hints]:
            raise TypeError(f"{who}: argument {bare[0]} has no annotation that names its signal")
        reads: tuple[Any, ...] = ()
        for argument in arguments:
            reads += signals_in(hints[argument]) if is_law else (hints[argument],)
        for signal in reads:
            if signal is not Instant and signal not in ROLES[role].reads:
                asked = getattr(signal, "__name__", signal)
                raise TypeError(f"{who}: a {role} does not read {asked} (see roles.py)")
        try:
            refuse_taken(who, factory.parameters)
        except ParameterError as error:
            raise TypeError(str(error)) from None
        if not _is_for_one and defined.__module__.partition(".")[0] not in _packages(role):
            load_installed_methods(role)  # theirs are refused whether they are known by now or not
        _put(Method(role, name, factory, reads, factory.parameters))
        return defined

    return register


@cache
def _packages(role: str) -> frozenset[str]:
    """Those that offer methods of a role."""
    return frozenset(point.value.partition(".")[0] for point in entry_points(group=_GROUP, name=role))


def _put(method: Method) -> None:
    """Register a method; TypeError if another one has its name, unless that is the same one, edited and run again."""
    of_role = _REGISTER.setdefault(method.role, {})
    known = of_role.get(method.name)
    if known is not None and known.place != method.place and known.text_place != method.text_place:
        raise TypeError(
            f"{method.role} method {method.name} is there already, {'.'.join(known.place)}: take another name for "
            f"{'.'.join(method.place)}"
        )
    of_role[method.name] = method


def refuse_taken(who: str, parameters: type, taken: Iterable[str] = ()) -> None:
    """ParameterError if a parameter has the name of one that every node has, or one of `taken`: it would not get there.

    Only a method whose `faults` are those of every node may ask for them itself.
    """
    own = entries_by_name(parameters)
    of_nodes = entries_by_name(CommonParameters)
    groups = {"method", SENSORS, *OF_ROS, *(name.partition(".")[0] for name in of_nodes)}
    for name, entry in own.items():
        is_fault = name == FAULTS.name and entry != FAULTS
        if name.partition(".")[0] in groups or name in taken or is_fault:
            raise ParameterError(f"{who}: parameter {name} is refused: every node has one of this name, take another")


def registered_by(module: str, run: Callable[[], None]) -> dict[str, dict[str, Method]]:
    """By role and name the methods of a module that something registers; only who has asked for them knows them."""
    global _REGISTER, _is_for_one
    kept, _REGISTER, _is_for_one = _REGISTER, {}, True
    try:
        run()
    finally:
        made, _REGISTER, _is_for_one = _REGISTER, kept, False
        for methods in made.values():  # what was imported on the way is there for all
            others = [each for each in methods.values() if each.place[0] != module]
            for each in others:
                del methods[each.name]
                _put(each)
    return made


@cache
def node_package(role: str) -> str:
    """The package with the node of a role; LookupError unless there is exactly one."""
    found = {point.value.partition(".")[0] for point in entry_points(group=NODES, name=role)}
    if len(found) != 1:
        raise LookupError(f"one package is wanted with a node for {role}, found: {sorted(found)}")
    return found.pop()


def methods_of(role: str) -> dict[str, Method]:
    """All methods of a role, by name."""
    load_installed_methods(role)
    return dict(sorted(_REGISTER.get(role, {}).items()))


def all_methods() -> dict[str, dict[str, Method]]:
    """All methods of all roles."""
    return {role: methods_of(role) for role in ROLES}


def create(method: Method, parameters: Any, vehicle: Any, period: float) -> Any:
    """A new object of a method, at rest."""
    with in_law(method):
        return method.factory(parameters, vehicle, period)


def refuse_layout(method: Method, parameters: Any, vehicle: Any) -> None:
    """ParameterError if the vehicle lacks what a method with these parameters needs."""
    with in_law(method):
        text = refusal(method.role, method.name, getattr(method.factory, "needs", ()), parameters, vehicle)
    if text:
        raise ParameterError(text)
