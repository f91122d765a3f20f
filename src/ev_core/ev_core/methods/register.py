"""The register of methods: laws, plants, columns and drivers, by role and name.

How it works: a module registers its methods when it is imported, by the decorator `method`.
Packages offer modules by entry points of the name of a role, and these are imported when the
methods of the role are asked for: only these, because a plant takes longer to import than a node to
start. A law file of the user's registers in the same way, but into a register that only the caller
of `registered_by` sees.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any, TypeVar, get_type_hints

from ev_core.methods.common_parameters import refuse_taken
from ev_core.methods.hooks import refuse_lacking, refuse_wrong_declaration
from ev_core.methods.law import Law, declared_law, given_names, refuse_wrong_option, signals_in
from ev_core.methods.method_record import Method
from ev_core.parameters.data_file import entry_points
from ev_core.parameters.values import refuse_undeclared
from ev_msgs_py.arguments import checked
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.refusal import ParameterError, quoted

T = TypeVar("T")

NODES = "ev_stack.nodes"  # of entry points, named after their roles
_GROUP = "ev_stack.methods"
_REGISTER: dict[str, dict[str, Method]] = {}
_is_private = False  # while a file of the user's registers methods that only its caller sees


@cache
def load_installed_methods(role: str) -> tuple[str, ...]:
    """Import the modules that are offered for a role.

    One line for each that fails, which must not stop the others.
    """
    failed = []
    for entry_point in entry_points(group=_GROUP, name=role):
        try:
            entry_point.load()
        except Exception as error:  # a user's module may raise any error
            failed.append(
                f"{entry_point.value}: {type(error).__name__}: {' '.join(str(error).split())}"
            )
    return tuple(failed)


def not_loaded() -> tuple[str, ...]:
    """One line for each offered module that is not available.

    It fails, or is offered for no role.
    """
    lines: list[str] = []
    for point in entry_points(group=_GROUP):
        if point.name not in ROLES:
            lines.append(
                f"{point.value}: offered for {quoted(point.name)}, which is no role: "
                f"{', '.join(ROLES)}"
            )
    for role in ROLES:
        lines += load_installed_methods(role)
    return tuple(lines)


@checked
def method(role: str, name: str, **how: Any) -> Callable[[T], T]:
    """Register a class or a function as a method of a role.

    A class has the hooks of `methods.hooks`: by the kind of its role those of `Answering` or
    `Integrating`, and what it declares and offers besides. A function is the law itself; the
    annotations of `p` and `s` name its parameter dataclass and its state, and `how` has what else
    belongs to a `methods.law.Law`.

    The annotations of `step`, `advance` or the function name the signals that are read; TypeError
    if there is no such role, if it may not read one of them, if a hook is missing, if another
    method has its name, or if a parameter has the name of one of every node.

    >>> from ev_core.law import NO_WHEELS, DriverCommand, Wheels, WheelTorqueRequest, method
    >>> @method("electronic_differential", "front_halves")
    ... def front_halves(driver: DriverCommand) -> WheelTorqueRequest:
    ...     '''Give each front wheel half of the drive torque, and no wheel a brake.'''
    ...     half = 0.5 * driver.drive_torque
    ...     return WheelTorqueRequest(Wheels(half, half, 0.0, 0.0), NO_WHEELS)
    """
    if role not in ROLES:
        raise TypeError(
            f"method {name}: {quoted(role)} is no role, expected one of {', '.join(ROLES)}"
        )

    def register(defined: T) -> T:
        factory: Any = defined
        label = f"{role} method {name}"
        if not callable(defined):
            raise TypeError(
                f"{label}: {quoted(defined)} is refused, expected a function or a class"
            )
        is_law = not isinstance(defined, type)
        if is_law:
            factory = declared_law(label, factory, how)
            if factory.outputs is None and ROLES[role].kind is RoleKind.INTEGRATES:
                raise TypeError(f"{label}: a {role} integrates, so its law needs outputs=")
        else:
            refuse_lacking(role, name, factory)
        refuse_undeclared(label, factory.parameters)
        reads = _reads(label, role, factory)
        # An option may bring other signals, which the role has to have as well.
        if is_law:
            refuse_wrong_option(label, factory)
            for changed in factory.options.values():
                _reads(label, role, replace(factory, **changed))
        try:
            refuse_taken(label, factory.parameters)
        except ParameterError as error:
            raise TypeError(str(error)) from None
        # A name of an installed method is refused, whether that is loaded by now or not.
        if not _is_private and defined.__module__.partition(".")[0] not in _packages(role):
            load_installed_methods(role)
        _put(Method(role, name, factory, reads, factory.parameters))
        return defined

    return register


def _reads(label: str, role: str, factory: Any) -> tuple[Any, ...]:
    """The signals that a law or class reads.

    TypeError for a wrong declaration of what it reads or writes.
    """
    refuse_wrong_declaration(label, ROLES[role], factory)
    is_law = isinstance(factory, Law)
    hook = "advance" if ROLES[role].kind is RoleKind.INTEGRATES else "step"
    function = factory.function if is_law else getattr(factory, hook)
    hints = get_type_hints(function)
    given = given_names(function) if is_law else ("self",)
    arguments = [name for name in inspect.signature(function).parameters if name not in given]
    if bare := [name for name in arguments if name not in hints]:
        raise TypeError(f"{label}: argument {bare[0]} has no annotation that names its signal")
    reads: tuple[Any, ...] = ()
    for argument in arguments:
        reads += signals_in(hints[argument]) if is_law else (hints[argument],)
    for signal in reads:
        if signal is not Instant and signal not in ROLES[role].reads:
            asked = getattr(signal, "__name__", signal)
            raise TypeError(f"{label}: a {role} does not read {asked} (see roles.py)")
    return reads


@cache
def _packages(role: str) -> frozenset[str]:
    """Those that offer methods of a role."""
    return frozenset(
        point.value.partition(".")[0] for point in entry_points(group=_GROUP, name=role)
    )


def _put(method: Method) -> None:
    """Register a method; TypeError if another one has its name.

    The same one may be edited and run again.
    """
    of_role = _REGISTER.setdefault(method.role, {})
    known = of_role.get(method.name)
    if known is not None and known.place != method.place and known.text_place != method.text_place:
        there = ".".join(known.place)
        here = ".".join(method.place)
        raise TypeError(
            f"{method.role} method {method.name} is there already, {there}: "
            f"take another name for {here}"
        )
    of_role[method.name] = method


def registered_by(module: str, run: Callable[[], None]) -> dict[str, dict[str, Method]]:
    """Methods that `run` registers from this module, private to the caller.

    The keys are role and name.
    """
    global _REGISTER, _is_private
    kept = _REGISTER
    _REGISTER = {}
    _is_private = True
    try:
        run()
    finally:
        made = _REGISTER
        _REGISTER = kept
        _is_private = False
        # The file may have imported modules on the way: their methods are there for all.
        for methods in made.values():
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
