"""One law on its own, stepped by channels: what a learner imitates and what an FMU of a law holds."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import part_of
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError


class SteppedLaw:
    """A configured role that answers at once, with its sensors and faults, at rest.

    `inputs` and `outputs` are the channels that it reads and writes, such as imu.yaw_rate. ParameterError for a role
    that integrates.
    """

    def __init__(self, configuration: Configuration) -> None:
        self._set_up(configuration)

    def _set_up(self, configuration: Configuration) -> None:
        if ROLES[configuration.role].kind is not RoleKind.ANSWERS:
            answering = [role.name for role in ROLES.values() if role.kind is RoleKind.ANSWERS]
            raise ParameterError(f"{configuration.role} integrates, allowed is one of {', '.join(answering)}")
        self._configuration = configuration
        self._part = part_of(configuration, compiled=True)
        self._here = Frame()
        places = frame.channels()
        self._inputs = {name: places[name] for name in _channels(configuration.method.reads)}
        self._outputs = {name: places[name] for name in _channels(configuration.method.writes)}
        self.inputs, self.outputs = tuple(self._inputs), tuple(self._outputs)

    def __getstate__(self) -> dict[str, Any]:
        """For pickle and deepcopy: the part is compiled code, so it is made anew and goes on from its state."""
        inputs = {name: self._here.numbers[place] for name, place in self._inputs.items()}
        return {"configuration": self._configuration, "inputs": inputs, "state": copy.deepcopy(self.state)}

    def __setstate__(self, saved: dict[str, Any]) -> None:
        self._set_up(saved["configuration"])
        for name, value in saved["inputs"].items():
            self._here.numbers[self._inputs[name]] = value
        self.state = saved["state"]

    def answer(self, time: float, given: Mapping[str, float]) -> dict[str, float]:
        """What it writes at an instant [s], by channel in SI units; inputs that are not given keep their last value.

        SignalError if a number is not finite.
        """
        numbers = self._here.numbers
        numbers[frame.TIME] = time
        for name, place in self._inputs.items():
            if name in given:
                numbers[place] = given[name]
        self._part.step(self._here, self._here)
        return {name: numbers[place] for name, place in self._outputs.items()}

    @property
    def state(self) -> Any:
        """All that lasts between steps; may be set to that of another one of the law."""
        return self._part.state

    @state.setter
    def state(self, state: Any) -> None:
        self._part.state = state


def _channels(signals: Iterable[type]) -> list[str]:
    return [name for signal in signals if signal is not Instant for name in TOPICS[signal].channels]
