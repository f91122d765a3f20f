"""Services of simulation_interfaces 2.1 for a running graph: pause, resume, step and reset.

How it works: each service is a coroutine on one thread. It calls the services of the master and
then waits for a future, which a tick of /clock, the answer, or the timer of `_give_up` ends;
meanwhile the executor serves others. Steps are counted by the ticks that were seen, not by the
answers.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from ev_doors.bridges import needed
from ev_msgs_py.contract.roles import MASTER
from ev_nodes.master.schedule import TIME_SERVICES
from ev_nodes.stepping.runner_line import TIME_SERVICE

_PACKAGE = "simulation_interfaces"
_FEATURES = (
    "SIMULATION_RESET",
    "SIMULATION_STATE_GETTING",
    "SIMULATION_STATE_SETTING",
    "SIMULATION_STATE_PAUSE",
    "STEP_SIMULATION_SINGLE",
    "STEP_SIMULATION_MULTIPLE",
    "STEP_SIMULATION_ACTION",
)
# s of wall time without /clock after which a graph of which nothing is known counts as paused
_RESTS = 0.5
_PATIENCE = 5.0  # s for an answer of the master, and for a step
_LOOK = 0.05  # s
# steps that are asked for together: the master looks for calls 20 times a second, and keeps 10
_AT_ONCE = 8


class SimulationInterfaces:
    """Server of the interfaces in a node, for the graph of a namespace.

    Raises ImportError if the package is not sourced.

    The state of the graph is what its master reports, however it was stopped; before the first
    report the clock tells.
    """

    def __init__(self, node: Node, namespace: str) -> None:
        kinds: dict[str, Any] = {
            name: needed(f"{_PACKAGE}/msg/{name}") for name in ("Result", "SimulationState")
        }
        self._result, self._states = kinds["Result"], kinds["SimulationState"]
        self._features: Any = needed(f"{_PACKAGE}/msg/SimulatorFeatures")
        self._reset_kind: Any = needed(f"{_PACKAGE}/srv/ResetSimulation")
        self._set_kind: Any = needed(f"{_PACKAGE}/srv/SetSimulationState")
        self._action: Any = needed(f"{_PACKAGE}/action/SimulateSteps")
        self._node, self._is_stopped = node, False
        self._paused: bool | None = None
        # ns of the time of day: what was reported before that is older than what was answered
        self._asked_at = 0
        self._ticks, self._ticked = 0, -float("inf")
        self._stamp = (-1, 0)
        self._waiting: list[tuple[float, Future, float]] = []
        self._turn: Future | None = None  # of the client that is being stepped
        self._master = f"{namespace.rstrip('/')}/{MASTER}"
        self._callers = {
            name: node.create_client(Trigger, f"{self._master}/{name}") for name in TIME_SERVICES
        }
        node.create_subscription(Clock, "/clock", self._tick, 256)
        node.create_subscription(DiagnosticArray, "/diagnostics", self._note, 64)
        # an answer waits for others: the node has to take them meanwhile
        group = ReentrantCallbackGroup()
        for name, serve in (
            ("GetSimulatorFeatures", self.features),
            ("GetSimulationState", self.state),
            ("SetSimulationState", self.set_state),
            ("StepSimulation", self.step),
            ("ResetSimulation", self.reset),
        ):
            kind = needed(f"{_PACKAGE}/srv/{name}")
            node.create_service(
                kind,
                "".join(f"_{c.lower()}" if c.isupper() else c for c in name)[1:],
                serve,
                callback_group=group,
            )
        self._server = ActionServer(
            node,
            self._action,
            "simulate_steps",
            self.simulate_steps,
            callback_group=group,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        node.create_timer(_LOOK, self._give_up)

    def spin(self, finished: Callable[[], bool]) -> None:
        """Serve until `finished()`, or until the master has left."""
        executor = SingleThreadedExecutor(context=self._node.context)
        executor.add_node(self._node)
        begun = time.monotonic()
        while not finished() and (
            self._callers["pause"].service_is_ready() or time.monotonic() < begun + _PATIENCE
        ):
            executor.spin_once(timeout_sec=_LOOK)
        executor.shutdown()

    def features(self, _request: Any, response: Any) -> Any:
        """GetSimulatorFeatures: time and state are reset together, so neither is offered alone."""
        response.features.features = [getattr(self._features, name) for name in _FEATURES]
        response.features.custom_info = "EV Control Stack: docs/bridges.md"
        return response

    def state(self, _request: Any, response: Any) -> Any:
        """GetSimulationState."""
        response.state.state = self._state()
        return self._answered(response)

    async def set_state(self, request: Any, response: Any) -> Any:
        """SetSimulationState: playing, paused, or stopped, which is paused at time zero."""
        wanted, now, of = request.state.state, self._state(), self._states
        if wanted not in (of.STATE_STOPPED, of.STATE_PLAYING, of.STATE_PAUSED):
            return self._answered(
                response, self._result.RESULT_FEATURE_UNSUPPORTED, f"state {wanted} cannot be set"
            )
        if wanted == now:
            return self._answered(
                response,
                self._set_kind.Response.ALREADY_IN_TARGET_STATE,
                "the state is that already",
            )
        try:
            # Stopped is paused at zero: a playing graph is paused first, and then reset.
            if wanted == of.STATE_PLAYING:
                await self._ask("resume")
            elif now == of.STATE_PLAYING:
                await self._ask("pause")
            if wanted == of.STATE_STOPPED:
                await self._ask("reset")
        except LookupError as error:
            return self._answered(response, self._result.RESULT_OPERATION_FAILED, str(error))
        self._paused, self._is_stopped = wanted != of.STATE_PLAYING, wanted == of.STATE_STOPPED
        return self._answered(response)

    async def step(self, request: Any, response: Any) -> Any:
        """StepSimulation: the answer comes when all steps are taken."""
        return self._answered(response, *await self._take_steps(request.steps))

    async def simulate_steps(self, goal: Any) -> Any:
        """SimulateSteps: feedback after each step; a cancelled goal stops after a whole one."""
        wanted, result = goal.request.steps, self._action.Result()
        code, text, done = self._result.RESULT_OK, "", 0
        # One by one, since each step has its feedback and may be the last.
        while done < wanted and code == self._result.RESULT_OK and not goal.is_cancel_requested:
            code, text = await self._take_steps(1)
            if code == self._result.RESULT_OK:
                done += 1
                goal.publish_feedback(
                    self._action.Feedback(completed_steps=done, remaining_steps=wanted - done)
                )
        end = (
            goal.abort
            if code != self._result.RESULT_OK
            else goal.succeed
            if done == wanted
            else goal.canceled
        )
        end()
        return self._answered(result, code, text)

    async def reset(self, request: Any, response: Any) -> Any:
        """ResetSimulation: all, or time and state together; nothing is ever spawned."""
        of, scope = self._reset_kind.Request, request.scope
        both = of.SCOPE_TIME | of.SCOPE_STATE
        # A reset of the master begins a new run, in which time and state are at their start.
        if scope not in (of.SCOPE_DEFAULT, of.SCOPE_ALL) and scope & both != both:
            text = f"scope {scope}: time and state are reset together"
            return self._answered(response, self._result.RESULT_FEATURE_UNSUPPORTED, text)
        try:
            await self._ask("reset")
        except LookupError as error:
            return self._answered(response, self._result.RESULT_OPERATION_FAILED, str(error))
        return self._answered(response)

    def _answered(self, response: Any, code: int | None = None, text: str = "") -> Any:
        response.result = self._result(
            result=self._result.RESULT_OK if code is None else code, error_message=text
        )
        return response

    def _state(self) -> int:
        paused = time.monotonic() - self._ticked > _RESTS if self._paused is None else self._paused
        of = self._states
        state: int = (
            of.STATE_PLAYING
            if not paused
            else of.STATE_STOPPED
            if self._is_stopped
            else of.STATE_PAUSED
        )
        return state

    async def _take_steps(self, count: int) -> tuple[int, str]:
        """Take the steps of one client: ticks of the clock do not show which one asked."""
        while self._turn is not None:
            await self._turn
        self._turn = turn = Future(executor=self._node.executor)
        try:
            return await self._take_steps_alone(count)
        finally:
            self._turn = None
            turn.set_result(True)

    async def _take_steps_alone(self, count: int) -> tuple[int, str]:
        if self._state() == self._states.STATE_PLAYING:
            return self._result.RESULT_OPERATION_FAILED, "the simulation is not paused"
        try:
            for done in range(0, count, _AT_ONCE):
                steps = min(count - done, _AT_ONCE)
                # Before the request: the ticks may come before the answer does.
                stepped = self._future(self._ticks + steps)
                await self._ask("step", steps)
                self._paused, self._is_stopped = True, False
                if not await stepped:
                    raise LookupError(
                        f"no step within {_PATIENCE:g} s: {self._master} reports the silent nodes"
                    )
        except LookupError as error:
            return self._result.RESULT_OPERATION_FAILED, str(error)
        return self._result.RESULT_OK, ""

    async def _ask(self, service: str, times: int = 1) -> None:
        """Have the master do something, so many times; LookupError if it does not answer."""
        self._asked_at = self._node.get_clock().now().nanoseconds
        client = self._callers[service]
        if not client.service_is_ready():
            raise LookupError(f"{self._master} is not there")
        answered = self._future()
        calls = [client.call_async(Trigger.Request()) for _ in range(times)]

        def note(_: Future) -> None:
            if all(call.done() for call in calls) and not answered.done():
                answered.set_result(True)

        for call in calls:
            call.add_done_callback(note)
        if not await answered:
            raise LookupError(f"{self._master} does not answer")

    def _future(self, ticks: float = float("inf")) -> Future:
        """Wait for so many ticks of the clock.

        Returns True once they were seen or time was set, False when that takes too long.
        """
        future: Future = Future(executor=self._node.executor)
        self._waiting.append((ticks, future, time.monotonic() + _PATIENCE))
        return future

    def _tick(self, message: Any) -> None:
        if (message.clock.sec, message.clock.nanosec) == self._stamp:  # the master repeats itself
            return
        self._stamp = message.clock.sec, message.clock.nanosec
        self._ticks, self._ticked = self._ticks + 1, time.monotonic()
        for ticks, future, _ in self._waiting:
            if self._ticks >= ticks and not future.done():
                future.set_result(True)

    def _note(self, message: Any) -> None:
        """Read the master's reports of time, whichever client asked for them."""
        # A report from before our last request may be the opposite of what has been answered
        # since.
        if Time.from_msg(message.header.stamp).nanoseconds < self._asked_at:
            return
        for status in message.status:
            if status.name == f"{self._master}: {TIME_SERVICE}":
                values = {each.key: each.value for each in status.values}
                self._paused = values.get("rests") == "True"
                # Stopped ends when time goes on, by whatever client.
                self._is_stopped &= self._paused

    def _give_up(self) -> None:
        now = time.monotonic()
        for _, future, deadline in self._waiting:
            # As long as the clock ticks, steps are being taken, however many there are.
            if now > max(deadline, self._ticked + _PATIENCE) and not future.done():
                future.set_result(False)
        self._waiting = [each for each in self._waiting if not each[1].done()]
