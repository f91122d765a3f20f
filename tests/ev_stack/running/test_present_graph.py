"""A look into the running graph waits for late nodes, as long as discovery takes."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace

import pytest

from ev_stack.commands import present_graph
from ev_stack.commands.present_graph import master_namespace, type_of


class Graph:
    """View of a graph in which nodes appear at instants [s] of a clock that sleeping moves."""

    def __init__(self, appear: Mapping[str, float], monkeypatch: pytest.MonkeyPatch) -> None:
        self.now, self._appear = 0.0, appear
        monkeypatch.setattr(
            present_graph, "time", SimpleNamespace(monotonic=lambda: self.now, sleep=self.sleep)
        )

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def _there(self) -> list[str]:
        return [name for name, at in self._appear.items() if at <= self.now]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [(name, "/ev") for name in self._there()]

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        return [(f"/ev/{name}/x", ["std_msgs/msg/String"]) for name in self._there()]

    def get_fully_qualified_name(self) -> str:
        return "/shell"


def test_a_master_that_is_found_late_is_awaited(monkeypatch):
    """Longer than nodes take one by one: each that comes shows that discovery goes on."""
    graph = Graph({"asr": 0.0, "driver": 3.0, "plant": 6.0}, monkeypatch)
    assert master_namespace(graph, None) == "/ev"
    assert graph.now == pytest.approx(6.0, abs=0.1)


def test_a_topic_that_is_found_late_is_awaited(monkeypatch):
    graph = Graph({"asr": 0.0, "plant": 2.0}, monkeypatch)
    assert type_of(graph, "/ev/plant/x") == "std_msgs/msg/String"


@pytest.mark.parametrize("late", [0.0, 3.0])
def test_what_is_not_there_is_refused_when_no_other_node_comes(late, monkeypatch):
    graph = Graph({"asr": 0.0, "driver": late}, monkeypatch)
    with pytest.raises(LookupError, match=r"no master of time \(plant\): there is none"):
        master_namespace(graph, None)
    assert graph.now == pytest.approx(late + 4.0, abs=0.1)


def test_what_is_there_is_not_awaited(monkeypatch):
    graph = Graph({"plant": 0.0}, monkeypatch)
    assert master_namespace(graph, None) == "/ev"
    assert graph.now == 0.0
