"""The test sequence of section 4.3, by itself and at the services of the node."""

from __future__ import annotations

import pytest
from helpers.ros_graph import NAMESPACE, ros_domain
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from ev_bench.machines.sequence import SEQUENCE_STEPS, Sequence, Stage, begun
from ev_bench.nodes.bench import TestBenchNode
from ev_msgs_py.contract.roles import BENCH_SERVICES


def test_six_steps_in_this_order_and_no_other():
    """Each step that is not due is refused, and nothing changes then."""
    sequence = Sequence()
    for due in SEQUENCE_STEPS:
        for step in SEQUENCE_STEPS:
            if step != due:
                with pytest.raises(ValueError, match=f"{step} is refused, expected {due}"):
                    sequence.after(step, cooling=True)
        sequence = sequence.after(due, cooling=True, chosen="left")
        assert sequence.enabled == ("left" if due == "start" else "none")
    assert sequence == Sequence()


def test_nothing_begins_without_cooling():
    with pytest.raises(ValueError, match="cooling is off"):
        Sequence().after("choose", cooling=False)


def test_after_an_emergency_stop_only_disconnect_is_left():
    stopped = begun("both").stopped()
    assert (begun("both").enabled, stopped.enabled) == ("both", "none")
    with pytest.raises(ValueError, match="after an emergency stop"):
        stopped.after("siemens_rev_0", cooling=True)
    assert stopped.after("disconnect", cooling=False) == Sequence()


def test_circuits_enabled_by_the_parameter_are_in_the_sequence():
    """Its next step is due then; the emergency switch holds against parameters, too."""

    def call(name):
        answer = {each.srv_name.rpartition("/")[2]: each for each in node.services}[name].callback(
            Trigger.Request(), Trigger.Response()
        )
        return answer.success

    def enable(circuits):
        return node.set_parameters_atomically([Parameter("enabled", value=circuits)]).reason

    with ros_domain() as context:
        node = TestBenchNode(
            context=context,
            namespace=NAMESPACE,
            parameter_overrides=[Parameter("enabled", value="none")],
        )
        try:
            assert call("choose_left")
            assert enable("right") == ""
            assert node.sequence == Sequence(Stage.RUNNING, "right")
            assert not call("connect") and call("siemens_rev_0") and call("disconnect")
            assert enable("both") == "" and enable("none") == ""
            assert node.sequence == Sequence()
            assert enable("both") == "" and call("emergency_stop")
            assert (
                enable("both")
                == "enabled is refused after an emergency stop, expected none until disconnect"
            )
            assert node.configuration.parameters.enabled == "none" and node.sequence.emergency
            assert call("disconnect") and enable("both") == ""
        finally:
            node.close()
            node.destroy_node()


def test_the_node_serves_the_steps():
    """A refused service says why; a step that is taken enables or disables the inverters."""

    def call(name):
        answer = {each.srv_name.rpartition("/")[2]: each for each in node.services}[name].callback(
            Trigger.Request(), Trigger.Response()
        )
        return answer.success, answer.message, node.configuration.parameters.enabled

    with ros_domain() as context:
        node = TestBenchNode(
            context=context,
            namespace=NAMESPACE,
            parameter_overrides=[Parameter("enabled", value="none")],
        )
        try:
            assert {each.srv_name.rpartition("/")[2] for each in node.services} >= set(
                BENCH_SERVICES
            )
            assert call("start") == (False, "start is refused, expected choose", "none")
            for name in ("choose_right", "connect", "load_model"):
                assert call(name) == (True, "enabled: none", "none")
            assert call("start") == (True, "enabled: right", "right")
            assert call("emergency_stop") == (True, "enabled: none", "none")
            assert call("disconnect")[0]
        finally:
            node.close()
            node.destroy_node()
