"""Messages as little-endian CDR with zeros for padding.

The middleware leaves whatever was in memory between the fields. Here equal messages are equal bytes, which the wire
format relies on.
"""

from __future__ import annotations

import re
import struct
from typing import Any

ENCAPSULATION = b"\x00\x01\x00\x00"  # plain CDR, little-endian
_CODES = {
    "boolean": "?",
    "octet": "B",
    "uint8": "B",
    "int8": "b",
    "uint16": "H",
    "int16": "h",
    "uint32": "I",
    "int32": "i",
    "uint64": "Q",
    "int64": "q",
    "float": "f",
    "double": "d",
}
_COLLECTION = re.compile(r"sequence<(?P<element>.+)>|(?P<member>.+)\[(?P<size>\d+)\]")


def serialize(message: Any) -> bytes:
    """The bytes of a ROS message with its encapsulation header; fields of numbers, texts, messages and lists."""
    body = bytearray()
    _write_message(body, message)
    return ENCAPSULATION + bytes(body)


def _write_message(body: bytearray, message: Any) -> None:
    for name, kind in message.get_fields_and_field_types().items():
        _write(body, kind, getattr(message, name))


def _write(body: bytearray, kind: str, value: Any) -> None:
    if collection := _COLLECTION.fullmatch(kind):
        if collection["element"]:
            _write_number(body, "I", len(value))
        for element in value:
            _write(body, collection["element"] or collection["member"], element)
    elif kind == "string":
        text = value.encode() + b"\x00"
        _write_number(body, "I", len(text))
        body += text
    elif kind in _CODES:
        _write_number(body, _CODES[kind], value)
    else:
        _write_message(body, value)


def _write_number(body: bytearray, code: str, value: Any) -> None:
    number = struct.pack(f"<{code}", value)
    body += bytes(-len(body) % len(number)) + number
