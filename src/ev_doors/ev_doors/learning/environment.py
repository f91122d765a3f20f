"""A Gymnasium environment around `ev_stack.Simulation`: a learner plays one role of a scenario.

How it works: the scenario's own law goes along on the frames that are shown (`SteppedLaw`), so each
action can be compared with what the law would have done, and channels that no action gives are
those of the law. An action that equals that of the law gives the bits of a run without a learner.

An action names the role that the learner plays, and how its numbers become what that role writes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Unpack

import gymnasium
import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.vehicle.description import Vehicle
from ev_doors.learning.judging import InPython, Reward
from ev_doors.learning.limits import LARGEST_HAND_TORQUE, limits, motor_torques
from ev_doors.learning.rewards import calm_yaw, like_the_driver, never, quick_without_slip
from ev_doors.learning.view import picture
from ev_msgs_py.arguments import checked
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.plant.guard import guard_limits
from ev_stack.interface.changes import Changes, Name
from ev_stack.interface.simulation import Simulation, SteppedLaw
from ev_stack.scenarios.records import Run

LARGEST_SEED = 2**31 - 1  # of a scenario
OBSERVED = ("driver.command", "steering_column.state", "twist", "imu", "wheel_states.velocity")


@dataclass(frozen=True)
class Action:
    """A kind of action: it writes some `channels` in the place of a `role`.

    `bounds` gives lowest and highest values for a plant, (number of channels,) each. An action
    `limits` what the law is asked for, or is what is written (`meant`).
    """

    role: str
    channels: Callable[[Vehicle], tuple[str, ...]]
    bounds: Callable[[Configuration], tuple[np.ndarray, np.ndarray]]
    limits: bool = False

    def asked(self, channels: tuple[str, ...]) -> tuple[str, ...]:
        """Channels that the action limits, one for each of its own; its own if it limits none."""
        if not self.limits:
            return channels
        command, request = TOPICS[WheelTorqueCommand].name, TOPICS[WheelTorqueRequest].name
        return tuple(request + channel.removeprefix(command) for channel in channels)


@compilable
def meant(limits: bool, asked: float, action: float) -> float:
    """Number that is written for an action; a negative limit counts as zero."""
    if not limits:
        return action
    limit = max(action, 0.0)
    return max(min(asked, limit), -limit)


@compilable
def standing_for(limits: bool, written: float) -> float:
    """The action that stands for what a law wrote."""
    return abs(written) if limits else written


def _drive(signal: type) -> Callable[[Vehicle], tuple[str, ...]]:
    prefix = TOPICS[signal].name
    return lambda vehicle: tuple(f"{prefix}.drive.{wheel}" for wheel in vehicle.driven_wheels)


def _wheel_torques(plant: Configuration) -> tuple[np.ndarray, np.ndarray]:
    """Range of the torque at each driven wheel [N m] from the motors that reach it."""
    least, most = motor_torques(plant)
    # Braking torques are positive magnitudes there, and negative torques here.
    return -_at_wheels(plant.common.vehicle, least), _at_wheels(plant.common.vehicle, most)


def _at_wheels(vehicle: Vehicle, motor_torque: float) -> np.ndarray:
    """Largest torques of the driven wheels [N m] that the guard of a plant lets through."""
    # The limits of torque do not depend on the angle, which stays without one here.
    drive = guard_limits(vehicle, motor_torque, math.inf).drive
    return np.array([drive[WHEEL_NAMES.index(wheel)] for wheel in vehicle.driven_wheels])


def _torque_limits(plant: Configuration) -> tuple[np.ndarray, np.ndarray]:
    lowest, highest = _wheel_torques(plant)
    # A limit holds in both directions, so it has to reach the larger of the two.
    return np.zeros_like(highest), np.maximum(-lowest, highest)


def _hand_torque(plant: Configuration) -> tuple[np.ndarray, np.ndarray]:
    return np.array([-LARGEST_HAND_TORQUE]), np.array([LARGEST_HAND_TORQUE])


ACTIONS = {
    # drive torque of each driven wheel [N m]; the brakes stay with the law
    "torque_split": Action("electronic_differential", _drive(WheelTorqueRequest), _wheel_torques),
    # largest drive torque of each driven wheel, either way [N m]
    "traction_control": Action("asr", _drive(WheelTorqueCommand), _torque_limits, limits=True),
    # torque of the hands on the steering wheel [N m]; the pedals stay with the driver
    "steering": Action(
        "driver",
        lambda _: (f"{TOPICS[DriverCommand].name.replace('/', '.')}.hand_torque",),
        _hand_torque,
    ),
}
REWARDS: dict[str, Reward] = {
    "torque_split": calm_yaw,
    "traction_control": quick_without_slip,
    "steering": like_the_driver,
}


def refuse_action(
    action: Any, shape: tuple[int, ...] | None, channels: tuple[str, ...]
) -> np.ndarray:
    """The action as float64; ParameterError for another shape, and for no finite numbers."""
    expected = f"{shape}, of {', '.join(channels)}"
    try:
        given = np.asarray(action)
    except ValueError:  # rows of several lengths
        raise ParameterError(f"action {quoted(action)} is refused, expected {expected}") from None
    if given.shape != shape:
        raise ParameterError(f"action of shape {given.shape} is refused, expected {expected}")
    # Floats, integers with and without sign, and booleans, by numpy's letters for kinds.
    if given.dtype.kind in "fiub":
        # A copy: the memory of the caller may change before it is used again. Numbers of a wider
        # kind may become infinite in it.
        with np.errstate(over="ignore"):
            values = given.astype(np.float64, order="C")
        if np.isfinite(values).all():
            return values
    raise ParameterError(
        f"action {quoted(str(given.tolist()))} is refused, expected are finite numbers"
    )


class Environment(gymnasium.Env[np.ndarray, np.ndarray]):
    """A scenario with an action in the place of a law or of the driver's hands (`ACTIONS`).

    - `action`: torque_split, traction_control or steering, in SI units, by driven wheel
    - `observe`: channels such as imu.yaw_rate, or topics for all their channels, SI, float64
    - `reward`: function of the frame after the step, the action, and the output of the own law
    - `ends`: function of the frame, whether the episode is over; else `duration` ends it; both may
      be written as laws (`judging`)
    - `render_mode`: "rgb_array" for pictures of the car by `render`, (480, 480, 3) of uint8

    Observations end at their limits, as sensors do: `limits` has them by channel, with reasons.
    `run` and the arguments from `method` on are those of `ev_stack.Simulation`. The
    scenario's own law goes along: `info["own"]` is the action that stands for its output, and what
    no action gives (brakes, pedals) is its output. `info["frame"]` has all channels of the instant.
    Everything random follows from the seed of `reset`; without one each episode has another, the
    first one that of `seed` if it is given.

    ParameterError, in one line, if something is refused; SignalError if a number becomes not
    finite.

    >>> environment = Environment("double_lane_change", observe=["imu.yaw_rate"], duration=1.0)
    >>> observed, info = environment.reset(seed=1)
    >>> observed, reward, is_over, is_cut_off, info = environment.step(info["own"])
    >>> observed.shape, environment.action_space.shape
    ((1,), (2,))
    """

    action_space: gymnasium.spaces.Box
    observation_space: gymnasium.spaces.Box
    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012, as its base

    @checked
    def __init__(
        self,
        scenario: Name | Run = "double_lane_change",
        action: str = "torque_split",
        observe: Sequence[str] = OBSERVED,
        reward: Reward | None = None,
        ends: Reward = never,
        run: str = "",
        record: bool = False,
        render_mode: str | None = None,
        **changes: Unpack[Changes],
    ) -> None:
        if action not in ACTIONS:
            raise unknown_name("action", action, ACTIONS)
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise unknown_name("render_mode", render_mode, self.metadata["render_modes"])
        self._kind, self.render_mode = action, render_mode
        self.simulation = Simulation(scenario, (self.action.role,), run, record, **changes)
        self.metadata = {**self.metadata, "render_fps": stamps.NANOSECONDS / self.simulation.period}
        self._car = car = self.simulation.configurations[MASTER].common.vehicle
        self._frame = self.simulation.frame
        self._way: list[tuple[float, float]] = []
        self.observed = _observed(observe, self._frame)
        plant = self.simulation.configurations[MASTER]
        self.limits = limits(
            self.observed, car, self.simulation.duration, self._frame, max(motor_torques(plant))
        )
        self.channels = self.action.channels(car)
        low, high = self.action.bounds(plant)
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)
        self._largest = np.array([limit.largest for limit in self.limits.values()])
        self.observation_space = gymnasium.spaces.Box(
            -self._largest, self._largest, dtype=np.float64
        )
        self.reward, self.ends = reward or REWARDS[action], ends
        self._reward = InPython("reward", self.reward, car)
        self._ends = InPython("ends", ends, car)
        self._law = self._own_law()
        self._first_seed = changes.get("seed")

    @property
    def action(self) -> Action:
        """The kind of action."""
        return ACTIONS[self._kind]

    def _own_law(self) -> SteppedLaw:
        return SteppedLaw(self.simulation.configurations[self.action.role])

    @checked
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin again at rest.

        With the scenario's `seed` the signals are those of `ev_stack.run`.

        A scenario has seeds below 2^31: for a larger one its seed is drawn. ParameterError for
        `options`: there are none, an episode begins as the environment was made.
        """
        if options:
            raise ParameterError(
                f"reset option {quoted(str(next(iter(options))))} is refused, expected is none:"
                " what differs from the scenario is given where the environment is made, such as"
                " set={'plant.initial_speed': 10.0}"
            )
        if seed is None:
            seed = self._first_seed
        # Only the first episode has the given seed: the next ones would all be the same.
        self._first_seed = None
        super().reset(seed=seed)
        # Gymnasium's seeds may be larger than those of a scenario.
        is_drawn = seed is None or seed > LARGEST_SEED
        frame = self.simulation.reset(
            int(self.np_random.integers(LARGEST_SEED)) if is_drawn else seed
        )
        self._law, self._way = self._own_law(), []
        return self._seen(frame), self._info(frame)

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Go on by one control period; `truncated` where the scenario ends.

        ParameterError for another shape, and for what is no finite number; nothing is done then.
        """
        if not hasattr(self, "_own"):
            raise ParameterError(
                "step is refused before the first reset, expected is reset() before it"
            )
        values = refuse_action(action, self.action_space.shape, self.channels)
        means = self._means(values)
        # That of the instant at which the action was chosen: the step replaces it.
        own = self._own
        # What equals the output of the law is that output: of two zeros one may have a sign.
        other = {name: value for name, value in means.items() if value != self._answer[name]}
        frame = self.simulation.step({**self._answer, **other})
        seen, info = self._seen(frame), self._info(frame)
        # Beyond, not at: the instant of the duration belongs to the run.
        over = self.simulation.time > self.simulation.duration
        reward = float(self._reward(frame, values, own))
        return seen, reward, bool(self._ends(frame, values, own)), over, info

    def render(self) -> Any:
        """Draw the car from above and the way it has come; None without `render_mode`."""
        return (
            picture(self._car, self._frame, self.simulation.time, self._way)
            if self.render_mode
            else None
        )

    def _seen(self, frame: Mapping[str, float]) -> np.ndarray:
        return np.clip([frame[name] for name in self.observed], -self._largest, self._largest)

    def _info(self, frame: Mapping[str, float]) -> dict[str, Any]:
        self._frame = frame
        if self.render_mode:
            self._way.append((frame["pose.x"], frame["pose.y"]))
        # The law answers at every instant, whether or not it is followed: its state goes on.
        inputs = {name: frame[name] for name in self._law.inputs}
        self._answer = self._law.answer(self.simulation.time, inputs)
        limits = self.action.limits
        self._own = np.array([standing_for(limits, self._answer[name]) for name in self.channels])
        self._refuse_what_no_action_means()
        return {"own": self._own, "frame": frame, "time": self.simulation.time}

    def _refuse_what_no_action_means(self) -> None:
        """ParameterError where the law does what no action stands for: there is then no `own`."""
        for name, value in self._means(self._own).items():
            if value != self._answer[name]:
                raise self.without_meaning(name, self._answer[name], self.simulation.time)

    def without_meaning(self, channel: str, written: float, time: float) -> ParameterError:
        """Error of a law that writes a number at a time [s] which no action stands for."""
        law = self.simulation.configurations[self.action.role].method.name
        return ParameterError(
            f"{self.action.role} method {law} writes {channel} {written:g} at {time:g} s, where"
            f" action {self._kind} only limits what is asked for: expected is a method that does"
            " so, too"
        )

    def _means(self, action: np.ndarray) -> dict[str, float]:
        """Numbers that an action writes, by channel."""
        asked = self.action.asked(self.channels)
        found: dict[str, float] = {}
        for channel, limited, value in zip(self.channels, asked, action.tolist(), strict=True):
            found[channel] = meant(self.action.limits, self._frame[limited], value)
        return found


def _observed(names: Sequence[str], known: Mapping[str, float]) -> tuple[str, ...]:
    found: list[str] = []
    for name in names:
        # A whole topic, by the beginning of its channels' names, or one channel.
        of_topic = [
            channel for channel in known if channel == name or channel.startswith(f"{name}.")
        ]
        if not of_topic:
            raise unknown_name("channel", name, known)
        found += of_topic
    return tuple(dict.fromkeys(found))
