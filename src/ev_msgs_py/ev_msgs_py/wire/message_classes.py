"""Message classes by their type name, imported only where messages are really made."""

from __future__ import annotations

from functools import cache
from importlib import import_module


@cache
def message_class(message_type: str) -> type:
    """The class of a type name such as sensor_msgs/msg/JointState."""
    package, kind, name = message_type.split("/")
    found: type = getattr(import_module(f"{package}.{kind}"), name)
    return found
