"""CRC-8 SAE J1850 against the values that AUTOSAR publishes."""

from __future__ import annotations

import pytest

from ev_msgs_py.can.payload import crc8_share

# AUTOSAR SWS CRC library, section 7.2.1.1 (8-bit SAE J1850), table of test data.
PUBLISHED = {
    "00 00 00 00": 0x59,
    "F2 01 83": 0x37,
    "0F AA 00 55": 0x79,
    "00 FF 55 11": 0xB8,
    "33 22 55 AA BB CC DD EE FF": 0xCB,
    "92 6B 55": 0x8C,
    "FF FF FF FF": 0x74,
}


def crc8(data: bytes) -> int:
    """The checksum of some bytes as the standard has it: start value and final XOR are FFh."""
    crc = 0xFF
    for byte in data:
        crc = crc8_share(crc ^ byte, 0)
    return crc ^ 0xFF


@pytest.mark.parametrize("data", PUBLISHED)
def test_published_values(data: str):
    assert crc8(bytes.fromhex(data)) == PUBLISHED[data]


def test_check_value():
    """CRC-8/SAE-J1850 of the digits 1 to 9, by which catalogues name an algorithm, is 4Bh."""
    assert crc8(b"123456789") == 0x4B


def test_every_error_in_up_to_eight_neighbouring_bits_is_found():
    """An 8-bit CRC finds every burst up to its own length."""
    right = bytes.fromhex("33 22 55 AA BB CC DD EE")
    for burst in range(1, 256):
        for shift in range(64 - 7):
            wrong = int.from_bytes(right, "big") ^ (burst << shift)
            assert crc8(wrong.to_bytes(8, "big")) != crc8(right)
