"""Methods for every role: every output number depends on every number ever read, and on how often.

They are not registered, so that no list of methods shows them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_core.methods.common_parameters import CommonParameters
from ev_core.methods.method_record import Method
from ev_core.parameters.values import build
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.roles import ROLES, RoleKind


@dataclass(frozen=True, slots=True)
class ToyParameters:
    """Nothing to choose."""


class Mixer:
    """A state of one number that never comes to rest, stirred by all inputs."""

    parameters = ToyParameters
    start = 0.1

    def __init__(self, parameters: ToyParameters, vehicle: Any, period: float) -> None:
        self.state = self.start

    def stir(self, signals: tuple[Any, ...]) -> None:
        """A chaotic map, so that a wrong, missing or additional input shows in all that follows."""
        for signal in signals:
            for number in shape_of(type(signal)).flat(signal):
                self.state = math.fmod(3.9 * self.state * (1 - self.state) + 0.618 * number, 1.0)
        self.state = abs(math.fmod(3.7 * self.state * (1 - self.state) + 0.01, 1.0))

    def speak(self, kinds: tuple[type, ...]) -> tuple[Any, ...]:
        """Signals made of the state."""
        spoken = []
        for kind in kinds:
            shape = shape_of(kind)
            values = [math.sin(self.state + i) for i in range(len(shape.channels))]
            for i in shape.never_negative:
                values[i] += 1.0
            spoken.append(shape.signal_of(tuple(values)))
        return tuple(spoken)


OFFERED = {signal for role in ROLES.values() for signal in role.offers}  # that toys do not write


def toy(role: str, reads: tuple[type, ...] | None = None, period: float = 0.01) -> Configuration:
    """A configured toy of a role that reads these signals, by default all that toys write."""
    writes = ROLES[role].writes

    class Answering(Mixer):
        def step(self, *signals: Any) -> Any:
            self.stir(signals)
            return self.speak(writes)[0]

    class Integrating(Mixer):
        def outputs(self) -> tuple[Any, ...]:
            return self.speak(writes)

        def advance(self, *signals: Any) -> None:
            self.stir(signals)

    kind = Integrating if ROLES[role].kind is RoleKind.INTEGRATES else Answering
    everything = tuple(signal for signal in ROLES[role].reads if signal not in OFFERED)
    method = Method(role, "toy", kind, everything if reads is None else reads, ToyParameters)
    common = build(CommonParameters, {"control_period": period})
    return Configuration(role, method, ToyParameters(), common, None)


def begun_at(configuration: Configuration, start: float) -> Configuration:
    """The same toy with another state to begin with."""
    factory = type("Begun", (configuration.method.factory,), {"start": start})
    return replace(configuration, method=replace(configuration.method, factory=factory))


def toy_graph(
    period: float = 0.01, roles: Iterable[str] = tuple(ROLES), **reads: tuple[type, ...]
) -> dict[str, Configuration]:
    """A toy for every role; `reads` says what some of them read."""
    return {role: toy(role, reads.get(role), period) for role in roles}
