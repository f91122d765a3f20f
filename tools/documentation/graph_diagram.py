"""The graph as a Mermaid flowchart, drawn from the roles."""

from __future__ import annotations

from documentation.own_methods import writing_methods
from ev_core.lockstep.graph import sequence, writers
from ev_msgs_py.contract.roles import MASTER, RECORDER_WRITES, ROLES, RoleKind
from ev_msgs_py.contract.topics import TOPICS
from ev_stack.running.node_process import package_of
from ev_stack.running.offline import RECORDER

_THICK = "==>"
_DOTTED = "-.->"


def graph_diagram() -> str:
    """Nodes with what they may read of each other.

    Thick arrows are answers of the same instant, dotted ones are integrated to the next.
    """
    lines = ["```mermaid", "flowchart LR"]
    for name in (*sequence(ROLES), RECORDER):
        where = (
            f"{package_of(name)}, optional"
            if name in ROLES and ROLES[name].optional
            else package_of(name)
        )
        lines.append(f'    {name}["<b>{name}</b><br/>{where}"]')
    for (writer, arrow, topics), readers in _edges().items():
        lines.append(f'    {writer} {arrow}|"{"<br/>".join(topics)}"| {" & ".join(readers)}')
    lines.append('    everything(["all topics"]) -.-> recorder')
    lines.append(f'    {RECORDER} -.->|"{TOPICS[RECORDER_WRITES].name}"| {MASTER}')
    return "\n".join([*lines, "```"])


def _edges() -> dict[tuple[str, str, tuple[str, ...]], list[str]]:
    """(writer, arrow, names of the topics) -> readers; topics that no method writes are left out."""
    by_signal = writers(ROLES)
    edges: dict[tuple[str, str, tuple[str, ...]], list[str]] = {}
    for reader in sequence(ROLES):
        arrow = _DOTTED if ROLES[reader].kind is RoleKind.INTEGRATES else _THICK
        topics: dict[str, list[str]] = {}
        for signal in ROLES[reader].reads:
            writer = by_signal[signal]
            if writing_methods(writer, signal):
                topics.setdefault(writer, []).append(TOPICS[signal].name)
        for writer, names in topics.items():
            edges.setdefault((writer, arrow, tuple(names)), []).append(reader)
    return edges
