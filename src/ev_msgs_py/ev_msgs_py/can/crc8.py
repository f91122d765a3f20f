"""CRC-8 SAE J1850, polynomial x^8 + x^4 + x^3 + x^2 + 1 (AUTOSAR SWS CRC library, section 7.2.1.1)."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

POLYNOMIAL = 0x1D
_LONGEST = 10  # bytes: data id and data of a classic frame
_ALL_ONES = 0xFF


def _divided(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1) ^ (POLYNOMIAL if byte & 0x80 else 0)
    return byte & 0xFF


def _remainders() -> bytes:
    """By number of bytes behind it, and by byte, what a byte adds to the CRC, which is linear."""
    first = [_divided(byte) for byte in range(256)]
    found = [first]
    for _ in range(_LONGEST - 1):
        found.append([first[crc] for crc in found[-1]])
    return bytes(crc for row in found for crc in row)


# As bytes, which compiled code reads in one instruction.
_REMAINDERS = _remainders()


@compilable
def crc8_share(byte: int, behind: int) -> int:
    """What a byte with so many bytes behind it adds to the CRC, by exclusive or, if the start value is 0."""
    return int(_REMAINDERS[(behind & 15) << 8 | byte])


def crc8(data: bytes) -> int:
    """The checksum of some bytes as the standard has it: start value and final XOR are FFh."""
    crc = _ALL_ONES
    for byte in data:
        crc = crc8_share(crc ^ byte, 0)
    return crc ^ _ALL_ONES
