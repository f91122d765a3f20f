"""Parts of the runs of a batch, as rows for the compiled loop.

How it works: the part of a method with the same parameters in all runs is made once and shared;
each run has a state of its own. Where parameters of a method differ, its part is made for each run,
and where a role has sensors or faults, their rows are.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ev_core.compiled.loop import FAILED
from ev_core.compiled.part import CompiledPart, RowPart, row_function
from ev_core.faults.row import FaultRow
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import compiled_part, row_parts
from ev_core.lockstep.run import refuse_not_finite, roles_in_order
from ev_core.methods.law_error import LawError
from ev_core.methods.method_record import Method
from ev_core.sensors.row import SensorRow
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.observer import Observation
from ev_stack.batches.variation import Variation
from ev_stack.batches.whole_runs import WholeRun

NOTHING = (0, 0)  # is written
_NO_STATES: Mapping[str, np.ndarray] = {}


class Placed(NamedTuple):
    """A part of a role, or what observes it, which runs may share, and a state of a run's own."""

    role: str
    writes: tuple[int, int]
    part: CompiledPart | RowPart | Observation
    state: np.ndarray

    @property
    def row(self) -> tuple[int, ...]:
        """Numbers that the compiled loop takes (`ev_core.compiled.loop`)."""
        function, _, constants = self.part.addresses()
        return function, self.state.ctypes.data, constants, *self.writes

    def error(
        self, status: int, read: np.ndarray | None, wrote: np.ndarray, method: Method
    ) -> SignalError | LawError:
        """Error of a part that has stopped with a status.

        `read` is the frame that it was called with, None at its start, and `wrote` the one that it
        has written.
        """
        try:
            if status == FAILED and isinstance(self.part, CompiledPart):
                raise self.part.raised(None if read is None else read.tolist(), self.state)
            refuse_not_finite(wrote, method.writes)
        except (SignalError, LawError) as error:
            return error
        raise AssertionError(f"{self.role} stopped, but all its numbers are finite")


class Placing:
    """Maker of the parts of each run; a method with the same parameters in all is prepared once.

    `initial_states` have by role a row for each run. ParameterError for a method that does not run
    compiled, for a refused value of a parameter, and for states of another size.
    """

    def __init__(
        self,
        configurations: Mapping[str, Configuration],
        variation: Variation,
        initial_states: Mapping[str, np.ndarray] = _NO_STATES,
    ) -> None:
        for role, configuration in configurations.items():
            law = configuration.method.law
            if law is None or not law.is_compilable:
                raise ParameterError(
                    f"{role} method {configuration.method.name} runs in plain Python, expected in a"
                    " batch are methods that run compiled"
                )
        self.answering, self.integrating = roles_in_order(configurations)
        self._base, self._initial_states = configurations, initial_states
        self._varied = {role: variation.configurations(role) for role in configurations}
        first = {
            role: varied[0] if varied else configurations[role]
            for role, varied in self._varied.items()
        }
        made = {role: compiled_part(configuration) for role, configuration in first.items()}
        self._made, self._differs = made, {role for role in made if variation.concerns_method(role)}
        # What is compiled is compiled here, and not by several threads at once.
        if any(
            variation.concerns_sensors(role) or not each.is_ideal
            for role, each in configurations.items()
        ):
            row_function(SensorRow)
        if any("faults" in name for name in variation.columns) or any(
            each.faults for each in configurations.values()
        ):
            row_function(FaultRow)
        for role, states in initial_states.items():
            _refuse_states(role, states, made[role].state.size)

    @property
    def are_checked(self) -> bool:
        """True if one of the methods is a law of others, which may never end."""
        return any(part.is_checked for part in self._made.values())

    def is_random(self, role: str) -> bool:
        """Return whether the parts of a role depend on its seed in some of the runs."""
        for each in self._varied[role] or [self._base[role]]:
            if not each.is_ideal or each.faults or each.has_random_method:
                return True
        return False

    def configuration(self, role: str, run: int) -> Configuration:
        """The configuration of a role in a run."""
        varied = self._varied[role]
        return varied[run] if varied else self._base[role]

    def placed(self, role: str, run: int, whole: WholeRun | None = None) -> list[Placed]:
        """Parts that play a role in a run, at their start, with the keepers of its true motion."""
        configuration = self.configuration(role, run)
        try:
            part = self._made[role]
            if role in self._differs:
                part = compiled_part(configuration, like=part)
        # values that are each in their range and do not fit together
        except ParameterError as error:
            raise ParameterError(f"run {run}: {role}: {error}") from None
        state = self._initial_states[role][run] if role in self._initial_states else part.state
        # A restart is a call back into Python (`lockstep.parts.Restart`), of which a batch has
        # none.
        if any(text.split()[0] == "restarted" for text in configuration.faults):
            raise ParameterError(
                f"{role} faults: restarted is refused in a batch, expected all other kinds"
            )
        return _with_rows(configuration, part, state, whole)

    def seeded(self, placed: list[Placed], run: int, seed: int) -> list[Placed]:
        """The same parts of a role at their start, with another seed of everything random."""
        role, part = placed[0].role, placed[0].part
        configuration = self.configuration(role, run).changed({"seed": seed})
        assert isinstance(part, CompiledPart)
        if configuration.has_random_method:
            part = compiled_part(configuration, like=part)
        return _with_rows(configuration, part, part.state)


def _with_rows(
    configuration: Configuration,
    part: CompiledPart,
    state: np.ndarray,
    whole: WholeRun | None = None,
) -> list[Placed]:
    role, writes = configuration.role, frame.span(configuration.method.writes)
    placed, rows = [Placed(role, writes, part, state.copy())], row_parts(configuration)
    # In front of the sensors, which overwrite the true numbers in the same frame.
    if rows and whole and (truth := whole.truth_of(role)):
        placed.append(Placed("", NOTHING, truth, truth.state()))
    return [*placed, *(Placed(role, writes, behind, behind.state) for behind in rows)]


def _refuse_states(role: str, states: np.ndarray, size: int) -> None:
    if states.shape[1] != size:
        raise ParameterError(
            f"initial_states of {role} have {states.shape[1]} numbers, expected {size}"
        )
    for run in np.flatnonzero(~np.isfinite(states).all(axis=1)):
        raise ParameterError(f"initial_states of {role} are not finite in run {run}")
