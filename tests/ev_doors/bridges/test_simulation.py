"""simulation_interfaces on a running graph.

Real node, services and time, with stand-ins for its messages.
"""

from __future__ import annotations

from inspect import isawaitable, signature
from types import SimpleNamespace

import pytest
from bridges.stand_ins import KINDS, Features, Result, State
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from helpers.ros_graph import Graph, graph, shchur
from rclpy.action import ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from ev_doors.bridges import simulation
from ev_msgs_py.contract.roles import MASTER, REQUIRED
from ev_nodes.stepping.runner_line import TIME_SERVICE

OK = Result.RESULT_OK
SERVICE, ACTION = "simulation_interfaces/srv/{}", "simulation_interfaces/action/SimulateSteps"
_KINDS = {
    "get_simulator_features": "GetSimulatorFeatures",
    "get_simulation_state": "GetSimulationState",
    "set_simulation_state": "SetSimulationState",
    "step_simulation": "StepSimulation",
    "reset_simulation": "ResetSimulation",
}


class Server(Node):
    """A node with Trigger for all its services: without their package ROS has none of their types.

    A call takes and leaves its stand-ins in `calls`.
    """

    def __init__(self, context) -> None:
        super().__init__("simulation_interfaces", context=context, start_parameter_services=False)
        self.calls = {}

    def create_service(self, kind, name, callback, callback_group):
        assert kind is KINDS[SERVICE.format(_KINDS[name])]

        async def serve(_, response):
            given = callback(self.calls[name], kind.Response())
            self.calls[name] = await given if isawaitable(given) else given
            return response

        super().create_service(Trigger, name, serve, callback_group=callback_group)


class Simulator:
    """Calls services and the action beside a running graph."""

    def __init__(self, running: Graph) -> None:
        self.graph = running
        self.node = Server(running.context)
        self.made = simulation.SimulationInterfaces(self.node, "/ev")
        self._executor = SingleThreadedExecutor(context=running.context)
        self._executor.add_node(self.node)
        self._clients = {}

    def until(self, holds) -> None:
        def looked() -> bool:
            for _ in range(8):  # one at a time would leave it behind the clock
                self._executor.spin_once(timeout_sec=0.0)
            return holds()

        self.graph.run(looked)

    def call(self, name: str, **request):
        self.node.calls[name] = KINDS[SERVICE.format(_KINDS[name])].Request(**request)
        client = self._clients.setdefault(name, self.graph.probe.create_client(Trigger, f"/{name}"))
        self.until(client.service_is_ready)
        self.until(client.call_async(Trigger.Request()).done)
        return self.node.calls[name]

    def set(self, state: int) -> int:
        return self.call("set_simulation_state", state=State(state=state)).result.result

    def state(self) -> int:
        return self.call("get_simulation_state").state.state

    def steps(self, count: int, cancelled_behind: int | None = None) -> tuple[str, int, list[int]]:
        """Run the action; return its end, its result, and its feedback."""
        goal, progress, ends = (
            SimpleNamespace(request=KINDS[ACTION].Goal(steps=count), is_cancel_requested=False),
            [],
            [],
        )
        for end in ("abort", "succeed", "canceled"):
            setattr(goal, end, lambda end=end: ends.append(end))

        def feedback(message) -> None:
            assert message.completed_steps + message.remaining_steps == count
            progress.append(message.completed_steps)
            goal.is_cancel_requested = message.completed_steps == cancelled_behind

        goal.publish_feedback = feedback
        task = self._executor.create_task(self.made.simulate_steps, goal)
        self.until(task.done)
        return *ends, task.result().result.result, progress


@pytest.fixture(scope="module")
def simulator(tmp_path_factory):
    """A graph at a tenth of real time, so that it does not end."""
    with (
        pytest.MonkeyPatch.context() as patch,
        graph(
            shchur(5.0, plant__real_time_factor=0.1),
            tmp_path_factory.mktemp("simulation"),
            names=(),
        ) as running,
    ):
        patch.setattr(simulation, "needed", KINDS.__getitem__)
        patch.setattr(simulation, "ActionServer", signature(ActionServer).bind)  # its words alone
        running.parameters[MASTER]["await_recorder"] = False
        for name in REQUIRED:
            running.start(name)
        made = Simulator(running)
        made.until(lambda: running.can_be_called() and running.time > 0.0 and made.made._ticks > 1)
        made.until(lambda: all(client.service_is_ready() for client in made.made._callers.values()))
        yield made


def test_features_are_those_that_are_served(simulator):
    """Neither time nor state can be reset alone; nothing is ever spawned."""
    features = simulator.call("get_simulator_features").features
    assert set(features.features) == {20, 24, 25, 26, 31, 32, 33}
    assert not {
        Features.SIMULATION_RESET_TIME,
        Features.SIMULATION_RESET_STATE,
        Features.SPAWNING,
    } & {*features.features}


