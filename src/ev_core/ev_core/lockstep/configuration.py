"""The parameters of a node, resolved the same way for the node and for the offline runner.

How it works: `configure` takes values by dotted names and shares them out: to the parameters that
every node has, those of the chosen method, of its sensors and of its faults. Of what is left each
value has to belong to another method of the role. Then files that parameters name are read, and the
method is held against the vehicle. A `Configuration` never changes: `changed` gives another one.
"""

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
from ev_core.methods.law import OF_VEHICLE
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
_METHOD = "method"
# Groups of parameters, as their dotted names begin.
_SENSORS = "sensors."


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
    def options(self) -> list[str]:
        """Switches among its parameters that are on."""
        law = self.method.law
        return law.switched_on(self.parameters, self.common.vehicle) if law else []

    @property
    def given(self) -> Any:
        """The parameters for the method, with seeds that follow from that of the node."""
        return seeded(self.parameters, self.common.seed)

    @property
    def has_random_method(self) -> bool:
        """True if the method itself depends on the seed, and not its sensors and faults alone."""
        return seeded(self.parameters, 1) is not self.parameters

    def create(self) -> Any:
        """A new object of the method, at rest, in plain Python and in front of its sensors."""
        return create(self.method, self.given, self.common.vehicle, self.common.control_period)

    def __deepcopy__(self, _: Any) -> Configuration:
        """Return itself, for it never changes.

        A copy has the same law, even if its file was edited since.
        """
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Names and values for pickle, since a method is code.

        The text of a law file has to be the same there.
        """
        extra = type(self.extra) if self.extra is not None else None
        return _of_same_text, (self.role, self.values(), extra, text_of(self.method))

    def entries(self) -> tuple[Entry, ...]:
        """Every parameter of the node with its present value as default."""
        found = [_method_entry(self.role, self.method.name)]
        for entry in entries(self.common):
            # All nodes share these, so one alone must not change them in a run.
            fixed = dataclasses.replace(entry.spec, read_only=True)
            found.append(dataclasses.replace(entry, spec=fixed))
        for part in (self.extra, self.parameters, self.own_faults):
            if part is not None:
                found += entries(part)
        return (*found, *entries(self.sensors, _SENSORS))

    def values(self) -> dict[str, Any]:
        """Dotted names and present values of every parameter of the node."""
        found = {_METHOD: self.method.name}
        for part in (self.common, self.extra, self.parameters, self.own_faults):
            if part is not None:
                found |= flatten(part)
        return found | flatten(self.sensors, _SENSORS)

    def declared(self) -> dict[str, Any]:
        """Dotted names and declared defaults of every parameter of the node but its method."""
        found: dict[str, Any] = {}
        for part in (self.common, self.extra, self.parameters, self.own_faults):
            if part is not None:
                kind: type = type(part)
                found |= flatten(defaults(kind))
        sensors: type = type(self.sensors)
        return found | flatten(defaults(sensors), _SENSORS)

    def changed(self, values: Mapping[str, Any]) -> Configuration:
        """The same configuration with other values.

        ParameterError if one is refused, and nothing changes then.
        """
        rest = dict(values)
        common = _replaced(rest, self.common)
        parameters = _replaced(rest, self.parameters)
        sensors = _replaced(rest, self.sensors, _SENSORS)
        own_faults = None
        if self.own_faults is not None:
            own_faults = _replaced(rest, self.own_faults)
        extra = None
        if self.extra is not None:
            extra = _replaced(rest, self.extra)
        # Another method, or another option of this one, has other signals and sensors.
        if rest or self.method.with_options(parameters, common.vehicle) != self.method:
            return self._anew(values)
        if extra is not None:
            extra.refuse_beside(common)
        made = dataclasses.replace(
            self,
            common=common,
            parameters=parameters,
            sensors=sensors,
            own_faults=own_faults,
            extra=extra,
        )
        # Files and the fit to the vehicle take time, and most changes touch neither.
        is_fitting = (
            parameters is self.parameters
            and own_faults is self.own_faults
            and common.vehicle is self.common.vehicle
            and made.period == self.period
        )
        return made if is_fitting else _fitting(made)

    def _anew(self, values: Mapping[str, Any]) -> Configuration:
        """Configure the role from the present values and these others."""
        extra = type(self.extra) if self.extra is not None else None
        # The same law is kept, even if its file was edited since.
        is_same = values.get(_METHOD, self.method.name) == self.method.name
        method = self.method if is_same else None
        # An option that a former name stands for counts before the present value of its switch.
        given = with_present_name(self.role, values)
        return configure(self.role, {**self.values(), **given}, extra, method)


def _of_same_text(
    role: str, values: Mapping[str, Any], extra: type | None, text: str
) -> Configuration:
    """The configuration of a pickle.

    ParameterError if its law file has another text than it had then.
    """
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
    # The name may be the path of a library or of a law file.
    known = dict.fromkeys((*methods_of(role), name))
    spec = Spec(f"how the {role} works", choices=tuple(known), read_only=True)
    return Entry(_METHOD, str, False, name, spec)


def configure(
    role: str, values: Mapping[str, Any], extra: type | None = None, resolved: Method | None = None
) -> Configuration:
    """The configuration of a role from dotted parameter names and values.

    Others keep their default. `extra` is a dataclass of further parameters that only this node has,
    `resolved` the method, if it is not to be looked for by its name. Raises ParameterError for
    unknown names and refused values. A value for another method of the same role, or for a sensor
    of a signal that this method does not write, is checked and then listed as unused, so that one
    scenario file can serve several methods; `refuse_unused` is for values that are given for the
    chosen ones.
    """
    rest = with_present_name(role, values)
    method = resolved or chosen_method(role, rest)
    rest.pop(_METHOD, None)
    common = _take(rest, CommonParameters)
    further: Any = None
    if extra is not None:
        further = _take(rest, extra)
        refuse_taken(f"{role} method {method.name}", method.parameters, entries_by_name(extra))
    parameters: Any = _take(rest, method.parameters)
    # Options decide which signals the method writes, and so which sensors there are.
    method = method.with_options(parameters, common.vehicle)
    sensors: Any = _take(rest, sensors_for(method.writes), _SENSORS)
    own_faults = None if hasattr(parameters, "faults") else _take(rest, FaultParameters)
    # A default does nothing either, and `values` has it for every parameter.
    idle = [name for name in _not_default(parameters) if method.is_idle(name)]
    unused = tuple(sorted((*rest, *idle)))
    made = Configuration(role, method, parameters, common, further, unused, sensors, own_faults)
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
    """Refuse a parameter that no method chosen for a role has, and name those with it."""
    for name in names:
        if all(name in each.unused for each in configurations):
            raise _unused(name, configurations)


def refuse_idle(names: Iterable[str], configuration: Configuration) -> None:
    """Refuse a parameter that does nothing without an option of the method that is off."""
    for name in names:
        if configuration.method.is_idle(name):
            raise _unused(name, [configuration])


def _unused(name: str, configurations: Collection[Configuration]) -> ParameterError:
    role = next(each.role for each in configurations)
    alike: set[str] = set()
    for each in configurations:
        alike |= {known for known in each.values() if _ends_alike(known, name)}
    # Best is the name that was meant; without one, the methods that have this name.
    where = f"its name there is {' or '.join(sorted(alike))}"
    if not alike:
        where = f"expected with {', '.join(_methods_with(role, name))}"
    chosen = ", ".join(dict.fromkeys(each.method.name for each in configurations))
    return ParameterError(
        f"parameter {name} is refused: {role} method {chosen} does not have it, {where}", name
    )


def _methods_with(role: str, name: str) -> list[str]:
    """Methods of a role that use a parameter, their own or a sensor's, and the option for it."""
    found: list[str] = []
    for method in methods_of(role).values():
        ways = {method.name: method}
        for switch in method.switches:
            on = f"{switch} above 0" if switch.startswith(OF_VEHICLE) else f"{role}.{switch} true"
            ways[f"{method.name} and {on}"] = method.with_switches_on([switch])
        with_it = [way for way, each in ways.items() if _uses(each, name)]
        # What it uses without an option it uses with each.
        found += with_it[:1]
    return found


