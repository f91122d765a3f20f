"""The record of one method.

It has the role, the law or class, and what follows from them.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ev_core.methods.law import Law, signals_read
from ev_core.methods.law_error import in_law
from ev_core.vehicle.car import refusal
from ev_msgs_py.contract.roles import EXTRA, INTEGRATED, MASTER, ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.refusal import ParameterError

RECORDINGS = ".npz"  # suffix of recorded signals that play a role


@dataclass(frozen=True, slots=True)
class Method:
    """One way to play a role.

    It has a class or law, the signals that a step reads, and a parameter dataclass.
    """

    role: str
    name: str
    factory: Any
    reads: tuple[type, ...]
    parameters: type
    declared: Method | None = None
    """The method without its options, where a configuration has put some of them on."""

    def with_options(self, parameters: Any, vehicle: Any) -> Method:
        """The method with the options of its law that parameters and vehicle put on."""
        law = (self.declared or self).law
        return self.with_switches_on(law.switched_on(parameters, vehicle) if law else ())

    def with_switches_on(self, switches: Iterable[str]) -> Method:
        """The method with the options of its law that take no other switches."""
        declared = self.declared or self
        if declared.law is None or not declared.law.options:
            return declared
        law = declared.law.with_options({*switches})
        if law is declared.law:
            return declared
        return replace(declared, factory=law, reads=signals_read(law.function), declared=declared)

    @property
    def inputs(self) -> tuple[type, ...]:
        """The signals that a step waits for.

        They are those it reads, and others that the node has to receive. The master reads every
        other role that integrates, so that it leaves none behind; an optional role only where the
        method reads it, for it may not be played. The others read the master or, if they answer at
        once, a role that answers before them: from these they learn of a new run.
        """
        topics = tuple(signal for signal in self.reads if signal is not Instant)
        role = ROLES[self.role]
        if self.role == MASTER:
            others: list[type] = []
            for signal in role.reads:
                if signal in INTEGRATED and signal not in EXTRA and signal not in topics:
                    others.append(signal)
            return (*topics, *others)
        # Signals that show a new run: of the master, or of a role that answers before this one.
        heralds = [signal for signal in role.reads if signal in ROLES[MASTER].writes]
        if role.kind is RoleKind.ANSWERS:
            heralds = [s for s in role.reads if s in heralds or s not in INTEGRATED]
        if any(signal in heralds for signal in topics):
            return topics
        return (*topics, heralds[0])

    @property
    def writes(self) -> tuple[type, ...]:
        """The signals it writes: those of its role, or the part of them that it can know."""
        known: tuple[type, ...] | None = getattr(self.factory, "writes", None)
        return ROLES[self.role].writes if known is None else known

    @property
    def switches(self) -> tuple[str, ...]:
        """Names of the parameters that put options of its law on, among them the vehicle's."""
        return self.law.switches if self.law else ()

    def is_idle(self, name: str) -> bool:
        """True for a parameter that does nothing without another option."""
        groups = self.law.idle if self.law else ()
        return any(name.startswith(f"{group}.") for group in groups)

    @property
    def requires(self) -> dict[str, Any]:
        """Methods by role, or values by ROLE.PARAMETER, without which this one makes no sense."""
        return getattr(self.factory, "requires", {})

    @property
    def in_real_time(self) -> Mapping[str, str]:
        """Values by ROLE.PARAMETER that are the defaults where the wall clock drives the graph."""
        return self.law.in_real_time if self.law else {}

    @property
    def mirrored(self) -> bool:
        """True if it claims that left and right are alike to it."""
        return getattr(self.factory, "mirrored", False)

    @property
    def law(self) -> Law | None:
        """The functions that it consists of; None if it is a class."""
        return self.factory if isinstance(self.factory, Law) else None

    @property
    def documented(self) -> Any:
        """The object with its docstring: the law's function or the class."""
        return self.factory if self.law is None else self.law.function

    @property
    def plays_back(self) -> bool:
        """True if its outputs are recorded ones, of any method."""
        return isinstance(self.name, str) and self.name.endswith(RECORDINGS)

    @property
    def place(self) -> tuple[str, str]:
        """The module that defines it, and its name there."""
        return self.documented.__module__, self.documented.__qualname__

    @property
    def text_place(self) -> tuple[str, str]:
        """Its place by the file of its module.

        The module has another name where it runs as a program.
        """
        return getattr(sys.modules.get(self.place[0]), "__file__", self.place[0]), self.place[1]

    @property
    def package(self) -> str:
        """The package that brings it."""
        return str(self.documented.__module__).partition(".")[0]

    @property
    def about(self) -> str:
        """First line of the docstring."""
        return (inspect.getdoc(self.documented) or "").partition("\n")[0]


def create(method: Method, parameters: Any, vehicle: Any, period: float) -> Any:
    """A new object of a method, at rest."""
    with in_law(method):
        return method.factory(parameters, vehicle, period)


def refuse_layout(method: Method, parameters: Any, vehicle: Any) -> None:
    """ParameterError if the vehicle lacks what a method with these parameters needs."""
    with in_law(method):
        text = refusal(
            method.role, method.name, getattr(method.factory, "needs", ()), parameters, vehicle
        )
    if text:
        raise ParameterError(text)