def test_states_change_as_they_are_declared(simulator):
    simulator.set(State.STATE_PLAYING)
    assert simulator.set(State.STATE_PLAYING) == 101  # already
    assert simulator.set(State.STATE_PAUSED) == OK
    assert (simulator.state(), simulator.set(State.STATE_PAUSED)) == (State.STATE_PAUSED, 101)
    assert simulator.set(State.STATE_PLAYING) == OK
    assert simulator.set(State.STATE_STOPPED) == OK
    assert (simulator.state(), simulator.graph.time) == (State.STATE_STOPPED, 0.0)
    assert simulator.set(State.STATE_PAUSED) == OK  # without any step
    assert (simulator.state(), simulator.graph.time) == (State.STATE_PAUSED, 0.0)
    assert simulator.set(State.STATE_QUITTING) == Result.RESULT_FEATURE_UNSUPPORTED


def test_steps_are_taken_when_it_answers(simulator):
    simulator.set(State.STATE_PAUSED)
    before = simulator.graph.time
    assert simulator.call("step_simulation", steps=11).result.result == OK
    assert simulator.graph.time == pytest.approx(before + 0.11)  # the period is 10 ms
    assert simulator.call("step_simulation").result.result == OK  # one by default
    assert simulator.graph.time == pytest.approx(before + 0.12)
    assert simulator.steps(4) == ("succeed", OK, [1, 2, 3, 4])
    assert simulator.steps(9, cancelled_behind=2) == ("canceled", OK, [1, 2])
    assert simulator.graph.time == pytest.approx(before + 0.18)
    assert simulator.state() == State.STATE_PAUSED
    assert simulator.set(State.STATE_PLAYING) == OK
    assert simulator.call("step_simulation").result.result == Result.RESULT_OPERATION_FAILED
    assert simulator.steps(2) == ("abort", Result.RESULT_OPERATION_FAILED, [])


def test_steps_of_two_clients_are_taken_one_after_the_other(simulator):
    """A step of the one is none of the other: together they have no more than the clock has."""
    simulator.set(State.STATE_PAUSED)
    made, count = simulator.made, 5
    before, done, goals = made._ticks, [], []

    def goal() -> SimpleNamespace:
        def feedback(_: object) -> None:
            done.append(made._ticks - before)

        found = SimpleNamespace(
            request=KINDS[ACTION].Goal(steps=count),
            is_cancel_requested=False,
            publish_feedback=feedback,
        )
        for end in ("abort", "succeed", "canceled"):
            setattr(found, end, lambda end=end: goals.append(end))
        return found

    tasks = [simulator._executor.create_task(made.simulate_steps, goal()) for _ in range(2)]
    simulator.until(lambda: all(task.done() for task in tasks))
    assert goals == ["succeed", "succeed"]
    # At the n-th of all feedbacks the clock has ticked n times at least.
    assert all(ticks >= n for n, ticks in enumerate(done, start=1)), done
    assert len(done) == 2 * count


def test_time_and_state_are_reset_together(simulator):
    simulator.set(State.STATE_PAUSED)
    simulator.call("step_simulation")
    time = simulator.graph.time
    for scope in (1, 2, 4):
        refused = simulator.call("reset_simulation", scope=scope).result
        assert (
            refused.result == Result.RESULT_FEATURE_UNSUPPORTED
            and "reset together" in refused.error_message
        )
    assert simulator.graph.time == time > 0.0
    for scope in (0, 3, 7, 255):
        simulator.call("step_simulation")
        assert simulator.call("reset_simulation", scope=scope).result.result == OK
        assert simulator.graph.time == 0.0


def test_time_stopped_by_another_client_is_seen(simulator):
    simulator.set(State.STATE_PLAYING)
    simulator.graph.call("pause")
    simulator.until(lambda: simulator.made._paused)
    assert simulator.state() == State.STATE_PAUSED
    simulator.graph.call("resume")
    simulator.until(lambda: not simulator.made._paused)
    assert simulator.state() == State.STATE_PLAYING


def test_a_report_from_before_its_own_call_is_too_late(simulator):
    """A step may report behind the answer to `resume`; its older stamp does not count."""
    simulator.set(State.STATE_PAUSED)
    rests = DiagnosticStatus(
        name=f"/ev/{MASTER}: {TIME_SERVICE}", values=[KeyValue(key="rests", value="True")]
    )
    clock = simulator.node.get_clock()
    report = DiagnosticArray(status=[rests])
    report.header.stamp = clock.now().to_msg()
    assert simulator.set(State.STATE_PLAYING) == OK
    simulator.made._note(report)
    assert simulator.state() == State.STATE_PLAYING
    report.header.stamp = clock.now().to_msg()
    simulator.made._note(report)
    assert simulator.state() == State.STATE_PAUSED
