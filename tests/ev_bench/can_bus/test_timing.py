"""Time on the bus against published numbers."""

from __future__ import annotations

import random

import pytest
from can_bus.databases import ours
from can_bus.exact_bits import exact_frame, stuff_bits

from documentation.response_times import Cyclic, bus_load, response_times
from ev_msgs_py.can.frame_length import crc15, frame_bits, header, longest_frame, wire_bits


@pytest.mark.parametrize(("length", "bits"), [(0, 55), (1, 65), (8, 135)])
def test_longest_frame(length: int, bits: int):
    """55 + 10 s bits for 11-bit identifiers (Davis et al. 2007, eq 1), with the pause behind."""
    assert longest_frame(length) == bits


def test_crc_of_the_frame():
    """Check value of CRC-15/CAN: 059Eh of the digits 1 to 9."""
    assert (
        crc15([byte >> place & 1 for byte in b"123456789" for place in reversed(range(8))])
        == 0x059E
    )


def test_stuff_bits_of_equal_bits():
    """Five zeros, a one; the one counts: four more ones make five, and so on."""
    assert stuff_bits([0] * 5) == 1
    assert stuff_bits([0] * 9) == 1
    assert stuff_bits([0] * 10) == 2
    assert stuff_bits([0] * 5 + [1] * 4) == 2
    assert stuff_bits([0, 1] * 20) == 0


def test_no_frame_is_longer_than_the_longest_and_most_are_near_the_shortest():
    numbers = random.Random(1)
    lengths = [exact_frame(numbers.getrandbits(11), numbers.randbytes(8)) for _ in range(2000)]
    assert min(lengths) >= 47 + 64
    assert max(lengths) <= 135
    assert sum(lengths) / len(lengths) < 47 + 64 + 7


def test_tables_count_the_same_bits():
    """Frames with many equal bits among them, as those have the most stuff bits."""
    numbers = random.Random(2)
    for length in (0, 4, 8) * 300:
        identifier = numbers.getrandbits(11)
        data = bytes(numbers.choice((0, 0xFF, numbers.getrandbits(8))) for _ in range(length))
        counted = wire_bits(*header(identifier, length), int.from_bytes(data, "little"), length)
        assert counted == exact_frame(identifier, data)


def test_a_frame_is_longer_than_its_bits_by_stuffing_and_by_13_bits_that_are_never_stuffed():
    bits = list(frame_bits(0x20B, bytes(8)))
    assert len(bits) == 34 + 64
    assert exact_frame(0x20B, bytes(8)) == len(bits) + stuff_bits(bits) + 13


def test_published_response_times():
    """Davis et al. (2007), table 1.

    C 1 ms each, T 2.5, 3.5, 3.5 ms: 2, 3 and 3.5 ms, where Tindell's are 2, 3 and 3.

    A bit takes 8 us there; deadlines are missed in the second instance of C only.
    """
    frames = [Cyclic(2.5, 1.0), Cyclic(3.5, 1.0), Cyclic(3.5, 1.0)]
    assert response_times(frames, 0.008) == pytest.approx([2.0, 3.0, 3.5])


def test_an_overloaded_bus_is_refused():
    with pytest.raises(ValueError, match="whole time of the bus"):
        response_times([Cyclic(1.0, 0.6), Cyclic(1.0, 0.6)], 0.001)


def test_bus_load_of_one_frame():
    """8 bytes each ms at 1 Mbit/s: 135 bits of 1000."""
    assert bus_load([ours()["Drive11_SetPoint"]], 1e6) == pytest.approx(0.135)
