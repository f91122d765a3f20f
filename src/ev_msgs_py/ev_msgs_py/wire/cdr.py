"""Messages as little-endian CDR with zeros for padding, and where each of their numbers comes to stand.

The middleware leaves whatever was in memory between the fields. Here equal messages are equal bytes, which the message
formats rely on.
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


class Serialized:
    """The bytes of a ROS message with its encapsulation header, and the places of its numbers.

    `places` has, by path (twist.linear.x, position[3]), the offset in the bytes and the struct code of a number.
    """

    def __init__(self, message: Any) -> None:
        self.places: dict[str, tuple[int, str]] = {}
        self._body = bytearray()
        self._write_message(message, "")

    @property
    def bytes(self) -> bytes:
        """The whole message."""
        return ENCAPSULATION + bytes(self._body)

    def _write_message(self, message: Any, prefix: str) -> None:
        for name, kind in message.get_fields_and_field_types().items():
            self._write(kind, getattr(message, name), prefix + name)

    def _write(self, kind: str, value: Any, path: str) -> None:
        if collection := _COLLECTION.fullmatch(kind):
            if collection["element"]:
                self._write_number("I", len(value), f"{path}.length")
            for i, element in enumerate(value):
                self._write(collection["element"] or collection["member"], element, f"{path}[{i}]")
        elif kind == "string":
            text = value.encode() + b"\x00"
            self._write_number("I", len(text), f"{path}.length")
            self._body += text
        elif kind in _CODES:
            self._write_number(_CODES[kind], value, path)
        else:
            self._write_message(value, f"{path}.")

    def _write_number(self, code: str, value: Any, path: str) -> None:
        number = struct.pack(f"<{code}", value)
        self._body += bytes(-len(self._body) % len(number))
        self.places[path] = len(ENCAPSULATION) + len(self._body), code
        self._body += number
