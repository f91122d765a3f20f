"""The topic table: message, frame, writers, readers, and where each number of a signal sits in its message."""

from __future__ import annotations

import inspect
from typing import Any

from ev_msgs_py.graph import writers
from ev_msgs_py.message_classes import message_class
from ev_msgs_py.roles import MASTER, RECORDED, RECORDER_WRITES, ROLES
from ev_msgs_py.topics import TOPICS, Topic
from ev_msgs_py.wheels import WHEEL_NAMES
from ev_sim.documentation.markdown import code, codes, table
from ev_sim.documentation.own_methods import own_methods, writing_methods
from ev_sim.scenario.node_parameters import RECORDER

_FIRST_PROBE = 12345.5  # exact in single precision, and no field of a fresh message looks like it
_JOINT_STATE = "sensor_msgs/msg/JointState"
_WHEEL = "WHEEL"


def topic_table() -> str:
    """One line per topic."""
    columns = ("topic", "message", "frame", "written by", "may be read by")
    return table(columns, ((code(t.name), code(t.codec.message_type), t.frame, *_ends(t)) for t in TOPICS.values()))


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
    rows = [(code(field), place, topic.units[field]) for field, place in _places(topic).items()]
    head = f"### {topic.name}\n\n`{signal.__name__}`: {about}\n"
    if not rows:
        return head
    joints = "\n" + _joints(topic) if topic.codec.message_type == _JOINT_STATE else ""
    return f"{head}{joints}\n{table(('field', 'in the message', 'unit'), rows)}"


def _joints(topic: Topic) -> str:
    """The names of the joints in their order."""
    message = topic.codec.prepare(message_class(topic.codec.message_type)())
    return f"`name`: {codes(message.name)}\n"


def _places(topic: Topic) -> dict[str, str]:
    """Field of the signal -> where its numbers are found in the message, by sending numbers that can be told apart."""
    codec = topic.codec
    message = codec.prepare(message_class(codec.message_type)())
    probes = {_FIRST_PROBE + i: channel for i, channel in enumerate(codec.shape.channels)}
    codec.encode(codec.shape.signal_of(tuple(probes)), message)
    found: dict[str, list[str]] = {}
    for value, place in _numbers(message):
        if value in probes:
            field, _, wheel = probes[value].partition(".")
            general = place.replace(wheel, _WHEEL) if wheel else place
            if general not in found.setdefault(field, []):
                found[field].append(general)
    return {field: codes(found[field]) for field in codec.shape.fields}


def _numbers(message: Any, prefix: str = "") -> list[tuple[float, str]]:
    """All numbers of a message with their places; those of joints are named by joint."""
    names = getattr(message, "name", None)
    numbers = []
    for field in message.get_fields_and_field_types():
        value = getattr(message, field)
        if isinstance(value, float):
            numbers.append((value, f"{prefix}{field}"))
        elif hasattr(value, "get_fields_and_field_types"):
            numbers += _numbers(value, f"{prefix}{field}.")
        elif field in ("position", "velocity", "effort") and names is not None:
            numbers += [(value[i], f"{field}[{name}]") for i, name in enumerate(names[: len(value)])]
    return numbers


def wheel_names() -> str:
    """The names that WHEEL stands for, in their order."""
    return codes(WHEEL_NAMES)