def _uses(method: Method, name: str) -> bool:
    of_sensors = entries_by_name(sensors_for(method.writes), _SENSORS)
    is_own = name in entries_by_name(method.parameters) and not method.is_idle(name)
    return is_own or name in of_sensors


def _ends_alike(one: str, other: str) -> bool:
    return one.endswith(f".{other}") or other.endswith(f".{one}")


def _fitting(configuration: Configuration) -> Configuration:
    """The configuration with the content of its files.

    ParameterError if its method does not suit the vehicle.
    """
    method = configuration.method
    vehicle = with_files(configuration.common.vehicle)
    common = dataclasses.replace(configuration.common, vehicle=vehicle)
    parameters = configuration.parameters
    if isinstance(method.factory, ReadingFiles):
        parameters = _with_files(method, parameters)
    from_files = (
        *_changed(configuration.common.vehicle, vehicle, OF_VEHICLE),
        *_changed(configuration.parameters, parameters),
    )
    if configuration.extra is not None:
        configuration.extra.refuse_beside(common)
    refuse_layout(method, parameters, vehicle)
    # A method with `faults` of its own models a car, which can have faults beside its signals.
    has_car = hasattr(parameters, "faults")
    faults = configuration.faults
    refuse_faults(configuration.role, faults, method.writes, has_car, common.control_period)
    return dataclasses.replace(
        configuration, common=common, parameters=parameters, from_files=from_files
    )


def _with_files(method: Method, parameters: Any) -> Any:
    """Parameters with the content of their files.

    LawError if the author's function gives anything else.
    """
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


def _not_default(parameters: Any) -> tuple[str, ...]:
    """Names of the parameters that differ from their defaults."""
    kind: type = type(parameters)
    return _changed(defaults(kind), parameters)


def _replaced(values: dict[str, Any], instance: P, prefix: str = "") -> P:
    """A parameter dataclass with its values of a dictionary, taken out of it."""
    kind: type = type(instance)
    known = entries_by_name(kind, prefix)
    own: dict[str, Any] = {}
    for name in [*values]:
        if name in known:
            own[name] = values.pop(name)
    return replaced(instance, own, prefix)


def _take(values: dict[str, Any], of: type[P], prefix: str = "") -> P:
    """Build a parameter dataclass from its values in a dictionary, taken out of it."""
    # To mypy a class is hashable, a class of a type variable is not.
    kind: type = of
    unchanged: P = defaults(kind)
    return _replaced(values, unchanged, prefix)


def chosen_method(role: str, values: Mapping[str, Any]) -> Method:
    """The method that the values choose for a role.

    ParameterError that lists the known ones if there is none.
    """
    name = values.get(_METHOD, ROLES[role].default_method)
    # YAML 1.1 reads a bare `off` as false.
    if name is False:
        name = "off"
    return find_method(role, name)
