"""Differences between the runs of a batch."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ev_core.lockstep.configuration import Configuration, refuse_idle
from ev_core.methods.common_parameters import CommonParameters
from ev_core.parameters.declaration import entries
from ev_core.parameters.values import check, entries_by_name, plain
from ev_msgs_py.refusal import ParameterError, unknown_name

EVERY_ROLE, _VEHICLE, _SENSORS = "*", "vehicle.", "sensors."
_OF_ALL_RUNS = ("method", "control_period", "mode")
_SEED = entries_by_name(CommonParameters)["seed"]


class Variation:
    """Differences between runs; names are ROLE.PARAMETER, or *.PARAMETER for all roles.

    `runs` is their number by role where initial states give it. ParameterError for unknown names,
    for what cannot differ, and if the numbers of values are not the same.
    """

    def __init__(
        self,
        configurations: Mapping[str, Configuration],
        vary: Mapping[str, Iterable[Any]],
        runs: Mapping[str, int],
    ) -> None:
        self._configurations = configurations
        self._known = {
            role: configuration.values() for role, configuration in configurations.items()
        }
        columns = {name: [*map(plain, values)] for name, values in vary.items()}
        lengths = {name: len(column) for name, column in columns.items()}
        lengths.update({f"initial_states of {role}": count for role, count in runs.items()})
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise ParameterError(
                f"numbers of runs differ: {listed}; expected one number of values for all"
            )
        self.columns = columns
        # Nothing varies: one run.
        self.runs = next(iter(lengths.values()), 1)
        self._by_role: dict[str, dict[str, Sequence[Any]]] = {role: {} for role in configurations}
        for name, column in columns.items():
            role, _, parameter = name.partition(".")
            if role != EVERY_ROLE and role not in configurations:
                raise unknown_name("role", role, [EVERY_ROLE, *configurations])
            for each in configurations if role == EVERY_ROLE else (role,):
                self._refuse(name, parameter, each, role == EVERY_ROLE)
                self._by_role[each][parameter] = column

    def _refuse(self, name: str, parameter: str, role: str, for_all: bool) -> None:
        configuration = self._configurations[role]
        extra = entries(configuration.extra) if configuration.extra is not None else ()
        # They shape the compiled loop or the master, of which a batch has one for all runs; so do
        # options of a method, which read and write other signals.
        options = configuration.method.switches
        fixed = (*_OF_ALL_RUNS, *options, *(entry.name for entry in extra))
        if parameter in fixed:
            raise ParameterError(
                f"{name} is refused: all runs of a batch have the same {parameter}"
            )
        known = self._known[role]
        if parameter not in known:
            is_sensor = parameter.startswith(_SENSORS)  # there are many: listed where one is meant
            listed = [
                each
                for each in known
                if each not in fixed and each.startswith(_SENSORS) == is_sensor
            ]
            raise unknown_name(f"parameter of {role}", parameter, listed)
        refuse_idle([parameter], configuration)
        if parameter.startswith(_VEHICLE) and not for_all:
            raise ParameterError(
                f"{name} is refused: expected {EVERY_ROLE}.{parameter}, one for all roles"
            )

    def units(self) -> dict[str, str]:
        """The unit of what varies, by the name that it has been given by."""
        found = {}
        for name in self.columns:
            role, _, parameter = name.partition(".")
            for each in self._configurations if role == EVERY_ROLE else (role,):
                for entry in self._configurations[each].entries():
                    if entry.name == parameter:
                        found[name] = entry.spec.unit
        return found

    def configurations(self, role: str) -> list[Configuration] | None:
        """Configurations of a role in all runs, None if they are the same.

        Raises ParameterError if a value is refused.
        """
        base, columns = self._configurations[role], self._by_role[role]
        is_sound = base.is_ideal and not base.faults
        # Where only a seed differs that nothing uses, making a configuration for each run is waste.
        matters = self.concerns_method(role) or self.concerns_sensors(role) or not is_sound
        found = []
        for run in range(self.runs if columns else 0):
            values = {name: column[run] for name, column in columns.items()}
            try:
                if matters:
                    found.append(base.changed(values))
                else:
                    # A bad seed is refused all the same.
                    check(_SEED, values["seed"])
            except ParameterError as error:
                raise ParameterError(f"run {run}: {role}: {error}") from None
        return found or None

    def concerns_sensors(self, role: str) -> bool:
        """Mark of runs that differ in errors of sensors."""
        return any(name.startswith(_SENSORS) for name in self._by_role[role])

    def concerns_method(self, role: str) -> bool:
        """Mark of runs that differ in parameters of a role's method, not only in its sensors."""
        # A seed that only sensors use leaves the method as it is: it is made once.
        seed = () if self._configurations[role].has_random_method else ("seed",)
        return any(
            name not in seed and not name.startswith(_SENSORS) for name in self._by_role[role]
        )
