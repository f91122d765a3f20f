"""Frames of anybody.

Never believed when damaged, and never numbers beyond what their fields can say.
"""

from __future__ import annotations

import math
import socket

from can_bus.databases import ours
from can_bus.exact_bits import quantised
from fuzz.fuzzing import assert_one_line, damaged, fuzzed, spoil
from hypothesis import given
from hypothesis import strategies as st

from ev_bench.bus.checking import TOLERANCES, WRONG_CRC, CheckState, check
from ev_bench.bus.parameters import EV_BENCH, load_database
from ev_bench.bus.socketcand_hub import HOST, SocketcandHub
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_bench.inverter_gateway.station import GatewayStation
from ev_core.parameters.data_file import find_in_config
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.payload import (
    COUNTERS,
    are_words,
    extracted,
    inserted,
    joined,
    protected,
    words,
)
from ev_msgs_py.refusal import ParameterError

LAYOUTS = sorted(ours(), key=lambda frame: frame.name)
FIELDS = [field for layout in LAYOUTS for field in layout.signals.values()]
IDENTIFIERS = [layout.identifier for layout in LAYOUTS]
payloads = st.integers(0, 2**64 - 1)


@fuzzed(30)
@given(
    layout=st.sampled_from(LAYOUTS),
    payload=payloads,
    counter=st.integers(0, COUNTERS - 1),
    flipped=st.sets(st.integers(0, 63), min_size=1, max_size=2),
)
def test_one_or_two_wrong_bits_are_found(layout, payload, counter, flipped):
    """Its polynomial is primitive.

    The Hamming distance is 3 up to 255 bits, and 80 are covered (Koopman, 0x8e).
    """
    bits = 8 * layout.length
    sent = protected(payload % (1 << bits) & ~0xFFF, layout.length, layout.data_id, counter)
    damage = sum(1 << bit for bit in {bit % bits for bit in flipped})
    state = CheckState()
    assert check(TOLERANCES, state, sent ^ damage, layout.length, layout.data_id) == WRONG_CRC


@fuzzed(30)
@given(field=st.sampled_from(FIELDS), payload=payloads, value=st.floats(allow_nan=False))
def test_a_field_says_what_it_can_and_no_more(field, payload, value):
    assert math.isfinite(extracted(payload, field))
    assert extracted(inserted(0, field, value), field) == quantised(field, value)
    half = field.scale / 2.0
    assert field.low - half <= quantised(field, value) <= field.high + half


@fuzzed(30)
@given(low=st.floats(), high=st.floats(), payload=payloads)
def test_numbers_that_are_no_words_are_no_frame(low, high, payload):
    assert joined(*words(payload)) == payload
    if are_words(low, high):
        assert 0 <= joined(low, high) < 1 << 64


@fuzzed(20)
@given(
    st.lists(
        st.tuples(st.sampled_from(IDENTIFIERS) | st.integers(0, 2047), st.binary(max_size=8)),
        max_size=20,
    )
)
def test_a_gateway_that_hears_anything_stays_finite(frames):
    station = GatewayStation(ours(), GatewayParameters())
    for identifier, data in frames:
        station.receive("11" if identifier % 2 else "12", Frame(identifier, data))
    for _, sent in station.step():
        assert 0 < len(sent.data) <= 8
    for device in station.devices.values():
        known = (getattr(device.feedback, name) for name in device.feedback.__dataclass_fields__)
        assert all(
            math.isfinite(number)
            for number in known
            if isinstance(number, float) and number != math.inf
        )


@fuzzed(8, 0.5)
@given(
    st.lists(
        st.binary(max_size=60)
        | st.sampled_from([b"< open a >", b"< rawmode >", b"< send 7FF 1 FF >"])
    )
)
def test_the_hub_outlives_what_a_client_says(texts):
    hub = SocketcandHub(0)
    try:
        with socket.create_connection((HOST, hub.port)) as client:
            client.setblocking(False)
            for text in texts:
                try:
                    client.sendall(text)
                except OSError:  # it has been sent away
                    break
                hub.serve(0.0)
        hub.serve(0.0)
    finally:
        hub.close()


@fuzzed(2, 0.02)
@given(damaged)
def test_a_damaged_database_is_a_line(tmp_path_factory, damage):
    path = tmp_path_factory.mktemp("dbc") / "bus.dbc"
    path.write_bytes(spoil(find_in_config(EV_BENCH).read_bytes(), damage))
    try:
        load_database(str(path))
    except ParameterError as error:
        assert_one_line(error)
