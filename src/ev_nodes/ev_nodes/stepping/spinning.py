"""Runs stepped nodes: polls what their next steps wait for and sleeps only when nothing of that has arrived.

rclpy's executors build a wait set of everything for every message, services included. Here a step
wakes up for one subscription, its last input, and polls the others; services, and so parameters,
are looked at now and then, and what there may be besides goes through an ordinary executor. A node
that has a process to itself does that in compiled code for as long as nothing odd comes
(`node_loop`).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service

from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import LINE, shown
from ev_nodes.stepping.signal_io import PolledGroup, SubscriptionHandle
from ev_nodes.stepping.time_of_day import Alarm

_SERVICE_PERIOD = 0.05  # s between looks at services
_SWEEP_PERIOD = 0.01  # s between looks at all subscriptions: at least, and twice that at most


class Refusing:
    """The callback of a service.

    Where it raises, the answer has the reason, if its type has a place for that.
    """

    def __init__(self, service: Service, node: Node) -> None:
        kind: Any = service.srv_type
        self._callback, self._response, self._logger = (
            service.callback,
            kind.Response,
            node.get_logger(),
        )

    def __call__(self, request: Any, response: Any) -> Any:
        """The answer of the callback, or a refusal."""
        try:
            # Before any is set: rclpy would find a type that does not exist in the middle of them.
            for parameter in getattr(request, "parameters", ()):
                Parameter.from_parameter_msg(parameter)
            return self._callback(request, response)
        except Exception as error:  # of any kind: other nodes wait for this one
            reason = shown(f"refused: {error}", LINE)
            self._logger.error(reason)
            return self._refusal(request, reason)

    def _refusal(self, request: Any, reason: str) -> Any:
        refused: Any = self._response()
        result = SetParametersResult(successful=False, reason=reason)
        if hasattr(refused, "message"):
            refused.success, refused.message = False, reason
        elif hasattr(request, "parameters"):
            if hasattr(refused, "results"):
                refused.results = [result for _ in request.parameters]
            else:
                refused.result = result
        return refused


def refuse_what_raises(node: Node) -> None:
    """Let all services of a node answer any request; those that do already stay as they are."""
    for service in node.services:
        if not isinstance(service.callback, Refusing):
            service.callback = Refusing(service, node)


class Spinnable:
    """A node that `spin` can run.

    Lower polling places come first. By default no message wakes it up.
    """

    polling_place = len(ROLES)  # behind the roles
    done = False  # True once its process may end

    def poll(self) -> bool:
        """Take the messages that its next step waits for; False if none was there."""
        raise NotImplementedError

    def take_steps(self, until: float, guard: int) -> bool:
        """Take steps up to a time of the monotonic clock, and sleep in between.

        False if it cannot do so by itself. The guard condition at the address wakes it up, too.
        """
        return False

    def sweep(self) -> None:
        """Take everything else too."""

    def awaits(self) -> SubscriptionHandle | None:
        """The subscription to wake up for, None to sleep the whole time."""
        return None

    def wake_up_within(self) -> float:
        """Seconds to sleep at most."""
        raise NotImplementedError

    def idle(self) -> None:
        """Use the time in which there was nothing to take."""

    def close(self) -> None:
        """Send what is left before the process ends."""

    def every(self: Any, period: float, call: Callable[[], object]) -> None:
        """Call a function by the wall clock, in any executor: rclpy's own executors know nothing but timers."""
        self.create_timer(period, call, clock=Clock(clock_type=ClockType.STEADY_TIME))


def spin(nodes: Sequence[Spinnable], finished: Callable[[], bool]) -> None:
    """Run nodes of one context until `finished()` is true or ROS is shut down."""
    in_order: list[Any] = sorted(nodes, key=lambda node: node.polling_place)  # nodes of rclpy, too
    context = in_order[0].context
    executor = SingleThreadedExecutor(context=context)
    for node in in_order:
        refuse_what_raises(node)
        executor.add_node(node)
    services = [service for node in in_order for service in node.services]
    # A node that has stepped waits for others, and may sleep; nodes of one process wait for each
    # other first.
    alone = len(in_order) == 1
    next_look, next_sweep, came = 0.0, 0.0, True
    _take_over(in_order, True)
    with Alarm(context, executor.wake) as alarm:
        with (
            context.handle
        ):  # the wait set is made once, because making it takes as long as waiting
            wait_set = rclpy_implementation.WaitSet(len(in_order), 1, 0, 0, 0, 0, context.handle)
        while not finished():
            if time.monotonic() >= next_look:
                if not context.ok():
                    break
                for service in services:
                    _answer(service)
                executor.spin_once(timeout_sec=0.0)
                next_look = time.monotonic() + _SERVICE_PERIOD
            rested = alone or not came
            if rested and not (alone and in_order[0].take_steps(next_look, alarm.guard.pointer)):
                _rest(in_order, wait_set, alarm.guard)
            came = False
            for node in in_order:
                came |= node.poll()
            # Where strangers wake it up all the time, a node need not look each time at messages
            # that no step waits for; but where messages always come, such as repeated answers, it
            # must look now and then all the same.
            late = time.monotonic() - next_sweep
            if late >= (0.0 if rested and not came else _SWEEP_PERIOD):
                next_sweep = time.monotonic() + _SWEEP_PERIOD
                for node in in_order:
                    node.sweep()
            if not came:
                for node in in_order:
                    node.idle()
    _take_over(in_order, False)
    executor.shutdown(timeout_sec=0.0)


def _take_over(nodes: Sequence[Any], polled: bool) -> None:
    """Keep the executor off what the nodes poll, or leave it to executors again."""
    for node in nodes:
        for subscription in node.subscriptions:
            if isinstance(subscription.callback_group, PolledGroup):
                subscription.callback_group.polled = polled


def _answer(service: Service) -> None:
    """Answer all calls that have arrived.

    The executor would look at one thing of one node at a time.
    """
    kind: Any = service.srv_type
    while True:
        with service.handle:
            request, header = service.handle.service_take_request(kind.Request)
        if header is None:
            return
        service.send_response(service.callback(request, kind.Response()), header)


def _rest(nodes: Sequence[Spinnable], wait_set: Any, guard: Any) -> None:
    """Sleep until an awaited message arrives, or for as long as the nodes allow."""
    wait_set.clear_entities()
    awaited = [subscription for node in nodes if (subscription := node.awaits()) is not None]
    timeout = min(node.wake_up_within() for node in nodes)
    if not awaited:
        time.sleep(timeout)
        return
    for subscription in awaited:
        wait_set.add_subscription(subscription)
    wait_set.add_guard_condition(guard)
    wait_set.wait(int(timeout * 1e9))
