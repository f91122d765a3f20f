"""Protocols of a class that is a method: one per kind of role, and optional ones.

A class satisfies them by having what they name; it need not inherit from anything.
`check.method.check_method` holds it against the docstrings. Its objects are made by
`factory(parameters, vehicle, period)`, and are at rest then: `parameters` are an instance of its
parameter dataclass, `vehicle` is the `Vehicle` and `period` the control period [s]. An object knows
nothing else: no clock, no random numbers but seeded ones with their generator in the state, no
other object. Its `state` is all that lasts between steps: None, or a row of numbers, which can be
set to that of another one.

The class itself has `parameters`, the parameter dataclass, and may have

- `writes`, the part of its role's signals that it can know; without it all,
- `requires`, by role the method, or by ROLE.PARAMETER its value, without which it makes no sense;
  `SAME` is the value of its own parameter of that name,
- `needs`, what the vehicle must have (`vehicle.car.Need`),
- `mirrored`, whether left and right are alike to it: `check.mirror` defines it.
"""

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from ev_core.parameters.declaration import entries
from ev_msgs_py.contract.roles import ROLES, Role, RoleKind
from ev_msgs_py.refusal import shown

SAME = "the same"  # in `requires`


@runtime_checkable
class Answering(Protocol):
    """Plays a role that answers at once."""

    def step(self, *signals: Any, **_by_name: Any) -> Any:
        """The signal that the role writes, from the signals of the same instant.

        Several come as a tuple, in the order of `writes`. The annotations of the arguments name the
        signals that are read. They are finite. The answer is finite as well, or the step is
        refused: by SignalError if a number is not, or by a ValueError of the law.
        """


@runtime_checkable
class Integrating(Protocol):
    """Plays a role that integrates from instant to instant."""

    def outputs(self) -> tuple[Any, ...]:
        """The signals of the role at the instant of the state, in the order of its `writes`.

        It changes nothing.
        """

    def advance(self, *signals: Any, **_by_name: Any) -> None:
        """Go on to the next instant by the signals of this one.

        Arguments and refusals are those of `step`.
        """


@runtime_checkable
class Reporting(Protocol):
    """An optional hook: gives what is worth knowing about the run."""

    def reports(self) -> tuple[str, ...]:
        """All texts up to now, each once and in the order in which it came up.

        They are shown to the user.
        """


@runtime_checkable
class ReadingFiles(Protocol):
    """May be offered besides, by the class itself: parameters that name files."""

    @staticmethod
    def load_files(parameters: Any) -> Any:
        """The parameters with what their files hold; ParameterError if one cannot be read."""


_HOOKS = {RoleKind.ANSWERS: Answering, RoleKind.INTEGRATES: Integrating}


def refuse_lacking(role: str, name: str, defined: type) -> None:
    """TypeError, in one line, if a class lacks what a method of this role has."""
    protocol = _HOOKS[ROLES[role].kind]
    lacking: list[str] = []
    if not isinstance(getattr(defined, "parameters", None), type):
        lacking.append("parameters")
    for hook in vars(protocol):
        # What begins with _ belongs to every Protocol.
        if not hook.startswith("_") and not callable(getattr(defined, hook, None)):
            lacking.append(hook)
    if lacking:
        raise TypeError(
            f"{role} method {name}: class {defined.__name__} lacks {' and '.join(lacking)} "
            f"(see {protocol.__name__} in methods/hooks.py)"
        )


def refuse_wrong_declaration(label: str, role: Role, factory: Any) -> None:
    """Refuse a wrong declaration beside the functions.

    The line of the TypeError begins with `label`.
    """
    writes = getattr(factory, "writes", None)
    may_write = ", ".join(each.__name__ for each in role.may_write)
    if writes is not None and (not isinstance(writes, tuple) or not writes):
        expected = f"a tuple of {may_write}: writes=(A,)"
        raise TypeError(f"{label}: writes={shown(writes)} is refused, expected {expected}")
    for signal in writes or ():
        if signal not in role.may_write:
            asked = getattr(signal, "__name__", shown(signal))
            expected = f"{may_write} (see roles.py)"
            raise TypeError(f"{label}: a {role.name} does not write {asked}, expected {expected}")
    for name in ("requires", "in_real_time"):
        given = getattr(factory, name, {})
        if not isinstance(given, Mapping):
            raise TypeError(
                f"{label}: {name}={shown(given)} is refused, expected a mapping by role"
            )
    for entry in entries(factory.parameters):
        group, _, last = entry.name.rpartition(".")
        # A `seed` of a group follows from that of the node (`sensors.random_numbers.seeded`).
        if group and last == "seed" and (entry.type is not int or entry.is_array):
            expected = "int: --seed makes another one of it"
            raise TypeError(f"{label}: {entry.name} is no whole number, expected {expected}")
