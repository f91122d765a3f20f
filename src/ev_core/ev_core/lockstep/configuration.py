"""The parameters of a node, resolved the same way for the node and for the offline runner."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from ev_core.faults.fault import FaultParameters
from ev_core.faults.row import refuse_faults
from ev_core.lockstep.finding import find_method, text_of
from ev_core.methods.common_parameters import CommonParameters, refuse_taken
from ev_core.methods.former_names import with_present_name
from ev_core.methods.hooks import ReadingFiles
from ev_core.methods.law_error import WrongResultError, in_law
from ev_core.methods.method_record import Method, create, refuse_layout
from ev_core.methods.register import methods_of
from ev_core.parameters.declaration import Entry, Spec, defaults, entries, flatten
from ev_core.parameters.values import entries_by_name, replaced
from ev_core.sensors.random_numbers import seeded
from ev_core.sensors.row import sensors_for
from ev_core.vehicle.files import with_files
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError, unknown_name

P = TypeVar("P")
_METHOD, _SENSORS, _VEHICLE = "method", "sensors.", "vehicle."


@dataclass(frozen=True, slots=True)
class Configuration:
    """A role, the method that plays it and all their parameters.

    `sensors` are those of the signals that the method writes; `unused` values belong to other
    methods of the role. `own_faults` are those of a method without `faults` among its parameters.
    `from_files` are the names of parameters that files set, and of those that name the files.
    """

    role: str
    method: Method
    parameters: Any
    common: CommonParameters
    extra: Any
    unused: tuple[str, ...] = ()
    sensors: Any = field(default_factory=sensors_for(()))
    own_faults: FaultParameters | None = None
    from_files: tuple[str, ...] = field(default=(), compare=False)

    @property
    def period(self) -> int:
        """The control period in nanoseconds."""
        return stamps.from_seconds(self.common.control_period)

    @property
    def faults(self) -> tuple[str, ...]:
        """The faults as texts."""
        texts: tuple[str, ...] = getattr(self.own_faults or self.parameters, "faults", ())
        return texts

    @property
    def is_ideal(self) -> bool:
        """True if all its sensors show the true values."""
        kind: type = type(self.sensors)
        return bool(self.sensors == defaults(kind))

    @property
    def given(self) -> Any:
        """The parameters for the method, with seeds of its own that follow from that of the node."""
        return seeded(self.parameters, self.common.seed)

    @property
    def has_random_method(self) -> bool:
        """True if the method itself depends on the seed, and not its sensors and faults alone."""
        return seeded(self.parameters, 1) is not self.parameters

    def create(self) -> Any:
        """A new object of the method, at rest, in plain Python and in front of its sensors."""
        return create(self.method, self.given, self.common.vehicle, self.common.control_period)

    def __deepcopy__(self, _: Any) -> Configuration:
        """Itself, for it never changes: a copy has the same law, even if its file was edited since."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Names and values for pickle, since a method is code; the text of a law file has to be the same there."""
        extra = type(self.extra) if self.extra is not None else None
        return _of_same_text, (self.role, self.values(), extra, text_of(self.method))

    def entries(self) -> tuple[Entry, ...]:
        """Every parameter of the node with its present value as default."""
        fixed = [
            dataclasses.replace(e, spec=dataclasses.replace(e.spec, read_only=True))
            for e in entries(self.common)
        ]
        extra = entries(self.extra) if self.extra is not None else ()
        faults = entries(self.own_faults) if self.own_faults is not None else ()
        of_method = (*entries(self.parameters), *faults, *entries(self.sensors, _SENSORS))
        return (_method_entry(self.role, self.method.name), *fixed, *extra, *of_method)

    def values(self) -> dict[str, Any]:
        """Dotted names and present values of every parameter of the node."""
        parts = (self.common, self.extra, self.parameters, self.own_faults)
        found = {_METHOD: self.method.name}
        for part in parts:
            found |= flatten(part) if part is not None else {}
        return found | flatten(self.sensors, _SENSORS)

    def changed(self, values: Mapping[str, Any]) -> Configuration:
        """The same configuration with other values; ParameterError if one is refused, and nothing changes then."""
        rest = dict(values)
        common, parameters = _replaced(rest, self.common), _replaced(rest, self.parameters)
        sensors = _replaced(rest, self.sensors, _SENSORS)
        own_faults = _replaced(rest, self.own_faults) if self.own_faults is not None else None
        extra = _replaced(rest, self.extra) if self.extra is not None else None
        is_alike = self.method.with_options(parameters) == self.method
        if not rest and is_alike:
            if extra is not None:
                extra.refuse_beside(common)
            changed = {
                "common": common,
                "parameters": parameters,
                "sensors": sensors,
                "own_faults": own_faults,
            }
            changed["extra"] = extra
            made = dataclasses.replace(self, **changed)
            same = parameters is self.parameters and own_faults is self.own_faults
            same = same and common.vehicle is self.common.vehicle and made.period == self.period
            return made if same else _fitting(made)
        kind = type(self.extra) if self.extra is not None else None
        is_same = values.get(_METHOD, self.method.name) == self.method.name
        return configure(
            self.role, {**self.values(), **values}, kind, self.method if is_same else None
        )


