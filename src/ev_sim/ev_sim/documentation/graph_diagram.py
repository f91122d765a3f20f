"""The graph as a Mermaid flowchart, drawn from the roles."""

from __future__ import annotations

from ev_msgs_py.graph import sequence, writers
from ev_msgs_py.roles import MASTER, RECORDER_WRITES, ROLES, RoleKind
from ev_msgs_py.topics import TOPICS
from ev_sim.documentation.own_methods import writing_methods
from ev_sim.scenario.node_parameters import RECORDER
from ev_sim.scenario.processes import EXECUTABLES

_THICK = "==>"
_DOTTED = "-.->"


def graph_diagram() -> str:
    """Nodes with what they may read of each other.

    Thick arrows are answers of the same instant, dotted ones are integrated to the next.
    """
    lines = ["```mermaid", "flowchart LR"]
    for name in (*sequence(ROLES), RECORDER):
        package, executable = EXECUTABLES[name]
        lines.append(f'    {name}["<b>{executable}</b><br/>{package}"]')
    for (writer, reader), topics in _edges().items():
        arrow = _DOTTED if ROLES[reader].kind is RoleKind.INTEGRATES else _THICK
        lines.append(f'    {writer} {arrow}|"{"<br/>".join(topics)}"| {reader}')
    lines.append('    everything(["all topics"]) -.-> recorder')
    lines.append(f'    {RECORDER} -.->|"{TOPICS[RECORDER_WRITES].name}"| {MASTER}')
    return "\n".join([*lines, "```"])


def _edges() -> dict[tuple[str, str], list[str]]:
    """(writer, reader) -> names of the topics between them that some method writes."""
    by_signal = writers(ROLES)
    edges: dict[tuple[str, str], list[str]] = {}
    for reader in sequence(ROLES):
        for signal in ROLES[reader].reads:
            writer = by_signal[signal]
            if writing_methods(writer, signal):
                edges.setdefault((writer, reader), []).append(TOPICS[signal].name)
    return edges
