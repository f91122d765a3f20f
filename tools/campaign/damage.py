"""What may have happened to a file, each a function of its content and a source of chance."""

from __future__ import annotations

import random

_WORDS = (
    b".nan",
    b".inf",
    b"-1e400",
    b"99999999999",
    b"''",
    b"[]",
    b"{}",
    b"null",
    b"\x00",
    b"\xff\xfe",
    b"\t",
    b"- ",
    b": ",
)


def _cut(content: bytes, chance: random.Random) -> bytes:
    return content[: chance.randrange(len(content))]


def _garbage(content: bytes, chance: random.Random) -> bytes:
    return chance.randbytes(chance.randrange(1, 3000))


def _flipped(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(chance.randrange(1, 6)):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed)


def _lines_moved(content: bytes, chance: random.Random) -> bytes:
    lines = content.splitlines(keepends=True)
    line = lines.pop(chance.randrange(len(lines)))
    if chance.random() < 0.6:
        lines.insert(chance.randrange(len(lines) + 1), line)
    return b"".join(lines)


def _word_inserted(content: bytes, chance: random.Random) -> bytes:
    place = chance.randrange(len(content))
    return content[:place] + chance.choice(_WORDS) + content[place:]


def _number_replaced(content: bytes, chance: random.Random) -> bytes:
    digits = [place for place, byte in enumerate(content) if byte in b"0123456789"]
    place = chance.choice(digits or range(len(content)))
    return content[:place] + chance.choice(_WORDS) + content[place + 1 :]


def _nested(content: bytes, chance: random.Random) -> bytes:
    return b"a: " + b"[" * chance.choice((50, 2000, 100_000))


def _aliases(content: bytes, chance: random.Random) -> bytes:
    lines = [
        b"a0: &a0 [1, 2]",
        *(b"a%d: &a%d [%s]" % (i, i, b", ".join([b"*a%d" % (i - 1)] * 9)) for i in range(1, 12)),
    ]
    return b"\n".join(lines)


DAMAGES = {
    "cut off": _cut,
    "random bytes": _garbage,
    "bytes changed": _flipped,
    "line moved": _lines_moved,
    "word inserted": _word_inserted,
    "number replaced": _number_replaced,
    "deeply nested": _nested,
    "aliases of aliases": _aliases,
    "empty": lambda content, chance: b"",
}