def _of_same_text(
    role: str, values: Mapping[str, Any], extra: type | None, text: str
) -> Configuration:
    """The configuration of a pickle; ParameterError if its law file has another text than it had then."""
    made = configure(role, values, extra)
    if text_of(made.method) != text:
        raise ParameterError(
            f"{role} method {made.method.name}: expected the file's text of when this was pickled"
        )
    return made


def changeable_numbers(role: str) -> dict[str, Entry]:
    """Numbers of a role by name, under any of its methods, that may change while it runs."""
    known: dict[str, Entry] = {}
    for method in methods_of(role).values():
        known |= entries_by_name(method.parameters)
    known |= entries_by_name(sensors_for(ROLES[role].writes), _SENSORS)
    found: dict[str, Entry] = {}
    for name, entry in known.items():
        if entry.type in (int, float) and not entry.is_array and not entry.spec.read_only:
            found[name] = entry
    return found


def _method_entry(role: str, name: str) -> Entry:
    known = dict.fromkeys((*methods_of(role), name))  # a library's path as well
    spec = Spec(f"how the {role} works", choices=tuple(known), read_only=True)
    return Entry(_METHOD, str, False, name, spec)


def configure(
    role: str, values: Mapping[str, Any], extra: type | None = None, resolved: Method | None = None
) -> Configuration:
    """The configuration of a role from dotted parameter names and values; others keep their default.

    `extra` is a dataclass of further parameters that only this node has, `resolved` the method, if
    it is not to be looked for by its name. Raises ParameterError for unknown names and refused
    values. A value for another method of the same role, or for a sensor of a signal that this
    method does not write, is checked and then listed as unused, so that one scenario file can serve
    several methods; `refuse_unused` is for values that are given for the chosen ones.
    """
    rest = with_present_name(role, values)
    method = resolved or chosen_method(role, rest)
    rest.pop(_METHOD, None)
    common = _take(rest, CommonParameters)
    further = _take(rest, extra) if extra is not None else None
    if extra is not None:
        refuse_taken(f"{role} method {method.name}", method.parameters, entries_by_name(extra))
    parameters: Any = _take(rest, method.parameters)
    method = method.with_options(parameters)
    sensors: Any = _take(rest, sensors_for(method.writes), _SENSORS)
    own_faults = None if hasattr(parameters, "faults") else _take(rest, FaultParameters)
    made = Configuration(
        role, method, parameters, common, further, tuple(sorted(rest)), sensors, own_faults
    )
    if rest:
        _refuse_unknown(made, rest)
    return _fitting(made)


def _refuse_unknown(configuration: Configuration, unused: Mapping[str, Any]) -> None:
    """ParameterError for an unused value that no other method of the role, or no sensor, takes."""
    role = configuration.role
    others = [(other.parameters, "") for other in methods_of(role).values()]
    others.append((sensors_for(ROLES[role].writes), _SENSORS))
    known = set[str]()
    for of, prefix in others:
        _take(dict(unused), of, prefix)
        known |= entries_by_name(of, prefix).keys()
    for name in unused:
        if name in known:
            continue
        # There are many sensors: they are listed where one is meant.
        is_sensor = name.startswith(_SENSORS)
        own = [each for each in configuration.values() if each.startswith(_SENSORS) == is_sensor]
        raise unknown_name(f"parameter of {role}", name, own)


