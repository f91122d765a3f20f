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
from ev_doors.learning.limits import LARGEST_HAND_TORQUE, limits, motor_torques
from ev_doors.learning.rewards import CalmYaw, Reward, like_the_driver, quick_without_slip
from ev_doors.learning.view import picture
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.plant.guard import guard_limits
from ev_stack.interface.changes import Changes, Name, listing_changes
from ev_stack.interface.simulation import Simulation, SteppedLaw

Frame = Mapping[str, float]
# Of a scenario.
_LARGEST_SEED = 2**31 - 1
OBSERVED = ("driver.command", "steering_column.state", "twist", "imu", "wheel_states.velocity")


@dataclass(frozen=True)
class Action:
    """A kind of action: it writes some `channels` in the place of a `role`.

    `bounds` gives lowest and highest values for a plant, (number of channels,) each, and `means`
    what is written for an action at an instant. `of_law` is the action that stands for what the law
    wrote.
    """

    role: str
    channels: Callable[[Vehicle], tuple[str, ...]]
    bounds: Callable[[Configuration], tuple[np.ndarray, np.ndarray]]
    means: Callable[[Frame, tuple[str, ...], np.ndarray], dict[str, float]]
    of_law: Callable[[np.ndarray], np.ndarray]


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


def _as_it_is(here: Frame, channels: tuple[str, ...], action: np.ndarray) -> dict[str, float]:
    return dict(zip(channels, action.tolist(), strict=True))


def _limited(here: Frame, channels: tuple[str, ...], action: np.ndarray) -> dict[str, float]:
    """Torques that the law commands at this instant, limited by the action.

    A negative limit counts as zero.
    """
    command, request = TOPICS[WheelTorqueCommand].name, TOPICS[WheelTorqueRequest].name
    asked = [here[request + channel.removeprefix(command)] for channel in channels]
    limits = [max(limit, 0.0) for limit in action.tolist()]
    limited = [max(min(torque, limit), -limit) for torque, limit in zip(asked, limits, strict=True)]
    return dict(zip(channels, limited, strict=True))


ACTIONS = {
    # drive torque of each driven wheel [N m]; the brakes stay with the law
    "torque_split": Action(
        "electronic_differential", _drive(WheelTorqueRequest), _wheel_torques, _as_it_is, np.asarray
    ),
    # largest drive torque of each driven wheel, either way [N m]
    "traction_control": Action("asr", _drive(WheelTorqueCommand), _torque_limits, _limited, np.abs),
    # torque of the hands on the steering wheel [N m]; the pedals stay with the driver
    "steering": Action(
        "driver",
        lambda _: (f"{TOPICS[DriverCommand].name.replace('/', '.')}.hand_torque",),
        _hand_torque,
        _as_it_is,
        np.asarray,
    ),
}


def never(frame: Mapping[str, float]) -> bool:
    """Mark of the end of an episode: none ends early."""
    return False


class Environment(gymnasium.Env[np.ndarray, np.ndarray]):
    """A scenario with an action in the place of a law or of the driver's hands (`ACTIONS`).

    - `action`: torque_split, traction_control or steering, in SI units, by driven wheel
    - `observe`: channels such as imu.yaw_rate, or topics for all their channels, SI, float64
    - `reward`: function of the frame after the step, the action, and the output of the own law
    - `ends`: function of the frame, whether the episode is over; else `duration` ends it
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

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012, as its base

    @listing_changes
    def __init__(
        self,
        scenario: Name = "double_lane_change",
        action: str = "torque_split",
        observe: Sequence[str] = OBSERVED,
        reward: Reward | None = None,
        ends: Callable[[Mapping[str, float]], bool] = never,
        run: str = "",
        record: bool = False,
        render_mode: str | None = None,
        **changes: Unpack[Changes],
    ) -> None:
        if action not in ACTIONS:
            raise unknown_name("action", action, ACTIONS)
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise unknown_name("render_mode", render_mode, self.metadata["render_modes"])
        self._kind, self._ends, self.render_mode = action, ends, render_mode
        self.simulation = Simulation(scenario, (self._action.role,), run, record, **changes)
        self.metadata = {**self.metadata, "render_fps": stamps.NANOSECONDS / self.simulation.period}
        self._car = car = self.simulation.configurations[MASTER].common.vehicle
        self._frame = self.simulation.frame
        self._way: list[tuple[float, float]] = []
        self.observed = _observed(observe, self._frame)
        plant = self.simulation.configurations[MASTER]
        self.limits = limits(
            self.observed, car, self.simulation.duration, self._frame, max(motor_torques(plant))
        )
        self.channels = self._action.channels(car)
        low, high = self._action.bounds(plant)
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)
        self._largest = np.array([limit.largest for limit in self.limits.values()])
        self.observation_space = gymnasium.spaces.Box(
            -self._largest, self._largest, dtype=np.float64
        )
        defaults: dict[str, Reward] = {
            "torque_split": CalmYaw(car.wheelbase, car.steering_ratio, car.rear_steering_ratio),
            "traction_control": quick_without_slip,
            "steering": like_the_driver,
        }
        self._reward = reward or defaults[action]
        self._law = self._own_law()
        self._first_seed = changes.get("seed")

    @property
    def _action(self) -> Action:
        return ACTIONS[self._kind]

    def _own_law(self) -> SteppedLaw:
        return SteppedLaw(self.simulation.configurations[self._action.role])

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
        is_drawn = seed is None or seed > _LARGEST_SEED
        frame = self.simulation.reset(
            int(self.np_random.integers(_LARGEST_SEED)) if is_drawn else seed
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
        if np.shape(action) != self.action_space.shape:
            allowed = f"{self.action_space.shape}, of {', '.join(self.channels)}"
            raise ParameterError(
                f"action of shape {np.shape(action)} is refused, expected {allowed}"
            )
        values = np.asarray(action)
        # Floats, integers with and without sign, and booleans, by numpy's letters for kinds.
        if values.dtype.kind not in "fiub" or not np.isfinite(values).all():
            raise ParameterError(
                f"action {quoted(str(values.tolist()))} is refused, expected are finite numbers"
            )
        values = values.astype(np.float64)
        means = self._action.means(self._frame, self.channels, values)
        # That of the instant at which the action was chosen: the step replaces it.
        own = self._own
        # What equals the output of the law is that output: of two zeros one may have a sign.
        meant = {name: value for name, value in means.items() if value != self._answer[name]}
        frame = self.simulation.step({**self._answer, **meant})
        seen, info = self._seen(frame), self._info(frame)
        # Beyond, not at: the instant of the duration belongs to the run.
        over = self.simulation.time > self.simulation.duration
        return seen, float(self._reward(frame, values, own)), self._ends(frame), over, info

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
        self._answer = self._law.answer(self.simulation.time, frame)
        self._own = self._action.of_law(np.array([self._answer[name] for name in self.channels]))
        self._refuse_what_no_action_means()
        return {"own": self._own, "frame": frame, "time": self.simulation.time}

    def _refuse_what_no_action_means(self) -> None:
        """ParameterError where the law does what no action stands for: there is then no `own`."""
        for name, value in self._action.means(self._frame, self.channels, self._own).items():
            if value != self._answer[name]:
                law = self.simulation.configurations[self._action.role].method.name
                raise ParameterError(
                    f"{self._action.role} method {law} writes {name} {self._answer[name]:g} at"
                    f" {self.simulation.time:g} s, where action {self._kind} only limits what is"
                    " asked for: expected is a method that does so, too"
                )


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
