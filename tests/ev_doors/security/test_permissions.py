"""Policies by least privilege, held against a graph that runs."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import pytest
from helpers.ros_graph import NAMESPACE, NODES, graph, shchur
from helpers.sockets_of_process import sockets_of

from ev_doors.security.permissions import (
    Permissions,
    permissions,
    permissions_in_use,
    policy_file,
    violations,
)
from ev_nodes.run_role import refuse_weak_security
from ev_stack.recording.outcome import RunFailed
from ev_stack.running.domain import free_domain
from ev_stack.running.node_reports import enclave, observing

_ELECTRICAL = ("motor_electrics", "motor_temperatures", "battery/cell")
_NOT_KINEMATIC = (
    *_ELECTRICAL,
    "tire_forces",
    "imu/roll",
    "battery",
    "bench/load_command",
    "speed_command",
)
ALLOWED = permissions(NAMESPACE)
SECURED = {
    "ROS_SECURITY_ENABLE": "true",
    "ROS_SECURITY_STRATEGY": "Enforce",
    "ROS_SECURITY_KEYSTORE": "keys",
}


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """Permissions that a running graph uses, and the sockets and threads of its process."""
    with graph(shchur(0.1), tmp_path_factory.mktemp("run"), bag=True) as running:
        running.run()
        used = permissions_in_use(running.probe, NAMESPACE)
        threads = {name.read_text().strip() for name in Path("/proc/self/task").glob("*/comm")}
        return used, sockets_of(), threads


def test_nodes_need_no_more_than_the_policy_allows(seen):
    used, _, _ = seen
    assert set(used) >= set(NODES)
    assert violations(ALLOWED, used.values()) == ()


def test_the_policy_allows_no_service_without_a_node_and_no_topic_without_a_writer(seen):
    """Methods read less than their role may.

    Services and written topics are those of the node itself.
    """
    used, _, _ = seen
    for node, each in used.items():
        assert ALLOWED[node].serves == each.serves
        assert ALLOWED[node].publishes >= each.publishes
        not_kinematic = {f"{NAMESPACE}/{topic}" for topic in _NOT_KINEMATIC}
        assert ALLOWED[node].publishes - each.publishes <= not_kinematic


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"publishes": frozenset({"/ev/torque_command"})}, "driver publishes /ev/torque_command"),
        ({"subscribes": frozenset({"/other/pose"})}, "driver subscribes to /other/pose"),
        ({"serves": frozenset({"/ev/driver/pause"})}, "driver serves /ev/driver/pause"),
    ],
)
def test_what_is_not_allowed_is_named(change, line):
    assert violations(ALLOWED, [replace(ALLOWED["driver"], **change)]) == (line,)


def test_an_unknown_node_may_do_nothing():
    stranger = Permissions("stranger", frozenset({"/rosout"}), frozenset(), frozenset())
    assert violations(ALLOWED, [stranger]) == ("stranger publishes /rosout",)


def test_only_asr_commands_the_plant():
    speakers = [
        name for name, each in ALLOWED.items() if f"{NAMESPACE}/torque_command" in each.publishes
    ]
    assert speakers == ["asr"]


def test_policy_file_has_one_enclave_per_node_with_its_topics():
    enclaves = ElementTree.fromstring(policy_file("/car", permissions("/car").values())).findall(
        "enclaves/enclave"
    )
    assert [each.get("path") for each in enclaves] == [f"/car/{name}" for name in ALLOWED]
    asr = next(each for each in enclaves if each.get("path") == "/car/asr")
    assert "/car/torque_command" in [
        topic.text for topic in asr.findall(".//topics[@publish='ALLOW']/topic")
    ]
    assert "/car/torque_command" not in [
        topic.text for topic in asr.findall(".//topics[@subscribe='ALLOW']/topic")
    ]


def test_no_node_answers_questions_about_types(seen):
    """A thread for that can crash while a node starts; config/fastdds.xml forbids it."""
    _, _, threads = seen
    assert any(name.startswith("dds.") for name in threads)
    assert not any(name.startswith("dds.tls") for name in threads)


def test_every_socket_is_bound_to_this_machine_only(seen):
    """None listens at 0.0.0.0 or at the address of a network."""
    _, sockets, _ = seen
    assert sockets, "DDS has sockets"
    assert [each for each in sockets if not each.address.is_loopback] == []


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"ROS_SECURITY_STRATEGY": "Permissive"}, "'Permissive'"),
        ({"ROS_SECURITY_ENABLE": "1"}, "'1'"),
        ({"ROS_SECURITY_KEYSTORE": ""}, "ROS_SECURITY_KEYSTORE"),
    ],
)
def test_security_by_halves_is_refused(change, named):
    refuse_weak_security(SECURED)
    with pytest.raises(RuntimeError, match=named):
        refuse_weak_security({**SECURED, **change})


def test_a_run_does_not_begin_without_the_keys_that_are_asked_for(monkeypatch, tmp_path):
    for name, value in {**SECURED, "ROS_SECURITY_KEYSTORE": str(tmp_path)}.items():
        monkeypatch.setenv(name, value)
    assert enclave("plant", NAMESPACE) == ["--ros-args", "--enclave", f"{NAMESPACE}/plant"]
    looks = partial(observing, NAMESPACE, name="plant")
    with (
        free_domain() as domain,
        pytest.raises(RunFailed, match="SECURITY ERROR"),
        looks(domain=domain),
    ):
        pass
