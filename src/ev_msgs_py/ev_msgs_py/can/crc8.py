"""CRC-8 SAE J1850, polynomial x^8 + x^4 + x^3 + x^2 + 1 (AUTOSAR SWS CRC library, section 7.2.1.1)."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

POLYNOMIAL = 0x1D
_ALL_ONES = 0xFF


def _divided(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1) ^ (POLYNOMIAL if byte & 0x80 else 0)
    return byte & 0xFF


REMAINDERS = tuple(_divided(byte) for byte in range(256))


@compilable
def crc8_step(crc: int, byte: int) -> int:
    """The remainder after one more byte."""
    return REMAINDERS[crc ^ byte]


def crc8(data: bytes) -> int:
    """The checksum of some bytes as the standard has it: start value and final XOR are FFh."""
    crc = _ALL_ONES
    for byte in data:
        crc = crc8_step(crc, byte)
    return crc ^ _ALL_ONES
