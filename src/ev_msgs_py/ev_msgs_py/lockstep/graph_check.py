"""Whether the configured nodes of a graph fit together."""

from __future__ import annotations

from collections.abc import Mapping

from ev_msgs_py.lockstep.common_parameters import CommonParameters
from ev_msgs_py.lockstep.configuration import Configuration
from ev_msgs_py.parameters.declaration import ParameterError, flatten

# Of the common parameters those that each node may have its own value of.
_OWN = ("seed", "scheduling_priority", "lock_memory")


def check_graph(configurations: Mapping[str, Configuration]) -> None:
    """ParameterError if the configured nodes do not fit together.

    Nodes share one control period, one mode and one vehicle, what a method reads must be written by the others, and
    the methods and values that it requires must be chosen, except where a role is played by a recording.
    """
    common = {role: flatten(configuration.common) for role, configuration in configurations.items()}
    for name in flatten(CommonParameters()):
        values = {role: values[name] for role, values in common.items()}
        if name not in _OWN and len(set(values.values())) > 1:
            said = ", ".join(f"{role} {value}" for role, value in values.items())
            raise ParameterError(f"{name} differs between nodes: {said}; allowed is one for all")
    written = {signal for configuration in configurations.values() for signal in configuration.method.writes}
    for configuration in configurations.values():
        for signal in configuration.method.inputs:
            if signal not in written:
                names = ", ".join(sorted(c.method.name for c in configurations.values()))
                raise ParameterError(
                    f"{configuration.role} method {configuration.method.name} reads {signal.__name__}, "
                    f"which none of the chosen methods writes ({names})"
                )
        for what, needed in configuration.method.requires.items():
            role, _, parameter = what.partition(".")
            other = configurations.get(role)
            if other is not None and other.method.plays_back:
                continue
            chosen = other and (other.values().get(parameter) if parameter else other.method.name)
            if chosen != needed:
                raise ParameterError(
                    f"{configuration.role} method {configuration.method.name} requires "
                    f"{what if parameter else f'{role} method'} {needed}, but {chosen} is chosen"
                )
