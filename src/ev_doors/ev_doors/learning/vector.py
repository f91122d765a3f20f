"""Many environments of one scenario, each with its own seed and draws, in one compiled call.

How it works: `SteppedCars` has the memory of all cars. A step gives it the actions and new arrays
for what comes back, so that nothing is copied and nothing that was given is overwritten. An episode
of a car begins in the same call in which the others go on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any, NoReturn

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from ev_doors.learning.cars import SteppedCars
from ev_doors.learning.environment import LARGEST_SEED, Environment, refuse_action
from ev_doors.learning.judging import InPython, Judge, is_law
from ev_doors.learning.limits import limits, motor_torques
from ev_doors.learning.stepping import BEGIN, HERE, LEAVE, STEP, Given
from ev_msgs_py.arguments import checked
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.batches.batch import Threads, number_of_threads
from ev_stack.batches.placed import Placing
from ev_stack.batches.variation import Variation

_MODES = {mode.value: mode for mode in AutoresetMode}
_POSE = ("pose.x", "pose.y")
_OF_ONE = ("record", "render_mode")  # arguments of an environment that a vector of them lacks


class VectorEnvironment(gymnasium.vector.VectorEnv[np.ndarray, np.ndarray, np.ndarray]):
    """Cars of a scenario, each with the bits of an `Environment` of its own.

    - `vary`: by ROLE.PARAMETER, or *.PARAMETER for all roles, one value for each car, as in
      `ev_stack.batch`
    - `autoreset_mode`: NextStep, SameStep or Disabled, as Gymnasium has them
    - `threads`: as many as cores without it

    The other arguments are those of `Environment`. A reward or an end that is no law gets arrays
    with one number for each car in the place of numbers, and gives such an array.

    `frame` has all channels of the present instant, (cars,) each, as views to be read, which the
    next step changes. All arrays that a step gives are new. Car i has the episodes of an
    `Environment` with the i-th seed: `reset(seed=n)` gives them n, n + 1 and so on, a list one for
    each.

    ParameterError, in one line, if something is refused; SignalError if a number becomes not
    finite, after which only `reset` is left.
    """

    @checked
    def __init__(
        self,
        num_envs: Annotated[int, "a whole number, at least 1"] = 1,
        vary: Mapping[str, Iterable[Any]] | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: Threads = None,
        **of_each: Any,
    ) -> None:
        if num_envs < 1:
            raise ParameterError(
                f"num_envs: {num_envs!r} is refused, expected a whole number, at least 1"
            )
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        if mode not in _MODES:
            raise unknown_name("autoreset_mode", mode, _MODES)
        for name in _OF_ONE:
            if of_each.get(name):
                raise ParameterError(f"{name} is refused, expected is Environment for one car")
        self._mode, self.num_envs = _MODES[mode], num_envs
        # One of them, which refuses what cannot be, and has what does not differ between the cars.
        one = Environment(**of_each)
        self.observed, self.channels = one.observed, one.channels
        self.metadata = {**one.metadata, "autoreset_mode": self._mode, "render_modes": []}
        self._period, self._duration = one.simulation.period, one.simulation.duration
        configurations = one.simulation.configurations
        variation = Variation(configurations, vary or {}, {})
        if vary and variation.runs != num_envs:
            raise ParameterError(
                f"vary has {variation.runs} values of each parameter, expected {num_envs}, one for"
                " each car"
            )
        for name in variation.columns:
            if name.endswith(".seed"):
                raise ParameterError(
                    f"vary: {name} is refused, expected are seeds in reset(seed=[...])"
                )
        placing = Placing(configurations, variation)
        self._cars = SteppedCars(
            one,
            placing,
            Judge(one.reward, one.ends, len(one.channels)),
            num_envs,
            number_of_threads(threads),
        )
        here, places = self._cars.cars.frames[:, HERE], frame.channels()
        # A reward that worked in place would change the motion of the cars.
        here.flags.writeable = False
        self.frame = {name: here[:, places[name]] for name in one.simulation.frame}
        bounds = one.action_space.low, one.action_space.high
        if vary:
            bounds = self._bounds_of_draws(one, placing)
        # Cars of all draws find their numbers in it.
        widest = self._cars.cars.largest.max(axis=0)
        self.single_observation_space = gymnasium.spaces.Box(-widest, widest, dtype=np.float64)
        self.single_action_space = gymnasium.spaces.Box(*bounds, dtype=np.float64)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        # Those in plain Python; compiled ones are judged where the cars are stepped.
        vehicle = configurations[MASTER].common.vehicle
        self._reward = None if is_law(one.reward) else InPython("reward", one.reward, vehicle)
        self._ends = None if is_law(one.ends) else InPython("ends", one.ends, vehicle)
        self._seeds = self._listed(of_each.get("seed"))
        self._randoms: list[np.random.Generator | None] = [None] * num_envs
        self._over = np.zeros(num_envs, bool)
        self._has_begun = False

    def _bounds_of_draws(self, one: Environment, placing: Placing) -> tuple[np.ndarray, np.ndarray]:
        """Range of the actions of all cars; each car gets the bounds of what it observes."""
        # Where a car starts bounds how far it comes.
        given = self._arrays()
        given.doings[:] = BEGIN
        self._cars.call(given)
        lowest, highest = [one.action_space.low], [one.action_space.high]
        for car in range(self.num_envs):
            plant = placing.configuration(MASTER, car)
            vehicle = plant.common.vehicle
            if one.action.channels(vehicle) != one.channels:
                raise ParameterError(
                    f"car {car} has other driven wheels, expected are the same for all"
                )
            start = {name: float(self.frame[name][car]) for name in _POSE}
            found = limits(one.observed, vehicle, self._duration, start, max(motor_torques(plant)))
            self._cars.cars.largest[car] = [limit.largest for limit in found.values()]
            low, high = one.action.bounds(plant)
            lowest.append(low)
            highest.append(high)
        return np.min(lowest, axis=0), np.max(highest, axis=0)

    def __reduce__(self) -> NoReturn:
        """Refuse copies: compiled code holds the addresses of this object."""
        raise TypeError("a vector of cars cannot be copied or pickled, expected is a new one")

    def _listed(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            seeds: list[int | None] = [int(seed) + car for car in range(self.num_envs)]
        else:
            seeds = [None if each is None else int(each) for each in seed]
        if len(seeds) != self.num_envs:
            raise ParameterError(f"seed has {len(seeds)} numbers, expected {self.num_envs}")
        for each in seeds:
            if each is not None and each < 0:
                raise ParameterError(
                    f"seed: {each} is refused, expected are whole numbers, at least 0"
                )
        return seeds

    @checked
    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin again at rest, all cars or those of `options["reset_mask"]`."""
        rest = dict(options or {})
        mask = np.asarray(rest.pop("reset_mask", np.ones(self.num_envs, bool)))
        if rest:
            raise ParameterError(
                f"reset option {quoted(str(next(iter(rest))))} is refused, expected is reset_mask"
            )
        if mask.shape != (self.num_envs,) or mask.dtype != bool or not mask.any():
            raise ParameterError(
                f"reset_mask of {mask.dtype} {mask.shape} is refused, expected are"
                f" {self.num_envs} bool, at least one of them True"
            )
        if not self._has_begun and not mask.all():
            raise ParameterError("reset_mask is refused, expected is a reset of all cars before it")
        seeds, given = self._listed(seed), self._arrays()
        given.doings[:] = np.where(mask, BEGIN, LEAVE)
        # Until all is done: what is refused half-way leaves nothing to go on from.
        self._has_begun = False
        self._prepare(mask, seeds)
        self._cars.call(given)
        self._over = self._over & ~mask
        self._has_begun = True
        return given.seen, self._info(given)

    def _arrays(self, actions: np.ndarray | None = None) -> Given:
        """New arrays for a call."""
        cars, size = self.num_envs, (self.num_envs, len(self.channels))
        return Given(
            doings=np.zeros(cars, np.uint8),
            actions=np.zeros(size) if actions is None else actions,
            seen=np.empty((cars, len(self.observed))),
            rewards=np.zeros(cars),
            ended=np.zeros(cars, np.uint8),
            own=np.empty(size),
        )

    def _prepare(self, mask: np.ndarray, seeds: Sequence[int | None]) -> None:
        for car in np.flatnonzero(mask).tolist():
            seed = seeds[car]
            if seed is None:
                seed = self._seeds[car]
            # Only the first episode has the given seed: the next ones would all be the same.
            self._seeds[car] = None
            random = self._randoms[car]
            if seed is not None or random is None:
                random = self._randoms[car] = seeding.np_random(seed)[0]
            if seed is None or seed > LARGEST_SEED:
                seed = int(random.integers(LARGEST_SEED))
            self._cars.prepare(car, seed)

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Go on by one control period; cars at the end of an episode as `autoreset_mode` says.

        ParameterError for another shape, and for what is no finite number; nothing is done then.
        """
        if not self._has_begun:
            raise ParameterError(
                "step is refused before the first reset, expected is reset() before it"
            )
        values = refuse_action(actions, self.action_space.shape, self.channels)
        if self._mode is AutoresetMode.DISABLED and self._over.any():
            car = int(np.flatnonzero(self._over)[0])
            raise ParameterError(
                f"step is refused: the episode of car {car} is over, expected is reset with a"
                " reset_mask"
            )
        given, begins = self._arrays(values), self._over
        given.doings[:] = np.where(begins, BEGIN, STEP)
        # That of the instant at which the action was chosen: the step replaces it.
        own = self._cars.cars.choices[:, 1].copy()
        self._has_begun = False
        self._prepare(begins, [None] * self.num_envs)
        self._cars.call(given)
        rewards, ended = self._judged(given, own)
        info = self._info(given)
        truncated = info["time"] > self._duration
        self._over = ended | truncated
        if self._mode is AutoresetMode.SAME_STEP and self._over.any():
            info = self._with_next_episodes(given, info)
        self._has_begun = True
        return given.seen, rewards, ended, truncated, info

    def _judged(self, given: Given, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rewards, ended = given.rewards, given.ended.view(bool)
        if self._reward is not None:
            rewards = np.array(self._reward(self.frame, given.actions, own), float)
        if self._ends is not None:
            ended = np.array(self._ends(self.frame, given.actions, own), bool)
        for name, array in (("reward", rewards), ("ends", ended)):
            if array.shape != (self.num_envs,):
                raise ParameterError(
                    f"{name} gives an array of shape {array.shape}, expected ({self.num_envs},)"
                )
        # Where an episode begins there is nothing to judge.
        begins = given.doings == BEGIN
        rewards[begins] = 0.0
        ended[begins] = False
        return rewards, ended

    def _with_next_episodes(self, given: Given, info: dict[str, Any]) -> dict[str, Any]:
        """Let episodes begin in the step in which the ones before have ended."""
        mask, final = self._over, np.full(self.num_envs, None, dtype=object)
        for car in np.flatnonzero(mask).tolist():
            final[car] = given.seen[car].copy()
        before = {name: each.copy() for name, each in info.items() if not name.startswith("_")}
        marked = dict.fromkeys([f"_{name}" for name in before], mask)
        given.doings[:] = np.where(mask, BEGIN, LEAVE)
        self._prepare(mask, [None] * self.num_envs)
        self._cars.call(given)
        self._over = np.zeros(self.num_envs, bool)
        return {
            **self._info(given),
            "final_obs": final,
            "_final_obs": mask,
            "final_info": {**before, **marked},
            "_final_info": mask,
        }

    def _info(self, given: Given) -> dict[str, Any]:
        everyone = np.ones(self.num_envs, bool)
        time = self._cars.cars.instants * self._period / stamps.NANOSECONDS
        return {"own": given.own, "_own": everyone, "time": time, "_time": everyone}
