"""The last messages of a node are waited for while a reader needs them."""

from __future__ import annotations

from types import SimpleNamespace

from helpers.ros_graph import node_of, ros_domain

from ev_msgs_py.contract.signals import BodyVelocity
from ev_nodes.master.node import MasterNode
from ev_nodes.stepping.reports import wait_until_heard
from ev_nodes.stepping.runner_line import RUNNER_LINE
from ev_stack.running.node_reports import NodeReports
from ev_stack.running.processes import parameter_overrides


class Publisher:
    """A publisher without acknowledgements, however often it is asked."""

    asked = 0

    def wait_for_all_acked(self, _timeout) -> bool:
        self.asked += 1
        return False


def test_last_words_without_a_reader_are_given_up():
    publisher = Publisher()
    wait_until_heard(publisher, given_up=0.0)
    assert publisher.asked == 1


def test_last_words_are_waited_for_while_a_reader_needs_them():
    publisher = Publisher()
    wait_until_heard(publisher, float("inf"), lambda: publisher.asked < 3)
    assert publisher.asked == 3


def test_at_the_end_of_real_time_the_master_stays_until_the_recorder_has_everything(monkeypatch):
    """The recorder's progress ends the wait; acknowledgements never come here."""
    followed = {"mode": "realtime", "await_recorder": True}
    with ros_domain() as context:
        master = MasterNode(context=context, parameter_overrides=parameter_overrides(followed))
        publisher, reports = Publisher(), iter([b"behind", None, b"behind", None, b"everything"])
        progress = SimpleNamespace(
            take=lambda: next(reports, None), receive=lambda message: heard.append(message)
        )
        heard: list[bytes] = []
        monkeypatch.setattr(
            type(master.schedule), "recorder_is_behind", property(lambda _: heard[-1] == b"behind")
        )
        monkeypatch.setattr(master, "readers", dict.fromkeys(master.readers, progress))
        master.writers = {BodyVelocity: SimpleNamespace(publisher=publisher)}
        master._wait_for_the_recorder()
        assert heard[-1] == b"everything" and publisher.asked == 3
        master.destroy_node()


def test_what_a_part_notes_of_its_last_steps_reaches_the_runner(monkeypatch):
    """A part is asked every 0.1 s, in which a run in lockstep goes on by seconds.

    What it noted last was lost.
    """
    reports = NodeReports("/ev")
    monkeypatch.setenv(RUNNER_LINE, reports.line("plant")[0])
    with ros_domain() as context:
        plant = node_of(context, "plant", {"method": "kinematic"})
        monkeypatch.setattr(plant.stepper.part, "notes", lambda: ("a wheel left the ground",))
        plant.close()
        plant.destroy_node()
    reports.look()
    assert "/ev/plant: a wheel left the ground" in reports.notes
    reports.close()
