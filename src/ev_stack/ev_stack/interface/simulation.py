"""A car stepped from outside, as the graph without some of its roles, for loops of one's own.

How it works: the roles that are left out divide an instant in two. `before` are the roles in front
of the first of them: they have answered when the frame is shown. `step` puts in what is given, lets
`behind` answer, and integrates into the other of two frames, which becomes the next instant. State
is a copy of that frame with the states of all parts.

And one law on its own, stepped by channels: what a learner imitates.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np

from ev_core.faults.row import of_signals
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import compiled_parts, part_of
from ev_core.lockstep.run import call, refuse_not_finite, roles_in_order
from ev_core.sensors.row import imperfect
from ev_msgs_py.arguments import checked
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.interface.changes import Changes, Name, overrides
from ev_stack.interface.driving import only_run
from ev_stack.interface.inputs import Number, taken_input
from ev_stack.recording.recording import Recording, recording_of
from ev_stack.running.steering_angles import run_with_own_angles
from ev_stack.scenarios.records import Run


class SteppedLaw:
    """A configured role that answers at once, with its sensors and faults, at rest.

    `inputs` and `outputs` are the channels that it reads and writes, such as imu.yaw_rate.
    ParameterError for a role that integrates.
    """

    def __init__(self, configuration: Configuration) -> None:
        if ROLES[configuration.role].kind is not RoleKind.ANSWERS:
            answering = [role.name for role in ROLES.values() if role.kind is RoleKind.ANSWERS]
            raise ParameterError(
                f"{configuration.role} integrates, expected one of {', '.join(answering)}"
            )
        self._configuration = configuration
        self._part = part_of(configuration, compiled=True)
        self._here = np.zeros(frame.SIZE)
        places = frame.channels()
        self._inputs = {name: places[name] for name in _channels(configuration.method.reads)}
        self._outputs = {name: places[name] for name in _channels(configuration.method.writes)}
        self.inputs, self.outputs = tuple(self._inputs), tuple(self._outputs)

    def __getstate__(self) -> dict[str, Any]:
        """State for pickle and deepcopy: compiled code is left out and made again from it."""
        return {name: value for name, value in vars(self).items() if name != "_part"} | {
            "state": self.state
        }

    def __setstate__(self, saved: dict[str, Any]) -> None:
        state = saved.pop("state")
        vars(self).update(saved)
        self._part = part_of(self._configuration, compiled=True)
        self.state = state

    @checked
    def answer(self, time: float, given: Mapping[str, Number]) -> dict[str, float]:
        """Outputs at an instant [s], by channel in SI units.

        Missing inputs keep their last value. ParameterError for an input that no run has,
        SignalError if an output is not finite.
        """
        self._here[frame.TIME] = time
        for name, place in self._inputs.items():
            if name in given:
                self._here[place] = taken_input(name, place, given[name])
        here = Frame.of(self._here)
        # A law that answers reads and writes the frame of one instant.
        self._part.step(here, here)
        return {name: here.numbers[place] for name, place in self._outputs.items()}

    @property
    def state(self) -> Any:
        """All that lasts between steps; may be set to that of another one of the law."""
        return self._part.state

    @state.setter
    def state(self, state: Any) -> None:
        self._part.state = state


def _channels(signals: Iterable[type]) -> list[str]:
    # The instant is the time of the frame, and no topic.
    return [name for signal in signals if signal is not Instant for name in TOPICS[signal].channels]


@dataclass(frozen=True)
class SimulationState:
    """All that lasts between steps: number of the instant, its frame, and by role the seed and the states of its parts.

    `of` names what it is the state of: control period [ns], numbers of a frame, and by role method,
    options, sensors and faults.
    """

    instant: int
    frame: np.ndarray
    seeds: Mapping[str, int]
    parts: Mapping[str, tuple[Any, ...]]
    of: Mapping[str, Any]


class Simulation:
    """One run of a scenario, step by step.

    What the roles in `without` would write is given to each `step`.

    `scenario` is a name, a path, or a run that is configured already.

    After `reset` and after each `step` the frame shows an instant as far as it goes without them:
    all that integrates, and the answers of the roles in front of the first one that is left out.
    `step` puts in what is given, lets the others answer, and integrates to the next instant. `run`
    names which run is meant if there are several; the arguments from `method` on are those of
    `ev_stack.run`. With `record` the frames are kept for `recording`.

    ParameterError, in one line, if something is refused; SignalError if a number becomes not
    finite.

    >>> import ev_stack
    >>> car = ev_stack.Simulation("double_lane_change", without=["driver"])
    >>> frame = car.step({"driver.command.drive_torque": 100.0})
    >>> car.time, frame["torque_request.drive.front_left"]
    (0.01, 50.0)
    """

    @checked
    def __init__(
        self,
        scenario: Name | Run,
        without: Sequence[str] = (),
        run: str = "",
        record: bool = True,
        **changes: Unpack[Changes],
    ) -> None:
        changed = overrides(**changes)
        if isinstance(scenario, Run) and (run or changed != overrides()):
            raise ParameterError(
                f"run {scenario.name} is configured already, expected a name or path with changes"
            )
        if isinstance(scenario, Run):
            of = run_with_own_angles(scenario)
        else:
            of = only_run(scenario, run, changed)
        for role in without:
            if role not in of.configurations:
                raise unknown_name("role", role, of.configurations)
        self.configurations, self._without, self._record = of.configurations, tuple(without), record
        self._writes = {role: each.method.writes for role, each in of.configurations.items()}
        answering, integrating = roles_in_order(self.configurations)
        # Roles in front of the first one that is left out can answer before anything is given.
        first = min(
            (answering.index(role) for role in without if role in answering), default=len(answering)
        )
        # Its output is part of the instant from the beginning, so no answer can come before it.
        if any(role in integrating for role in without):
            first = 0
        self.before, self.behind = self._kept(answering[:first]), self._kept(answering[first:])
        self.integrating = self._kept(integrating)
        # Also what the method that is left out writes beyond its role, such as an optional signal.
        given = dict.fromkeys(
            signal for role in without for signal in (*ROLES[role].writes, *self._writes[role])
        )
        places = frame.channels()
        self.kept = (*self.before, *self.behind, *self.integrating)
        self.inputs = tuple(name for signal in given for name in TOPICS[signal].channels)
        self._inputs = {name: places[name] for name in self.inputs}
        self._channels = {
            name: places[name]
            for signals in (*self._writes.values(), given)
            for signal in signals
            for name in TOPICS[signal].channels
        }
        self.period, self.duration = of.period, of.duration
        self.reset()

    def _kept(self, roles: Sequence[str]) -> tuple[str, ...]:
        return tuple(
            role for role in roles if role in self.configurations and role not in self._without
        )

    @checked
    def reset(self, seed: int | None = None) -> Mapping[str, float]:
        """Begin again, at rest, with another seed of everything random if one is given.

        The first frame comes back.
        """
        if seed is not None:
            self.configurations = {
                role: each.changed({"seed": seed}) for role, each in self.configurations.items()
            }
        self._make_parts()
        self._here, self._next = np.zeros(frame.SIZE), np.zeros(frame.SIZE)
        self._instant, self._frames = 0, list[np.ndarray]()
        for role in self.integrating:
            self._call(role, None, self._here)
        return self._begin_instant()

    def _make_parts(self) -> None:
        self._parts = {role: compiled_parts(self.configurations[role]) for role in self.kept}

    def __getstate__(self) -> dict[str, Any]:
        """State for pickle and deepcopy: compiled code is left out and made again from it."""
        return {name: value for name, value in vars(self).items() if name != "_parts"} | {
            "state": self.state
        }

    def __setstate__(self, saved: dict[str, Any]) -> None:
        state = saved.pop("state")
        vars(self).update(saved)
        self._make_parts()
        self.state = state

    @checked
    def step(self, inputs: Mapping[str, Number] | None = None) -> Mapping[str, float]:
        """Go on by one control period and give the frame that is shown then.

        `inputs` are by channel what the roles that are left out write at this instant, in SI units;
        a channel that is not named keeps its last value, which is 0 at the start. ParameterError
        for another channel or no finite number.
        """
        taken: dict[int, float] = {}
        for name, value in (inputs or {}).items():
            if name not in self._inputs:
                raise unknown_name("input", name, self.inputs)
            place = self._inputs[name]
            taken[place] = taken_input(name, place, value)
        # Only now, when all inputs are taken: a refused one leaves the frame as it was.
        for place, value in taken.items():
            self._here[place] = value
        self._answer(self.behind)
        # What is given, and answers that are not due yet, keep their last values.
        self._next[:] = self._here
        # by which faults know when they strike
        self._next[frame.TIME] = self._time_of(self._instant + 1)
        for role in self.integrating:
            self._call(role, self._here, self._next)
        if self._record:
            # A copy: the frame itself is used again two steps later.
            self._frames.append(self._here.copy())
        # The frames take turns, so that no step makes a new one.
        self._here, self._next = self._next, self._here
        self._instant += 1
        return self._begin_instant()

    def _begin_instant(self) -> Mapping[str, float]:
        self._here[frame.TIME] = self.time
        self._answer(self.before)
        return self.frame

    def _answer(self, roles: Sequence[str]) -> None:
        for role in roles:
            self._call(role, self._here, self._here)

    def _call(self, role: str, here: np.ndarray | None, there: np.ndarray) -> None:
        """Let the parts of a role answer or integrate; without `here` they show their start."""
        for part in self._parts[role]:
            call(part, 0 if here is None else here.ctypes.data, there)
        refuse_not_finite(there, self._writes[role])

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._time_of(self._instant)

    def _time_of(self, instant: int) -> float:
        return stamps.to_seconds(instant * self.period)

    @property
    def frame(self) -> Mapping[str, float]:
        """Numbers of this instant by channel, such as imu.yaw_rate.

        Later answers still show the last.
        """
        return {name: float(self._here[place]) for name, place in self._channels.items()}

    @property
    def recording(self) -> Recording:
        """The instants that are complete: all but the present one."""
        written = {signal for role in self.configurations for signal in self._writes[role]}
        # What was given in the place of a role belongs to the run as well.
        written |= {signal for role in self._without for signal in ROLES[role].writes}
        frames = np.array(self._frames).reshape(-1, frame.SIZE)
        return recording_of(
            frames, [topic for signal, topic in TOPICS.items() if signal in written]
        )

    @property
    def state(self) -> SimulationState:
        """All that lasts, as a copy, which can be pickled.

        It may be set to go on from there. The recording goes on.

        It may be that of other parameters of the same methods. ParameterError, and nothing changes,
        if it is of another period, of other roles, methods, options, sensors or faults of signals,
        or if its numbers are not as many.
        """
        seeds = {role: self.configurations[role].common.seed for role in self.kept}
        parts = {
            role: tuple(copy.deepcopy(part.state) for part in self._parts[role])
            for role in self.kept
        }
        return SimulationState(self._instant, self._here.copy(), seeds, parts, self._of())

    @state.setter
    def state(self, saved: SimulationState) -> None:
        if not isinstance(saved, SimulationState):
            raise ParameterError(
                f"state: {quoted(saved)} is refused, expected the state of a Simulation"
            )
        here = self._of()
        # Over the names of both: a role that only one of them has differs, too.
        for what in {**here, **saved.of}:
            if here.get(what) != saved.of.get(what):
                was, there_is = quoted(saved.of.get(what, "none")), quoted(here.get(what, "none"))
                raise ParameterError(
                    f"state: {what} was {was}, here it is {there_is}; expected the same"
                )
        # Copies, which take effect only when everything fits.
        configurations, parts = {**self.configurations}, {**self._parts}
        for role, seed in saved.seeds.items():
            # The seed is in the constants of sensors and random methods: their parts are made anew.
            if configurations[role].common.seed != seed:
                configurations[role] = configurations[role].changed({"seed": seed})
                parts[role] = compiled_parts(configurations[role])
        states = [
            (role, part, state)
            for role in self.kept
            for part, state in zip(parts[role], saved.parts[role], strict=True)
        ]
        for role, part, state in states:
            # All sizes are compared before the first state is set: nothing is half-applied.
            size, fits = np.size(state), np.size(part.state)
            if size != fits:
                raise ParameterError(
                    f"state: {role} had {size} numbers, here it has {fits}; expected as many"
                )
        for _, part, state in states:
            part.state = copy.deepcopy(state)
        self.configurations, self._parts = configurations, parts
        self._instant = saved.instant
        self._here[:] = saved.frame

    def _of(self) -> dict[str, Any]:
        """Features by name that a state has to agree in."""
        found: dict[str, Any] = {
            "control period [ns]": self.period,
            "roles": self.kept,
            "numbers": frame.SIZE,
        }
        for role in self.kept:
            configuration = self.configurations[role]
            errors = {
                quantity.name: each.delay for quantity, each in imperfect(configuration.sensors)
            }
            faults = [fault.text for fault in of_signals(configuration.faults)]
            found |= {
                f"{role}.method": configuration.method.name,
                f"options of {role}": configuration.options,
                f"{role}.faults of signals": faults,
            }
            found[f"delays of sensors of {role}"] = errors
        return found
