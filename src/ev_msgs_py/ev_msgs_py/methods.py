"""The register of methods: every law, plant, column and driver, by role and name."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from typing import Any

from ev_msgs_py.parameters import unknown_name
from ev_msgs_py.roles import INTEGRATED, MASTER, ROLES, RoleKind
from ev_msgs_py.signals import Instant

_REGISTER: dict[str, dict[str, Method]] = {}


@dataclass(frozen=True, slots=True)
class Method:
    """One way to play a role: the class, the signals that its step reads, and its parameter dataclass."""

    role: str
    name: str
    factory: type
    reads: tuple[type, ...]
    parameters: type

    @property
    def inputs(self) -> tuple[type, ...]:
        """The signals that a step waits for: those it reads, and what else the node has to hear.

        The master hears everybody else who integrates, so that it leaves nobody behind. The others hear the master
        or, if they answer at once, somebody who does so before them: that is how they learn of a new run.
        """
        topics = tuple(signal for signal in self.reads if signal is not Instant)
        role, masters = ROLES[self.role], ROLES[MASTER].writes
        if self.role == MASTER:
            return (*topics, *(signal for signal in role.reads if signal in INTEGRATED and signal not in topics))
        answers = role.kind is RoleKind.ANSWERS
        heralds = [signal for signal in role.reads if signal in masters or (answers and signal not in INTEGRATED)]
        return topics if any(signal in heralds for signal in topics) else (*topics, heralds[0])

    @property
    def writes(self) -> tuple[type, ...]:
        """The signals it writes: those of its role, or the part of them that it can know."""
        return getattr(self.factory, "writes", ROLES[self.role].writes)

    @property
    def requires(self) -> dict[str, str]:
        """By role the method without which this one makes no sense."""
        return getattr(self.factory, "requires", {})

    @property
    def about(self) -> str:
        """First line of the docstring."""
        return (inspect.getdoc(self.factory) or "").partition("\n")[0]


def method(role: str, name: str) -> Callable[[type], type]:
    """Register a class as a method of a role.

    The class has `parameters` (a parameter dataclass), `__init__(parameters, vehicle, period)` and, by the kind of
    its role, `step(...)` (answers at once) or `outputs()` and `advance(...)` (integrates). The annotations of `step`
    or `advance` name the signals it reads; TypeError if its role may not read one of them. All that lasts between
    steps is in its attribute `state`. An object that integrates may have a `row`, a float64 array, always the same,
    with the numbers of its outputs in the order of their channels and as its messages carry them: the offline runner
    then makes only those signals of it that somebody reads. The class may say `writes` (the part of its role's signals
    that it can know) and `requires` (by role the method without which it makes no sense).
    """

    def register(factory: type) -> type:
        function = factory.advance if ROLES[role].kind is RoleKind.INTEGRATES else factory.step  # type: ignore
        hints = typing.get_type_hints(function)
        hints.pop("return", None)
        reads = tuple(hints.values())
        for signal in reads:
            if not ROLES[role].may_read(signal):
                raise TypeError(f"{role} method {name}: a {role} does not read {signal.__name__} (see roles.py)")
        _REGISTER.setdefault(role, {})[name] = Method(role, name, factory, reads, factory.parameters)  # type: ignore
        return factory

    return register


@cache
def _load_installed_methods(role: str) -> None:
    """Import what installed packages offer for a role: entry points of this name in the group ev_stack.methods.

    Only those of the role, because a plant takes longer to import than a node to start.
    """
    for entry_point in entry_points(group="ev_stack.methods", name=role):
        entry_point.load()


def methods_of(role: str) -> dict[str, Method]:
    """All methods of a role, by name."""
    _load_installed_methods(role)
    return dict(sorted(_REGISTER.get(role, {}).items()))


def find_method(role: str, name: str) -> Method:
    """The method of a role with this name; ParameterError that lists the known ones if there is none."""
    known = methods_of(role)
    if not isinstance(name, str) or name not in known:
        raise unknown_name(f"{role} method", name, known)
    return known[name]


def all_methods() -> dict[str, dict[str, Method]]:
    """All methods of all roles."""
    return {role: methods_of(role) for role in ROLES}


def create(method: Method, parameters: Any, vehicle: Any, period: float) -> Any:
    """A new object of a method, at rest."""
    return method.factory(parameters, vehicle, period)