def refuse_unused(names: Iterable[str], configurations: Collection[Configuration]) -> None:
    """ParameterError for a parameter that no method chosen for a role has; it names those with it."""
    for name in names:
        if all(name in each.unused for each in configurations):
            raise _unused(name, configurations)


def _unused(name: str, configurations: Collection[Configuration]) -> ParameterError:
    role = next(each.role for each in configurations)
    alike: set[str] = set()
    for each in configurations:
        alike |= {known for known in each.values() if _ends_alike(known, name)}
    having = []
    for method in methods_of(role).values():
        of_sensors = entries_by_name(sensors_for(method.may_write), _SENSORS)
        if name in entries_by_name(method.parameters) or name in of_sensors:
            having.append(method.name)
    chosen = ", ".join(dict.fromkeys(each.method.name for each in configurations))
    where = f"expected with {', '.join(having)}"
    if alike:
        where = f"its name there is {' or '.join(sorted(alike))}"
    return ParameterError(
        f"parameter {name} is refused: {role} method {chosen} does not have it, {where}", name
    )


def _ends_alike(one: str, other: str) -> bool:
    return one.endswith(f".{other}") or other.endswith(f".{one}")


def _fitting(configuration: Configuration) -> Configuration:
    """The configuration with the content of its files; ParameterError if its method does not suit the vehicle."""
    method, common = configuration.method, configuration.common
    vehicle, parameters = with_files(common.vehicle), configuration.parameters
    from_files = _changed(common.vehicle, vehicle, _VEHICLE)
    common = dataclasses.replace(common, vehicle=vehicle)
    if isinstance(method.factory, ReadingFiles):
        parameters = _with_files(method, parameters)
    from_files += _changed(configuration.parameters, parameters)
    method = method.with_options(parameters)
    if configuration.extra is not None:
        configuration.extra.refuse_beside(common)
    refuse_layout(method, parameters, common.vehicle)
    has_car, period = hasattr(parameters, "faults"), common.control_period
    refuse_faults(configuration.role, configuration.faults, method.writes, has_car, period)
    changed = {"common": common, "parameters": parameters, "from_files": from_files}
    return dataclasses.replace(configuration, method=method, **changed)


def _with_files(method: Method, parameters: Any) -> Any:
    """Parameters with the content of their files; LawError if the author's function gives anything else."""
    load = method.factory.load_files
    with in_law(method):
        loaded = load(parameters)
        if not isinstance(loaded, type(parameters)):
            raise WrongResultError(
                load, loaded, f"{type(parameters).__name__}: return the parameters"
            )
    return loaded


def _changed(before: Any, after: Any, prefix: str = "") -> tuple[str, ...]:
    """Names of the parameters that differ between two dataclasses."""
    if before == after:
        return ()
    now = flatten(after, prefix)
    return tuple(name for name, value in flatten(before, prefix).items() if value != now[name])


def _replaced(values: dict[str, Any], instance: P, prefix: str = "") -> P:
    """A parameter dataclass with its values in a dictionary, which are taken out of the dictionary."""
    kind: type = type(instance)
    known = entries_by_name(kind, prefix)
    return replaced(
        instance, {name: values.pop(name) for name in [*values] if name in known}, prefix
    )


def _take(values: dict[str, Any], of: type[P], prefix: str = "") -> P:
    """Build a parameter dataclass from its values in a dictionary, and take these out of the dictionary."""
    # To mypy a class is hashable, a class of a type variable is not.
    kind: type = of
    unchanged: P = defaults(kind)
    return _replaced(values, unchanged, prefix)


def chosen_method(role: str, values: Mapping[str, Any]) -> Method:
    """The method that the values choose for a role; ParameterError that lists the known ones if there is none."""
    name = values.get(_METHOD, ROLES[role].default_method)
    # YAML 1.1 reads a bare `off` as false
    return find_method(role, "off" if name is False else name)
