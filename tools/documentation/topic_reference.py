"""The topic table: message, frame, writers, readers, and where each number of a signal sits in its message."""

from __future__ import annotations

import inspect

from documentation.markdown import code, codes, table
from documentation.own_methods import own_methods, writing_methods
from ev_core.lockstep.graph import writers
from ev_msgs_py.contract.fields import Field
from ev_msgs_py.contract.roles import MASTER, RECORDED, RECORDER_WRITES, ROLES
from ev_msgs_py.contract.topics import TOPICS, Topic
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.wire import joint_names
from ev_stack.running.offline import RECORDER

_WHEEL = "WHEEL"


def topic_table() -> str:
    """One line per topic."""
    columns = ("topic", "message", "frame", "written by", "may be read by")
    return table(
        columns, ((code(t.name), code(t.message_type), t.frame, *_ends(t)) for t in TOPICS.values())
    )


def field_tables() -> str:
    """One section per topic: what the signal is, and each field with its place in the message and its unit."""
    return "\n".join(_section(topic) for topic in TOPICS.values())


def _ends(topic: Topic) -> tuple[str, str]:
    if topic.signal is RECORDER_WRITES:
        return RECORDER, MASTER
    writer = writers(ROLES)[topic.signal]
    readers = [role.name for role in ROLES.values() if topic.signal in role.reads]
    if topic.signal in RECORDED:
        readers.append(RECORDER)
    return _writer(writer, topic.signal), ", ".join(readers)


def _writer(role: str, signal: type) -> str:
    methods = writing_methods(role, signal)
    if methods == list(own_methods(role)):
        return role
    return f"{role} ({', '.join(methods) or 'no method yet'})"


def _section(topic: Topic) -> str:
    signal = topic.signal
    about = " ".join((inspect.getdoc(signal) or "").split("\n\n")[0].split())
    head = f"### {topic.name}\n\n`{signal.__name__}`: {about}\n"
    fields = topic.shape.fields
    if not fields:
        return head
    names = joint_names(topic)
    joints = f"\n`name`: {codes(names)}\n" if names else ""
    rows = [
        (code(name), code(_place(field, names)), field.unit, field.about)
        for name, field in fields.items()
    ]
    return f"{head}{joints}\n{table(('field', 'in the message', 'unit', 'meaning'), rows)}"


def _place(field: Field, names: list[str]) -> str:
    """Where a field stands in its message, WHEEL for the name of each wheel."""
    if not names:
        return field.place
    joint, array = field.place.format(wheel=_WHEEL).split(".")
    return f"{array}[{joint}]"


def wheel_names() -> str:
    """The names that WHEEL stands for, in their order."""
    return codes(WHEEL_NAMES)
