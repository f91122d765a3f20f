"""Symbols that an object file calls, and the size of its code.

It may be ELF with 64 or 32 bits, or COFF (Windows).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

_ELF = b"\x7fELF"
# One symbol: of ELF with 64 bits name, kind, visibility, section, value, size; with 32 bits name,
# value, size, kind, visibility, section; of COFF name, value, section, type, class, entries that
# follow.
_WIDE = struct.Struct("<IBBHQQ")
_NARROW = struct.Struct("<IIIBBH")
_COFF = struct.Struct("<8sIhHBB")
_COFF_HEAD = struct.Struct("<HHIII")
_CONTENT = (b".text", b".rodata", b".rdata")
_OF_64_BITS = 2  # behind the magic number of ELF
_EXTERNAL = 2  # class of a COFF symbol that others may define


def calls(code: bytes) -> list[str]:
    """The names in an object file that others have to define."""
    return list(_of_elf(code) if code.startswith(_ELF) else _of_coff(code))


def code_size(code: bytes) -> int:
    """The bytes of instructions and of constants in an object file."""
    from llvmlite import binding

    sections = binding.ObjectFileRef.from_data(code).sections()
    return sum(
        section.size() for section in sections if (section.name() or b"").startswith(_CONTENT)
    )


def _of_elf(code: bytes) -> Iterator[str]:
    from llvmlite import binding

    found = binding.ObjectFileRef.from_data(code).sections()
    sections = {section.name(): section.data() for section in found}
    is_wide = code[len(_ELF)] == _OF_64_BITS
    layout = _WIDE if is_wide else _NARROW
    place_of_section = 3 if is_wide else 5
    # The first symbol is none.
    for entry in list(layout.iter_unpack(sections[b".symtab"]))[1:]:
        # One without a section is defined elsewhere.
        if entry[place_of_section] == 0:
            yield _until_zero(sections[b".strtab"], entry[0])


def _of_coff(code: bytes) -> Iterator[str]:
    _, _, _, begin, count = _COFF_HEAD.unpack_from(code)
    # The table of long names stands behind the symbols.
    names = begin + count * _COFF.size
    n = 0
    while n < count:
        name, _, section, _, kind, following = _COFF.unpack_from(code, begin + n * _COFF.size)
        if section == 0 and kind == _EXTERNAL:
            is_long = name[:4] == bytes(4)
            at = names + int.from_bytes(name[4:], "little")
            yield _until_zero(code, at) if is_long else name.rstrip(b"\0").decode()
        n += 1 + following


def _until_zero(names: bytes, at: int) -> str:
    return names[at : names.index(b"\0", at)].decode()
